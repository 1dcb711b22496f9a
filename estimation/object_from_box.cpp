#include "estimation/object_from_box.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "render/base/vector_clones.h"

namespace standin {
namespace {

// An estimate adds the same up in another order.
constexpr double kSummation = 1.0 + 1e-12;

// Of the distance: the radius of samples that are taken together. At 45 degrees of view what they show grows by up to two percent, less in
// the image's middle.
constexpr double kCloseShare = 0.01;

struct WholePatch : Patch {
  explicit WholePatch(const Patch& patch) : Patch(patch), radius_m(std::sqrt(radius2_m2(glm::length(vector_area_m2)))) {}
  double radius_m;
};

/// Fills blocks lane by lane.
class BlockBuilder {
 public:
  BlockBuilder(std::span<const WholePatch> patches, PartStyle style, const ProjectionFromBox& projection, const EyeBoxes& from)
      : style_(style), projection_(projection), from_(from) {
    take(patches);
    if (!blocks_.empty()) complete_block();
    blocks_.shrink_to_fit();
  }

  std::vector<SampleBlock> blocks() { return std::move(blocks_); }

 private:
  struct Sphere {
    Vec3 centre{0.0};
    double radius_m = 0.0;
  };

  void take(std::span<const WholePatch> patches) {
    const Sphere around = sphere_around(patches);
    if (patches.size() > 1 && around.radius_m <= kCloseShare * distance(around.centre, from_.all)) return add_together(patches, around);
    if (patches.size() <= kSampleGroup) return add_each(patches);
    take(patches.first(half_of_groups(patches.size())));
    take(patches.subspan(half_of_groups(patches.size())));
  }

  /// Of whole patches: those in a close one are small as seen from its distance (is_small).
  static Sphere sphere_around(std::span<const WholePatch> patches) {
    Box bounds;
    for (const WholePatch& patch : patches) bounds.extend(patch.centre);
    Sphere sphere{bounds.empty() ? Vec3(0.0) : bounds.centre(), 0.0};
    for (const WholePatch& patch : patches)
      sphere.radius_m = std::max(sphere.radius_m, glm::length(patch.centre - sphere.centre) + patch.radius_m);
    return sphere;
  }

  void add_each(std::span<const WholePatch> patches) {
    for (const WholePatch& patch : patches)
      if (const MostInImage most = projection_.most(patch, style_.double_sided); most.faces)
        add(patch.centre, most, patch.triangles, most_edges(patch));
  }

  [[nodiscard]] double most_edges(const Patch& patch) const { return most_edge_pixels(style_.kind) * patch.triangles; }

  // The sums are exact where the nearest is at its corner depth, and never too small deeper down: softening_m2 / depth^2 is the largest.
  void add_together(std::span<const WholePatch> patches, const Sphere& around) {
    MostInImage sum{.faces = false, .reach_m = around.radius_m, .corner_depth_m = std::numeric_limits<double>::infinity()};
    double triangles = 0.0, pixels = 0.0, edge_pixels = 0.0, most_edges_px = 0.0, softening = 0.0;
    for (const WholePatch& patch : patches) {
      const MostInImage most = projection_.most(patch, style_.double_sided);
      if (!most.faces) continue;
      sum.faces = true;
      sum.corner_depth_m = std::min(sum.corner_depth_m, most.corner_depth_m);
      softening = std::max(softening, most.softening_m2 / (most.corner_depth_m * most.corner_depth_m));
      triangles += patch.triangles;
      pixels += most.pixels();
      edge_pixels += most.edge_pixels();
      most_edges_px += std::min(most.edge_pixels(), most_edges(patch));
    }
    if (!sum.faces) return;
    sum.softening_m2 = softening * sum.corner_depth_m * sum.corner_depth_m;
    sum.facing_px_m2 = kSummation * pixels * sum.corner_depth_m * (sum.corner_depth_m * sum.corner_depth_m + sum.softening_m2);
    sum.edges_px_m = kSummation * edge_pixels * sum.corner_depth_m;
    add(around.centre, sum, triangles, most_edges_px);
  }

  void add(const Vec3& centre, const MostInImage& most, double triangles, double most_edges_px) {
    if (blocks_.empty() || lanes_ == kLanes) {
      if (!blocks_.empty()) complete_block();
      blocks_.emplace_back();
      lanes_ = 0;
    }
    SampleBlock& block = blocks_.back();
    block.bearings.set(lanes_, centre, most.reach_m, from_.eyes);
    block.corner_depth_m[lanes_] = most.corner_depth_m;
    block.facing_px_m2[lanes_] = most.facing_px_m2;
    block.softening_m2[lanes_] = most.softening_m2;
    block.edges_px_m[lanes_] = most.edges_px_m;
    block.triangles[lanes_] = triangles;
    block.most_edges_px[lanes_++] = most_edges_px;
  }

  void complete_block() {
    SampleBlock& block = blocks_.back();
    block.bearings.look_from(from_.eyes);
    Box bounds;
    for (std::size_t lane = 0; lane < lanes_; ++lane) bounds.extend(block.bearings.point(lane));
    block.centre = bounds.centre();
    for (std::size_t lane = 0; lane < lanes_; ++lane)
      block.radius_m = std::max(block.radius_m, glm::length(block.bearings.point(lane) - block.centre) + block.bearings.reach_m[lane]);
    for (std::size_t lane = lanes_; lane < kLanes; ++lane) block.corner_depth_m[lane] = 1.0;  // not 0 / 0
  }

  PartStyle style_;
  const ProjectionFromBox& projection_;
  const EyeBoxes& from_;
  std::vector<SampleBlock> blocks_;
  std::size_t lanes_ = 0;  // of the last block
};

}  // namespace

std::vector<SampleBlock> facing_blocks(std::span<const SurfaceSample> samples, const PlacedMesh& mesh, PartStyle style,
                                       const ProjectionFromBox& projection, const EyeBoxes& from) {
  std::vector<WholePatch> patches;
  patches.reserve(samples.size());
  for (const SurfaceSample& sample : samples) patches.emplace_back(mesh.place(sample));
  return BlockBuilder(patches, style, projection, from).blocks();
}

STANDIN_VECTOR_CLONES PartSum most_in_gaze(std::span<const SampleBlock> blocks, const Gaze& gaze, double cos_corner) {
  LaneRow triangles{}, edge_pixels{}, pixels{}, least_cosine;
  for (const SampleBlock& block : blocks) {
    const auto planes = gaze.planes_across(block.centre, block.radius_m);
    if (!planes) continue;
    gaze.least_cosines(block.bearings, *planes, least_cosine);
    for (std::size_t i = 0; i < kLanes; ++i) {
      const double seen = least_cosine[i] > 0.0 ? 1.0 : 0.0;
      const double depth_m = std::max(least_cosine[i] / cos_corner, 1.0) * block.corner_depth_m[i];
      triangles[i] += seen * block.triangles[i];
      edge_pixels[i] += seen * std::min(block.edges_px_m[i] / depth_m, block.most_edges_px[i]);
      pixels[i] += seen * block.facing_px_m2[i] / (depth_m * (depth_m * depth_m + block.softening_m2[i]));
    }
  }
  const auto sum = [](const LaneRow& row) { return std::accumulate(row.begin(), row.end(), 0.0); };
  return {kSummation * sum(triangles), kSummation * sum(edge_pixels), sum(pixels)};
}

}  // namespace standin
