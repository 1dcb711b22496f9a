// A mesh reduced to a few points that stand for its surface: what the features of a view are summed over.
//
// Points are drawn by systematic sampling (fixed positions along a running sum, so the same mesh gives the same samples), each triangle as
// often as the mean of its shares of the triangle count, of the area and of all edges' length. One share alone cannot serve: a street of
// two triangles and its kerb of two thousand cover different shares of the screen than of the index buffer.
#pragma once

#include <cstdint>
#include <vector>

#include "render/scene/scene.h"

namespace standin {

/// A point of the surface and what it stands for, in mesh space: a part of a large triangle, or some small triangles.
struct SurfaceSample {
  Vec3 point{0.0};
  Vec3 vector_area_m2{0.0};  // area times unit normal by winding
  double edges_m = 0.0;      // length of the triangles' edges; an edge between two triangles counts twice, as it is drawn twice
  double triangles = 0.0;    // may be a fraction
};

/// Each run of kSampleGroup samples from the first lies close together, so that many can be judged by one sphere.
struct SurfaceSamples {
  std::vector<SurfaceSample> samples;
  std::vector<SurfaceSample> near_samples;  // the same surface in more samples, for an eye so near that some fill the image
  double slenderness = 0.0;                 // edges / sqrt(triangles * area): 4.6 for equilateral triangles, more for slivers
};

inline constexpr std::uint32_t kNearFactor = 16;
inline constexpr std::size_t kSampleGroup = 16;
/// Of `count` neighbours so many are neighbours, too, and so is the rest; and so on, down to single groups.
[[nodiscard]] constexpr std::size_t half_of_groups(std::size_t count) {
  return (count / kSampleGroup + 1) / 2 * kSampleGroup;
}
/// `count` >= 1 samples and kNearFactor times as many near ones, each set adding up to the mesh's area, edges and triangles; none for a
/// mesh without triangles.
[[nodiscard]] SurfaceSamples sample_surface(const Mesh& mesh, std::uint32_t count);
/// Samples of a mesh that is a simpler form of the one that `finer` are of: the same points and areas, since the surface is the same but
/// for a pixel, shared out among its own triangles and edges, no more than the finer one's. So a coarser level is never bounded above a
/// finer.
[[nodiscard]] SurfaceSamples simplified_samples(const SurfaceSamples& finer, const Mesh& mesh);

}  // namespace standin
