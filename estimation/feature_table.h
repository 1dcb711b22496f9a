// The features of a whole scene's objects, prepared once and asked often (thesis 5.2.1; features.h says what the terms mean).
//
// A single view's estimate sums over surface samples (surface_samples.h, projection.h), and lets pass only as many pixels as the image has
// room for (screen_coverage.h). A bound for all views from a box sums the greatest value of each of these terms over the box, sample by
// sample: every part of a large object counts at its own distance, and what faces away from the whole box not at all. Told in which
// interval of directions the views look (gaze.h), it leaves out the samples that none of them sees. So bound >= estimate holds term by
// term, and a smaller box never has a larger bound (but for rounding, where directions are told). Fewer directions may: the enclosing
// frustum of a part of an interval does not lie wholly in that of the whole.
#pragma once

#include <span>
#include <vector>

#include "estimation/features.h"
#include "estimation/object_from_box.h"
#include "estimation/placed_mesh.h"
#include "estimation/projection.h"
#include "estimation/screen_coverage.h"
#include "estimation/surface_samples.h"
#include "render/scene/object_levels.h"

namespace standin {

/// As the renderer draws it: a texture needs coordinates, and an alpha test needs a texture.
[[nodiscard]] PixelKind pixel_kind(const Scene& scene, const Part& part);

/// `scene` must outlive the table. Const members may be called from several threads.
class FeatureTable {
 public:
  FeatureTable(const Scene& scene, const Camera& camera);

  /// Of an object alone in a view; all zero when its bounds miss the frustum. About a microsecond a part, 15 for a part within reach.
  [[nodiscard]] Features estimate(std::uint32_t object, const PreparedView& view, std::uint32_t level = 0) const;
  /// Upper bound over all views from `eyes`, in any direction, of what an object adds to a frame, at the level of detail that a cell of
  /// these eyes shows. About a microsecond a part, 15 for a part that may be within reach.
  [[nodiscard]] Features bound(std::uint32_t object, const Box& eyes) const;
  [[nodiscard]] ObjectFromBox from_box(std::uint32_t object, const EyeBoxes& from) const;
  /// As bound(), over the views of one gaze from the same box. About a microsecond a part, 15 for a part that may be within reach.
  [[nodiscard]] Features bound(const ObjectFromBox& object, const Gaze& gaze) const;
  /// A whole frame: frame_features(), and `objects` as they hide each other, each at its level (none given: the objects' own parts). At
  /// most the sum of their estimates.
  [[nodiscard]] Features frame(std::span<const std::uint32_t> objects, const View& view, std::span<const std::uint8_t> levels = {}) const;

  [[nodiscard]] const Camera& camera() const { return camera_; }
  /// What all pixel terms of a frame's originals together are at most, and which of them the scene has at all.
  [[nodiscard]] double most_passed_pixels() const { return most_passed_pixels_; }
  [[nodiscard]] std::span<const Term> pixel_terms() const { return pixel_terms_; }

 private:
  struct ObjectShape {
    std::vector<Features> counts;  // draws, triangles of each level: the same for every view
    double radius_m = 0.0;         // of the bounds' sphere; an eye nearer than that needs the near samples
  };

  [[nodiscard]] SurfaceSamples samples_of(const Mesh& mesh) const;
  [[nodiscard]] ObjectShape shape_of(const Object& object) const;
  /// visit(samples, mesh in world space, style, whether an eye of the box may be within the object's radius).
  template <class Visit>
  void for_each_part(std::uint32_t object, const Box& eyes, Visit&& visit) const;
  [[nodiscard]] const Features& counts_from(std::uint32_t object, const Box& eyes) const;
  void add(std::uint32_t object, std::uint32_t level, const PreparedView& view, Features& sum, ScreenCoverage& coverage) const;

  const Scene* scene_;
  Camera camera_;
  double most_passed_pixels_;
  std::vector<Term> pixel_terms_;
  std::vector<SurfaceSamples> samples_;  // per mesh
  std::vector<ObjectShape> shapes_;      // per object
};

}  // namespace standin
