// An OpenGL 4.5 core context, off screen: OSMesa (default) or EGL surfaceless (newer Mesa has no OSMesa).
//
// A context belongs to the thread that makes it current. Functions are loaded through proc(); nothing links libGL.
#pragma once

#include <memory>
#include <string>

namespace standin {

enum class DeviceKind { kOsMesa, kEgl };

class Context {
 public:
  virtual ~Context() = default;
  virtual void make_current() = 0;
  [[nodiscard]] virtual void* proc(const char* name) const = 0;
  [[nodiscard]] virtual DeviceKind kind() const = 0;
  /// GL_RENDERER and GL_VERSION, for the machine's fingerprint.
  [[nodiscard]] virtual std::string renderer() const = 0;
  [[nodiscard]] virtual std::string version() const = 0;
};

/// Sets LP_NUM_THREADS=0 first (all work in the calling thread: facts of llvmpipe timing). Throws Failure(kDeviceUnavailable).
[[nodiscard]] std::unique_ptr<Context> make_context(DeviceKind kind, int width, int height);

}  // namespace standin
