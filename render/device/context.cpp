#include "render/device/context.h"

#include <GL/glcorearb.h>

#include <cstdlib>
#include <mutex>

#include "render/base/error.h"
#include "render/device/context_factories.h"

namespace standin {
namespace {

// llvmpipe reads the variable when its first context of the process is made; setenv is not safe against other threads reading it.
void keep_llvmpipe_in_the_calling_thread() {
  static std::once_flag once;
  std::call_once(once, [] { setenv("LP_NUM_THREADS", "0", 1); });
}

}  // namespace

std::unique_ptr<Context> make_context(DeviceKind kind, int width, int height) {
  if (width < 1 || height < 1) {
    throw Failure(ErrorWord::kBadUsage,
                  "context of " + std::to_string(width) + " x " + std::to_string(height) + " pixels: each side must be at least 1");
  }
  keep_llvmpipe_in_the_calling_thread();
  return kind == DeviceKind::kOsMesa ? make_osmesa_context(width, height) : make_egl_context();
}

std::string gl_string(const Context& context, unsigned int name) {
  const auto get_string = reinterpret_cast<PFNGLGETSTRINGPROC>(context.proc("glGetString"));
  const auto* text = get_string != nullptr ? get_string(name) : nullptr;
  return text != nullptr ? reinterpret_cast<const char*>(text) : "";
}

}  // namespace standin
