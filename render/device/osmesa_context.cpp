// OSMesa: llvmpipe into a buffer of ours, without a window system. The only file that sees <GL/osmesa.h> (and the <GL/gl.h> it drags in).
#include <GL/osmesa.h>

#include <vector>

#include "render/base/error.h"
#include "render/device/context_factories.h"
#include "render/device/shared_library.h"

namespace standin {
namespace {

struct OsMesa {
  SharedLibrary library{"libOSMesa.so.8"};
  OSMesaContext (*create)(const int*, OSMesaContext) = library.function<decltype(create)>("OSMesaCreateContextAttribs");
  void (*destroy)(OSMesaContext) = library.function<decltype(destroy)>("OSMesaDestroyContext");
  GLboolean (*make_current)(OSMesaContext, void*, GLenum, GLsizei, GLsizei) = library.function<decltype(make_current)>("OSMesaMakeCurrent");
  OSMESAproc (*proc)(const char*) = library.function<decltype(proc)>("OSMesaGetProcAddress");
};

const OsMesa& osmesa() {
  static const OsMesa instance;
  return instance;
}

class OsMesaContext final : public Context {
 public:
  OsMesaContext(int width, int height) : width_(width), height_(height), buffer_(std::size_t{4} * width * height) {
    const int attributes[] = {OSMESA_FORMAT,
                              OSMESA_RGBA,
                              OSMESA_DEPTH_BITS,
                              0,
                              OSMESA_PROFILE,
                              OSMESA_CORE_PROFILE,
                              OSMESA_CONTEXT_MAJOR_VERSION,
                              4,
                              OSMESA_CONTEXT_MINOR_VERSION,
                              5,
                              0,
                              0};
    context_ = osmesa().create(attributes, nullptr);
    if (context_ == nullptr) throw Failure(ErrorWord::kDeviceUnavailable, "OSMesa gives no OpenGL 4.5 core context");
  }
  ~OsMesaContext() override { osmesa().destroy(context_); }
  OsMesaContext(const OsMesaContext&) = delete;
  OsMesaContext& operator=(const OsMesaContext&) = delete;

  void make_current() override {
    if (osmesa().make_current(context_, buffer_.data(), GL_UNSIGNED_BYTE, width_, height_) != GL_TRUE)
      throw Failure(ErrorWord::kDeviceUnavailable, "OSMesa cannot make its context current");
  }
  [[nodiscard]] void* proc(const char* name) const override { return reinterpret_cast<void*>(osmesa().proc(name)); }
  [[nodiscard]] DeviceKind kind() const override { return DeviceKind::kOsMesa; }
  [[nodiscard]] std::string renderer() const override { return gl_string(*this, GL_RENDERER); }
  [[nodiscard]] std::string version() const override { return gl_string(*this, GL_VERSION); }

 private:
  int width_;
  int height_;
  std::vector<unsigned char> buffer_;
  OSMesaContext context_ = nullptr;
};

}  // namespace

std::unique_ptr<Context> make_osmesa_context(int width, int height) {
  auto context = std::make_unique<OsMesaContext>(width, height);
  context->make_current();
  return context;
}

}  // namespace standin
