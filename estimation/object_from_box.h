// What the samples of an object may show at most to eyes in a box, prepared once per 3D cell and asked about its many gazes.
//
// Samples that lie close together as seen from afar are asked about as one: their sums at the depth of the nearest, seen where any point
// of a sphere around them is. That is still a bound, looser by what the sphere's angle adds to theirs, and most of a city is far away.
#pragma once

#include <span>
#include <vector>

#include "estimation/features.h"
#include "estimation/gaze.h"
#include "estimation/part_sum.h"
#include "estimation/placed_mesh.h"

namespace standin {

/// Samples, or close groups of them, that lie within a sphere, a lane each. Empty lanes show nothing.
struct SampleBlock {
  Vec3 centre{0.0};  // relative to the middle of the eyes
  double radius_m = 0.0;
  Bearings bearings;
  LaneRow corner_depth_m{}, facing_px_m2{}, softening_m2{}, edges_px_m{}, triangles{};  // as in MostInImage
  LaneRow most_edges_px{};                                                              // however deep
};

/// How a part is drawn.
struct PartStyle {
  PixelKind kind = PixelKind::kPlain;
  bool double_sided = false;
};

/// Where samples are looked at from.
struct EyeBoxes {
  Box eyes;
  Box all;  // holds the eyes: what is close as seen from all of it is taken together, so that fewer eyes never see more
};

/// Those that face some eye, in blocks of neighbours.
[[nodiscard]] std::vector<SampleBlock> facing_blocks(std::span<const SurfaceSample> samples, const PlacedMesh& mesh, PartStyle style,
                                                     const ProjectionFromBox& projection, const EyeBoxes& from);

/// The most that samples may show to any view of a gaze.
[[nodiscard]] PartSum most_in_gaze(std::span<const SampleBlock> blocks, const Gaze& gaze, double cos_corner);

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
