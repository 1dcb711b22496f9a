#include "estimation/object_from_box.h"

#include <algorithm>

namespace standin {
namespace {

namespace stdx = std::experimental;

void set_lane(SampleBlock& block, std::size_t lane, const Patch& patch, const MostInImage& most, const Box& eyes) {
  block.bearings.set(lane, patch.centre, most.reach_m, eyes);
  block.corner_depth_m[lane] = most.corner_depth_m;
  block.facing_px_m2[lane] = most.facing_px_m2;
  block.softening_m2[lane] = most.softening_m2;
  block.edges_px_m[lane] = most.edges_px_m;
  block.triangles[lane] = patch.triangles;
}

void enclose(SampleBlock& block, std::size_t lanes) {
  Box bounds;
  for (std::size_t lane = 0; lane < lanes; ++lane) bounds.extend(block.bearings.point(lane));
  block.centre = bounds.centre();
  for (std::size_t lane = 0; lane < lanes; ++lane)
    block.radius_m = std::max(block.radius_m, glm::length(block.bearings.point(lane) - block.centre) + block.bearings.reach_m[lane]);
  for (std::size_t lane = lanes; lane < kLanes; ++lane) block.corner_depth_m[lane] = 1.0;  // not 0 / 0
}

}  // namespace

std::vector<SampleBlock> facing_blocks(std::span<const SurfaceSample> samples, const PlacedMesh& mesh, bool double_sided,
                                       const ProjectionFromBox& projection, const Box& eyes) {
  std::vector<SampleBlock> blocks;
  blocks.reserve((samples.size() + kLanes - 1) / kLanes);  // they are large: nothing is to be moved twice
  std::size_t lane = kLanes;
  for (const SurfaceSample& sample : samples) {
    const Patch patch = mesh.place(sample);
    const MostInImage most = projection.most(patch, double_sided);
    if (!most.faces) continue;
    if (lane == kLanes) {
      if (!blocks.empty()) enclose(blocks.back(), kLanes);
      blocks.emplace_back();
      lane = 0;
    }
    set_lane(blocks.back(), lane++, patch, most, eyes);
  }
  if (!blocks.empty()) enclose(blocks.back(), lane);
  blocks.shrink_to_fit();
  return blocks;
}

PartSum most_in_gaze(std::span<const SampleBlock> blocks, PixelKind kind, const Gaze& gaze, double cos_corner) {
  Lanes triangles(0.0), edge_pixels(0.0), pixels(0.0);
  for (const SampleBlock& block : blocks) {
    const auto planes = gaze.planes_across(block.centre, block.radius_m);
    if (!planes) continue;
    const LaneRow least_cosine = gaze.least_cosines(block.bearings, *planes);
    for (std::size_t lane = 0; lane < kLanes; lane += Lanes::size()) {
      const Lanes cosine = lanes_at(least_cosine, lane);
      const Lanes depth_m = stdx::max(cosine / cos_corner, Lanes(1.0)) * lanes_at(block.corner_depth_m, lane);
      Lanes some = lanes_at(block.triangles, lane);
      stdx::where(cosine <= 0.0, some) = 0.0;
      triangles += some;
      edge_pixels += stdx::min(lanes_at(block.edges_px_m, lane) / depth_m, most_edge_pixels(kind) * some);
      some = lanes_at(block.facing_px_m2, lane) / (depth_m * (depth_m * depth_m + lanes_at(block.softening_m2, lane)));
      stdx::where(cosine <= 0.0, some) = 0.0;
      pixels += some;
    }
  }
  // An estimate adds them up in another order.
  constexpr double kSummation = 1.0 + 1e-12;
  return {kSummation * stdx::reduce(triangles), kSummation * stdx::reduce(edge_pixels), stdx::reduce(pixels)};
}

}  // namespace standin
