// A mesh reduced to a few points that stand for its surface: what the features of a view are summed over.
//
// Two sets, each drawn by systematic sampling (fixed positions along a running sum, so the same mesh gives the same samples): points spread
// evenly over the *area* carry the pixels, triangles spread evenly over the *count* carry the triangle terms. One set cannot serve both: a
// street of two triangles and its kerb of two thousand cover different shares of the screen than of the index buffer.
#pragma once

#include <cstdint>
#include <vector>

#include "render/scene/scene.h"

namespace standin {

/// A patch of surface: a point of it and its vector area (area times unit normal by winding), in mesh space.
struct SurfacePatch {
  Vec3 point{0.0};
  Vec3 vector_area_m2{0.0};
};

struct SurfaceSamples {
  std::vector<SurfacePatch> patches;       // together the whole area
  std::vector<SurfacePatch> near_patches;  // the same area in more patches, for an eye so near that some fill the image
  std::vector<SurfacePatch> triangles;     // whole single triangles, centroids
  double triangles_per_sample = 0.0;       // how many triangles each of `triangles` stands for
};

inline constexpr std::uint32_t kNearFactor = 16;
/// At most `count` >= 1 patches and triangles, kNearFactor times as many near patches; every triangle where there are no more than `count`.
[[nodiscard]] SurfaceSamples sample_surface(const Mesh& mesh, std::uint32_t count);

}  // namespace standin
