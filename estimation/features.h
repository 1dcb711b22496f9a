// Features of a frame that are known without rendering it (thesis 5.2.1, 5.8.1): what the time model multiplies.
//
// Features are additive over what is drawn, but for pixels, which hide each other: of a frame, only those count that pass the depth test
// (screen_coverage.h). For a single view they are estimates; for a region they are upper bounds over all its views from a box of eyes, and
// monotone: never less for a larger box. Asked for more than once, take a FeatureTable (feature_table.h).
//
// What costs nothing that frames of eight scenes could show beside these is left out: generated but hidden pixels, vertices, and the
// texture switches of originals, which are drawn sorted (tests/bench/time_model.md).
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "render/impostor/impostor.h"
#include "render/scene/scene.h"
#include "render/view/camera.h"

namespace standin {

enum class Term : std::size_t {
  kFrame,              // 1 per frame
  kDraws,              // draw calls
  kTextureSwitches,    // of impostors' atlas pages
  kTriangles,          // submitted triangles
  kOnScreenTriangles,  // of these, inside the frustum and not culled as back sides
  kEdgePixels,   // length of these triangles' edges in the image, at most 64 a triangle (16 if masked): blocks of pixels that are drawn in
                 // part
  kPlainPixels,  // pixels without texture that pass the depth test
  kTexturedPixels,
  kMaskedPixels,    // alpha-tested
  kImpostorQuads,   // two triangles each, of which the triangle terms know nothing
  kImpostorPixels,  // generated; nearest filtering, masked
  kCount
};
inline constexpr std::size_t kTermCount = static_cast<std::size_t>(Term::kCount);
[[nodiscard]] std::string_view term_name(Term term);  // "draws" ...
/// Pixels of originals: of a frame, limited by the room in the image (screen_coverage.h). An impostor's are not: its quads are masked, in
/// no depth order.
[[nodiscard]] bool is_pixel_term(Term term);

struct Features {
  std::array<double, kTermCount> value{};
  double& operator[](Term term) { return value[static_cast<std::size_t>(term)]; }
  double operator[](Term term) const { return value[static_cast<std::size_t>(term)]; }
  Features& operator+=(const Features& other) {
    for (std::size_t i = 0; i < kTermCount; ++i) value[i] += other.value[i];
    return *this;
  }
};

/// Estimate for one view; all zero when the object's bounds miss the frustum.
[[nodiscard]] Features object_features(const Scene& scene, std::uint32_t object, const View& view, const Camera& camera);
/// Upper bound over all views from `eyes` (not empty), in any direction.
[[nodiscard]] Features object_features_bound(const Scene& scene, std::uint32_t object, const Box& eyes, const Camera& camera);

/// What is known of an impostor's drawing cost: of a baked one, or of a candidate's estimate.
struct ImpostorCost {
  double quads = 0.0;
  double texels = 0.0;           // that its triangles cover, drawn at that angle
  double texel_angle_rad = 0.0;  // of a texel seen from the nearest point of the view cell (root of the solid angle), the greatest
};
[[nodiscard]] ImpostorCost impostor_cost(const Impostor& impostor);
/// Upper bound over all views in the impostor's view cell at distance >= nearest_m from the represented objects. One draw; no switch
/// (charged once per atlas page and frame).
[[nodiscard]] Features impostor_features_bound(const ImpostorCost& cost, const Camera& camera);
/// Estimate for one view in the view cell, summed over its triangles; all zero when the objects' bounds miss the frustum.
[[nodiscard]] Features impostor_features(const Impostor& impostor, const Box& objects_bounds, const View& view, const Camera& camera);
/// Features of an empty frame.
[[nodiscard]] Features frame_features();

}  // namespace standin
