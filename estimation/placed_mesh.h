// A mesh where it stands: its surface samples in world or eye space.
#pragma once

#include <cmath>

#include "estimation/projection.h"
#include "estimation/surface_samples.h"

namespace standin {

class PlacedMesh {
 public:
  /// In the space of `rotation` * (world - `shift`).
  PlacedMesh(const Mat4& world_from_mesh, const Mat3& rotation, const Vec3& shift)
      : placed_from_mesh_(rotation * Mat3(world_from_mesh)),
        area_from_mesh_((glm::determinant(Mat3(world_from_mesh)) < 0.0 ? -1.0 : 1.0) * cofactor(placed_from_mesh_)),
        origin_(rotation * (Vec3(world_from_mesh[3]) - shift)),
        scale_(length_scale(Mat3(world_from_mesh))) {}

  [[nodiscard]] Patch place(const SurfaceSample& sample) const {
    return {placed_from_mesh_ * sample.point + origin_, area_from_mesh_ * sample.vector_area_m2, scale_ * sample.edges_m, sample.triangles};
  }

 private:
  /// The matrix that takes vector areas where `m` takes points.
  static Mat3 cofactor(const Mat3& m) { return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])}; }
  /// By how much lengths in all directions grow; root mean square where the axes differ.
  static double length_scale(const Mat3& m) {
    return std::sqrt((glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2])) / 3.0);
  }

  Mat3 placed_from_mesh_;
  Mat3 area_from_mesh_;  // keeps front sides front under a mirroring transform, as the renderer does
  Vec3 origin_;
  double scale_;
};

}  // namespace standin
