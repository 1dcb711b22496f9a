// Views that try an impostor's promise where it is most likely to break (see sample_cell_views).
#include <cmath>

#include "render/base/rng.h"
#include "server/verify/impostor_rays.h"

namespace standin {
namespace {

// A shaft has no far end; beyond this many times its least distance an image of the cluster is a few pixels.
constexpr double kDeepest = 16.0;

enum class Stratum { kCorner, kNear, kSide, kDeep };

double sign(Rng& rng) {
  return rng.below(2) == 0 ? -1.0 : 1.0;
}

Vec3 position_in(const Shaft& shaft, const Box& /*target*/, Stratum stratum, Rng& rng) {
  Vec2 across(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0));
  if (stratum == Stratum::kCorner) across = Vec2(sign(rng), sign(rng));
  if (stratum == Stratum::kSide) across[static_cast<int>(rng.below(2))] = sign(rng);
  const bool near = stratum == Stratum::kCorner || stratum == Stratum::kNear;
  const double along = shaft.min_distance_m * (near ? 1.0 : std::pow(kDeepest, rng.uniform()));
  return shaft.apex + along * (shaft.axis + across.x * shaft.tan_half.x * shaft.right + across.y * shaft.tan_half.y * shaft.up);
}

// The near border of a box is the face across the axis in which it is farthest from the target.
Vec3 position_in(const Box& box, const Box& target, Stratum stratum, Rng& rng) {
  const Vec3 gap = glm::max(box.min - target.max, target.min - box.max);
  const int axis = gap.x >= gap.y && gap.x >= gap.z ? 0 : gap.y >= gap.z ? 1 : 2;
  Vec3 share(rng.uniform(), rng.uniform(), rng.uniform());
  if (stratum == Stratum::kCorner) share = glm::round(share);
  if (stratum == Stratum::kSide) share[(axis + 1 + static_cast<int>(rng.below(2))) % 3] = static_cast<double>(rng.below(2));
  if (stratum == Stratum::kNear) share[axis] = box.centre()[axis] < target.centre()[axis] ? 1.0 : 0.0;
  return box.min + share * box.size();
}

}  // namespace

std::vector<View> sample_cell_views(const ViewCell& cell, const Box& target, std::uint32_t count, std::uint64_t seed) {
  std::vector<View> views(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    Rng rng(seed, i);
    const auto stratum = static_cast<Stratum>(i % 4);
    views[i].position = std::visit([&](const auto& shape) { return position_in(shape, target, stratum, rng); }, cell);
    const Vec3 aim(rng.uniform(), rng.uniform(), rng.uniform());
    const Vec3 way = target.min + aim * target.size() - views[i].position;
    if (glm::length(way) > 0.0) views[i].direction = glm::normalize(way);
  }
  return views;
}

}  // namespace standin
