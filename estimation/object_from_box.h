// What the samples of an object may show at most to eyes in a box, prepared once per 3D cell and asked about its many gazes.
#pragma once

#include <span>
#include <vector>

#include "estimation/features.h"
#include "estimation/gaze.h"
#include "estimation/part_sum.h"
#include "estimation/placed_mesh.h"

namespace standin {

/// Samples that lie within a sphere, a lane each. Empty lanes show nothing.
struct SampleBlock {
  Vec3 centre{0.0};  // relative to the middle of the eyes
  double radius_m = 0.0;
  Bearings bearings;
  LaneRow corner_depth_m{}, facing_px_m2{}, softening_m2{}, edges_px_m{}, triangles{};  // as in MostInImage
};

/// Those that face some eye, in blocks of neighbours.
[[nodiscard]] std::vector<SampleBlock> facing_blocks(std::span<const SurfaceSample> samples, const PlacedMesh& mesh, bool double_sided,
                                                     const ProjectionFromBox& projection, const Box& eyes);

/// The most that samples may show to any view of a gaze.
[[nodiscard]] PartSum most_in_gaze(std::span<const SampleBlock> blocks, PixelKind kind, const Gaze& gaze, double cos_corner);

struct ObjectFromBox {
  struct Part {
    PixelKind kind = PixelKind::kPlain;
    double slenderness = 0.0;
    std::vector<SampleBlock> samples;
    std::vector<SampleBlock> near_samples;
  };
  Features counts;  // draws, triangles: the same for every view
  std::vector<Part> parts;
};

}  // namespace standin
