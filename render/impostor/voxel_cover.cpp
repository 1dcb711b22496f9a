#include "render/impostor/voxel_cover.h"

#include <algorithm>
#include <cmath>

namespace standin {
namespace {

constexpr double kSlack = 1e-9;

struct BoxAt {
  Vec3 centre{0.0};
  Vec3 half{0.0};
};

/// Whether the line through the box's centre along `axis` meets the triangle within the box.
bool centre_line_meets(const CoverTriangle& t, const BoxAt& box, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double sign = t.normal[axis] < 0.0 ? -1.0 : 1.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &a = t.corners[i], &b = t.corners[(i + 1) % 3];
    if (sign * ((b[u] - a[u]) * (box.centre[v] - a[v]) - (b[v] - a[v]) * (box.centre[u] - a[u])) < 0.0) return false;
  }
  const double offset = glm::dot(t.normal, box.centre - t.corners[0]);
  return std::abs(offset) <= box.half[axis] * std::abs(t.normal[axis]);
}

/// The nine axes of the separating axis theorem that are normal to an edge of each.
bool edge_axis_separates(const CoverTriangle& t, const BoxAt& box) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 edge = t.corners[(i + 1) % 3] - t.corners[i];
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 unit(0.0);
      unit[axis] = 1.0;
      const Vec3 n = glm::cross(edge, unit);
      const double a = glm::dot(n, t.corners[i] - box.centre), b = glm::dot(n, t.corners[(i + 2) % 3] - box.centre);
      const double reach = glm::dot(glm::abs(n), box.half) + kSlack;
      if (std::min(a, b) > reach || std::max(a, b) < -reach) return true;
    }
  }
  return false;
}

/// Closed overlap.
bool overlap(const CoverTriangle& t, const BoxAt& box) {
  if (glm::any(glm::greaterThan(t.low, box.centre + box.half + kSlack)) || glm::any(glm::lessThan(t.high, box.centre - box.half - kSlack)))
    return false;
  const Vec3 weight = glm::abs(t.normal) * box.half;
  if (std::abs(glm::dot(t.normal, box.centre - t.corners[0])) > weight.x + weight.y + weight.z + kSlack) return false;
  const int axis = weight.x > weight.y ? (weight.x > weight.z ? 0 : 2) : (weight.y > weight.z ? 1 : 2);
  return centre_line_meets(t, box, axis) || !edge_axis_separates(t, box);
}

}  // namespace

CoverTriangle::CoverTriangle(const Vec3& a, const Vec3& b, const Vec3& c)
    : corners{a, b, c}, normal(glm::cross(b - a, c - a)), low(glm::min(a, glm::min(b, c))), high(glm::max(a, glm::max(b, c))) {
  const double length = glm::length(normal);
  if (length > 0.0) normal /= length;
}

VoxelCover::VoxelCover(const VoxelLattice& lattice, const LatticeDepths& depths, double enlargement)
    : lattice_(lattice), half_side_(0.5 * enlargement) {
  for (std::size_t k = 0; k < depths.plane.size(); ++k) {
    const double plane = depths.plane[k];
    depth_.push_back({plane + enlargement * (depths.near[k] - plane), plane + enlargement * (depths.far[k] - plane)});
    half_depth_.push_back(enlargement * std::max(plane - depths.near[k], depths.far[k] - plane));
  }
}

bool VoxelCover::meets(const CoverTriangle& triangle, const Voxel& voxel) const {
  return overlap(triangle, {Vec3(voxel.x + 0.5, voxel.y + 0.5, voxel.depth), Vec3(half_side_, half_side_, half_depth_[voxel.layer])});
}

/// The largest share of the way at which the segment leaves an enlarged free voxel that holds its point at `share`; -1 if there is none.
double VoxelCover::farthest_exit(const Vec3& from, const Vec3& to, double share) const {
  const Vec3 way = to - from, p = from + share * way;
  const auto exit = [&](double low, double high, int axis) {
    if (std::abs(way[axis]) < kSlack) return 1.0;
    return std::min(1.0, ((way[axis] > 0.0 ? high : low) - from[axis]) / way[axis]);
  };
  const auto first = [&](double value) { return std::max(0, static_cast<int>(std::ceil(value - 0.5 - half_side_ - kSlack))); };
  const auto last = [&](double value, std::uint32_t size) {
    return std::min(static_cast<int>(size) - 1, static_cast<int>(std::floor(value - 0.5 + half_side_ + kSlack)));
  };
  double best = -1.0;
  const auto end = std::partition_point(depth_.begin(), depth_.end(), [&](const Span& span) { return span.low <= p.z + kSlack; });
  for (auto k = end; k-- != depth_.begin() && k->high >= p.z - kSlack;) {
    const BitImage& free = lattice_.layers[static_cast<std::size_t>(k - depth_.begin())].free;
    const double exit_z = exit(k->low, k->high, 2);
    for (int y = first(p.y); exit_z > best && y <= last(p.y, lattice_.height); ++y)
      for (int x = first(p.x); x <= last(p.x, lattice_.width); ++x)
        if (free.test(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)))
          best = std::max(best, std::min({exit_z, exit(x + 0.5 - half_side_, x + 0.5 + half_side_, 0),
                                          exit(y + 0.5 - half_side_, y + 0.5 + half_side_, 1)}));
  }
  return best;
}

bool VoxelCover::covers(const Vec3& from, const Vec3& to) const {
  for (double share = 0.0; share < 1.0;) {
    const double exit = farthest_exit(from, to, share);
    if (exit <= share) return false;
    share = exit;
  }
  return true;
}

}  // namespace standin
