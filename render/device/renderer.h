// Draws a view of a scene: frustum culling per object, one draw per object part, opaque front to back (then masked ones), textures with
// trilinear filtering, alpha mask, one fixed light (render/scene/shading.h); impostors unlit with nearest filtering, sorted by atlas page.
//
// Every matrix is combined in double and rounded to float last (clip_from_mesh), so that pictures do not depend on where in the world the
// scene lies. Depth is reversed and 32-bit float: near 1, infinitely far 0, about one part in 10^7 of the distance everywhere.
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

/// Encoded colour of pixels that nothing covers.
inline constexpr glm::vec3 kBackground{0.72F, 0.80F, 0.90F};

/// What to draw: object ids and impostor ids (of the uploaded set), ascending. Objects outside the frustum are culled by the renderer.
struct DrawList {
  std::vector<std::uint32_t> objects;
  std::vector<std::uint32_t> impostors;
  std::vector<std::uint8_t> levels = {};  // of detail (object_levels.h), one for each of `objects`; none: the objects' own parts
};

/// What a frame did, counted on the CPU side; deterministic.
struct FrameCounts {
  std::uint64_t draws = 0;  // all draw calls
  std::uint64_t triangles = 0;
  std::uint64_t texture_switches = 0;  // real changes of the bound texture; a frame starts with none bound
  std::uint64_t program_switches = 0;  // likewise
  std::uint64_t impostor_draws = 0;    // of `draws`: one for each atlas page that an impostor uses
  friend bool operator==(const FrameCounts&, const FrameCounts&) = default;
};

class Renderer {
 public:
  /// Uploads the scene. The context must be current, stay current in this thread and outlive the renderer, as must `scene`.
  Renderer(Context& context, const Scene& scene, const Camera& camera);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Replaces the uploaded impostors.
  void upload(const ImpostorSet& impostors);
  /// Clears, draws and finishes (glFinish).
  FrameCounts draw(const View& view, const DrawList& list);
  /// The same for any projection that keeps orientation (OpenGL clip space), seen from `eye`; nothing is culled beforehand.
  FrameCounts draw_projected(const Mat4& clip_from_world, const Vec3& eye, const DrawList& list);
  /// The last frame, rows from the top; kBackground has alpha 0, drawn pixels 255.
  [[nodiscard]] Texture read_pixels();
  /// Fragments that passed the depth test in one more draw of the view (GL_SAMPLES_PASSED), for model diagnostics.
  [[nodiscard]] std::uint64_t count_passed_pixels(const View& view, const DrawList& list);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace standin
