// The features of a whole scene's objects, prepared once and asked often (thesis 5.2.1; features.h says what the terms mean).
//
// A single view's estimate sums f^2 |a.p| / z^3 over surface samples (projection.h). A bound for all views from a box sums the greatest
// value of each of these terms over the box, sample by sample: every part of a large object counts at its own distance, and what faces
// away from the whole box not at all. So bound >= estimate holds term by term, and a smaller box never has a larger bound.
#pragma once

#include <span>
#include <vector>

#include "estimation/features.h"
#include "estimation/projection.h"
#include "estimation/surface_samples.h"

namespace standin {

/// No object's pixels of one kind count more often than this many screens: beyond that a renderer that draws front to back rejects them.
inline constexpr double kMaxScreensPerObject = 4.0;

/// How the pixels of a part are shaded; one pixel term each.
enum class PixelKind : std::size_t { kPlain, kTextured, kMasked, kCount };
inline constexpr std::size_t kPixelKindCount = static_cast<std::size_t>(PixelKind::kCount);
/// As the renderer draws it: a texture needs coordinates, and an alpha test needs a texture.
[[nodiscard]] PixelKind pixel_kind(const Scene& scene, const Part& part);

/// `scene` must outlive the table. Const members may be called from several threads.
class FeatureTable {
 public:
  FeatureTable(const Scene& scene, const Camera& camera);

  /// Estimate for one view; all zero when the object's bounds miss the frustum. About a microsecond a part, 15 for a part within reach.
  [[nodiscard]] Features estimate(std::uint32_t object, const PreparedView& view) const;
  /// Upper bound over all views from `eyes`, in any direction. About a microsecond a part.
  [[nodiscard]] Features bound(std::uint32_t object, const Box& eyes) const;
  /// A whole frame: frame_features() and the estimates of `objects`.
  [[nodiscard]] Features frame(std::span<const std::uint32_t> objects, const View& view) const;

  [[nodiscard]] const Camera& camera() const { return camera_; }

 private:
  struct ObjectShape {
    Features counts;        // draws, switches, triangles: the same for every view
    double radius_m = 0.0;  // of the bounds' sphere; an eye nearer than that needs the near patches
  };

  [[nodiscard]] ObjectShape shape_of(const Object& object) const;

  const Scene* scene_;
  Camera camera_;
  double screen_pixels_;
  std::vector<SurfaceSamples> samples_;  // per mesh
  std::vector<ObjectShape> shapes_;      // per object
};

}  // namespace standin
