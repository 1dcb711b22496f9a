// An OpenGL 4.5 core context, off screen: OSMesa (default) or EGL surfaceless (newer Mesa has no OSMesa).
//
// A context belongs to the thread that makes it current. Functions are loaded through proc(); nothing links libGL, and the device's
// library is opened on first use.
#pragma once

#include <memory>
#include <string>

namespace standin {

enum class DeviceKind { kOsMesa, kEgl };

class Context {
 public:
  virtual ~Context() = default;
  virtual void make_current() = 0;
  /// nullptr where the device has no such function.
  [[nodiscard]] virtual void* proc(const char* name) const = 0;
  [[nodiscard]] virtual DeviceKind kind() const = 0;
  /// GL_RENDERER and GL_VERSION, for the machine's fingerprint. The context must be current.
  [[nodiscard]] virtual std::string renderer() const = 0;
  [[nodiscard]] virtual std::string version() const = 0;
};

/// Makes a context and makes it current. `width` and `height` size the default framebuffer where the device has one (OSMesa); Renderer
/// draws into a framebuffer object of its own. Sets LP_NUM_THREADS=0 first, so that llvmpipe does all its work in the calling thread, where
/// its CPU time can be measured, and makes the process keep freed memory (context.cpp says why). Throws Failure(kDeviceUnavailable).
[[nodiscard]] std::unique_ptr<Context> make_context(DeviceKind kind, int width, int height);

}  // namespace standin
