#include "render/device/context.h"

#include <GL/glcorearb.h>
#include <malloc.h>

#include <cstdlib>
#include <mutex>

#include "render/base/error.h"
#include "render/device/context_factories.h"

namespace standin {
namespace {

// llvmpipe reads the variable when its first context of the process is made; setenv is not safe against other threads reading it.
void keep_llvmpipe_in_the_calling_thread() {
  setenv("LP_NUM_THREADS", "0", 1);
}

// llvmpipe bins a frame into blocks that it allocates and frees again, a hundred megabytes for half a million triangles. By default glibc
// hands them back to the system or not, as the heap happens to lie, and a frame that gets its pages anew takes 1.5 times as long. Kept, the
// same frame always takes the same, shorter time.
void keep_freed_memory() {
  constexpr int kNever = -1;
  mallopt(M_TRIM_THRESHOLD, kNever);
}

void make_llvmpipe_repeatable() {
  static std::once_flag once;
  std::call_once(once, [] {
    keep_llvmpipe_in_the_calling_thread();
    keep_freed_memory();
  });
}

}  // namespace

std::unique_ptr<Context> make_context(DeviceKind kind, int width, int height) {
  if (width < 1 || height < 1) {
    throw Failure(ErrorWord::kBadUsage,
                  "context of " + std::to_string(width) + " x " + std::to_string(height) + " pixels: each side must be at least 1");
  }
  make_llvmpipe_repeatable();
  return kind == DeviceKind::kOsMesa ? make_osmesa_context(width, height) : make_egl_context();
}

std::string gl_string(const Context& context, unsigned int name) {
  const auto get_string = reinterpret_cast<PFNGLGETSTRINGPROC>(context.proc("glGetString"));
  const auto* text = get_string != nullptr ? get_string(name) : nullptr;
  return text != nullptr ? reinterpret_cast<const char*>(text) : "";
}

}  // namespace standin
