// The features of a whole scene's objects, prepared once and asked often (thesis 5.2.1; features.h says what the terms mean).
//
// A single view's estimate sums f^2 |a.p| / z^3 over surface samples (projection.h). A region's bound replaces each factor by its largest
// value at `nearest_m`: |a.p| / z^3 <= |a| / (r^2 cos^3) with the corner's cosine, and the share of area that can face one direction by the
// root of the largest eigenvalue of the normals' second moments (Jensen: mean |n.w| <= sqrt(mean (n.w)^2)) plus the spread of directions
// over the object. So bound >= estimate holds term by term, by construction.
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
  /// Upper bound over all views at least `nearest_m` from the object's bounds; well below a microsecond.
  [[nodiscard]] Features bound(std::uint32_t object, double nearest_m) const;
  /// A whole frame: frame_features() and the estimates of `objects`.
  [[nodiscard]] Features frame(std::span<const std::uint32_t> objects, const View& view) const;

  [[nodiscard]] const Camera& camera() const { return camera_; }

 private:
  /// What a bound needs of an object's surface of one pixel kind, world space.
  struct FacingArea {
    double total_m2 = 0.0;
    double facing_m2 = 0.0;  // the most that one direction can see, all of it seen from far away
  };
  struct ObjectShape {
    Features counts;  // draws, switches, triangles: the same for every view
    std::array<FacingArea, kPixelKindCount> area;
    double radius_m = 0.0;                              // of the bounds' sphere
    double half_extent_m = 0.0;                         // least half edge of the bounds: the centre is that much farther than the bounds
    std::size_t first_covering = 0, last_covering = 0;  // range in covering_
  };
  /// Sampled triangles in ascending area with running sums, so that sum min(1, q area) is one binary search.
  struct CoveringStep {
    double area_m2 = 0.0;
    double area_before_m2 = 0.0;  // of smaller ones, times the triangles they stand for
    double triangles_from = 0.0;  // this one and larger ones
  };

  [[nodiscard]] ObjectShape shape_of(const Object& object);
  void add_covering(ObjectShape& shape, std::vector<std::array<double, 2>> areas_and_counts);
  [[nodiscard]] double covering_triangles(const ObjectShape& shape, double pixels_per_m2) const;

  const Scene* scene_;
  Camera camera_;
  double screen_pixels_;
  double pixels_per_m2_at_1m_;           // at most
  std::vector<SurfaceSamples> samples_;  // per mesh
  std::vector<ObjectShape> shapes_;      // per object
  std::vector<CoveringStep> covering_;
};

}  // namespace standin
