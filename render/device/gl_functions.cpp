#include "render/device/gl_functions.h"

#include "render/base/error.h"

namespace standin {
namespace {

template <typename Function>
Function load(const Context& context, const char* name) {
  void* address = context.proc(name);
  if (address == nullptr) throw Failure(ErrorWord::kDeviceUnavailable, std::string("the OpenGL context has no function ") + name);
  return reinterpret_cast<Function>(address);
}

}  // namespace

Gl::Gl(const Context& context) {
#define STANDIN_GL_LOAD(type, name) name = load<type>(context, "gl" #name);
  STANDIN_GL_FUNCTIONS(STANDIN_GL_LOAD)
#undef STANDIN_GL_LOAD
}

void Gl::check(const char* doing_what) const {
  const GLenum error = GetError();
  if (error == GL_NO_ERROR) return;
  const std::string what = error == GL_OUT_OF_MEMORY ? "out of memory" : "error " + std::to_string(error);
  throw Failure(ErrorWord::kDeviceUnavailable, "OpenGL: " + what + " while " + doing_what);
}

}  // namespace standin
