// Draws a view of a scene: frustum culling per object, one draw per object part, opaque front to back (then masked ones), textures with
// trilinear filtering, alpha mask, one fixed light (render/scene/shading.h); impostors unlit with nearest filtering, sorted by atlas page.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "render/device/context.h"
#include "render/impostor/impostor.h"
#include "render/scene/scene.h"
#include "render/view/camera.h"

namespace standin {

/// What to draw: object ids and impostor ids (of the uploaded set), ascending. Objects outside the frustum are culled by the renderer.
struct DrawList {
  std::vector<std::uint32_t> objects;
  std::vector<std::uint32_t> impostors;
};

/// What a frame did, counted on the CPU side; deterministic.
struct FrameCounts {
  std::uint64_t draws = 0;
  std::uint64_t triangles = 0;
  std::uint64_t texture_switches = 0;
  std::uint64_t impostor_draws = 0;
};

class Renderer {
 public:
  /// Uploads the scene. The context must be current and stay current in this thread. `scene` must outlive the renderer.
  Renderer(Context& context, const Scene& scene, const Camera& camera);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Replaces the uploaded impostors.
  void upload(const ImpostorSet& impostors);
  /// Clears, draws and finishes (glFinish).
  FrameCounts draw(const View& view, const DrawList& list);
  /// The last frame; background (0.72, 0.80, 0.90) has alpha 0, drawn pixels 255.
  [[nodiscard]] Texture read_pixels();
  /// Fragments that passed the depth test in one more draw of the view (GL_SAMPLES_PASSED), for model diagnostics.
  [[nodiscard]] std::uint64_t count_passed_pixels(const View& view, const DrawList& list);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace standin
