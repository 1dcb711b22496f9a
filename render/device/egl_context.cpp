// EGL without a surface (EGL_MESA_platform_surfaceless): the way to a context on Mesa versions that have no OSMesa any more.
#define EGL_NO_X11
#define EGL_EGL_PROTOTYPES 0
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include "render/base/error.h"
#include "render/device/context_factories.h"
#include "render/device/shared_library.h"

namespace standin {
namespace {

[[noreturn]] void unavailable(const char* what) {
  throw Failure(ErrorWord::kDeviceUnavailable, std::string("EGL on the surfaceless platform: ") + what);
}

struct Egl {
  SharedLibrary library{"libEGL.so.1"};
  PFNEGLGETPLATFORMDISPLAYPROC get_platform_display = library.function<PFNEGLGETPLATFORMDISPLAYPROC>("eglGetPlatformDisplay");
  PFNEGLINITIALIZEPROC initialize = library.function<PFNEGLINITIALIZEPROC>("eglInitialize");
  PFNEGLBINDAPIPROC bind_api = library.function<PFNEGLBINDAPIPROC>("eglBindAPI");
  PFNEGLCREATECONTEXTPROC create_context = library.function<PFNEGLCREATECONTEXTPROC>("eglCreateContext");
  PFNEGLDESTROYCONTEXTPROC destroy_context = library.function<PFNEGLDESTROYCONTEXTPROC>("eglDestroyContext");
  PFNEGLGETCURRENTCONTEXTPROC get_current_context = library.function<PFNEGLGETCURRENTCONTEXTPROC>("eglGetCurrentContext");
  PFNEGLMAKECURRENTPROC make_current = library.function<PFNEGLMAKECURRENTPROC>("eglMakeCurrent");
  PFNEGLGETPROCADDRESSPROC get_proc_address = library.function<PFNEGLGETPROCADDRESSPROC>("eglGetProcAddress");
  EGLDisplay display = EGL_NO_DISPLAY;

  Egl() {
    display = get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
    if (display == EGL_NO_DISPLAY) unavailable("no display");
    if (initialize(display, nullptr, nullptr) != EGL_TRUE) unavailable("the display does not initialise");
  }
};

// One display for the process; it is never terminated, since that would end every context made on it.
const Egl& egl() {
  static const Egl instance;
  return instance;
}

class EglContext final : public Context {
 public:
  EglContext() {
    const EGLint attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    if (egl().bind_api(EGL_OPENGL_API) != EGL_TRUE) unavailable("no desktop OpenGL");
    context_ = egl().create_context(egl().display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (context_ == EGL_NO_CONTEXT) unavailable("no OpenGL 4.5 core context");
  }
  ~EglContext() override {
    if (egl().get_current_context() == context_) bind(EGL_NO_CONTEXT);
    egl().destroy_context(egl().display, context_);
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  void make_current() override {
    // OSMesa shares Mesa's per-thread current context, but EGL does not notice: released first, the context is really bound again.
    if (egl().bind_api(EGL_OPENGL_API) != EGL_TRUE || !bind(EGL_NO_CONTEXT) || !bind(context_))
      unavailable("the context cannot be made current");
  }
  [[nodiscard]] void* proc(const char* name) const override { return reinterpret_cast<void*>(egl().get_proc_address(name)); }
  [[nodiscard]] DeviceKind kind() const override { return DeviceKind::kEgl; }
  [[nodiscard]] std::string renderer() const override { return gl_string(*this, GL_RENDERER); }
  [[nodiscard]] std::string version() const override { return gl_string(*this, GL_VERSION); }

 private:
  static bool bind(EGLContext context) { return egl().make_current(egl().display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE; }

  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<Context> make_egl_context() {
  auto context = std::make_unique<EglContext>();
  context->make_current();
  return context;
}

}  // namespace standin
