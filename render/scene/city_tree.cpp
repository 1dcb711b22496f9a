// Trees: a trunk, branches towards the crown, and leaf cards around the branches' ends that take up the rest of the budget exactly. They
// are the heavy objects of the city: thousands of alpha-masked cards of which every pixel sees several.

#include <cmath>
#include <numbers>

#include "render/base/rng.h"
#include "render/scene/city_parts.h"
#include "render/scene/mesh_builder.h"

namespace standin {
namespace {

Vec3 random_unit(Rng& rng) {
  const double y = rng.uniform(-1.0, 1.0);
  const double angle = rng.uniform(0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - y * y);
  return {r * std::cos(angle), y, r * std::sin(angle)};
}

struct Crown {
  Vec3 centre;
  Vec3 radii;
};

Crown crown_of(const TreeShape& shape) {
  const double half_height_m = 0.34 * shape.height_m;
  return {{0.0, shape.height_m - half_height_m, 0.0}, {shape.crown_radius_m, half_height_m, shape.crown_radius_m}};
}

// The trunk first, then branches while they stay within a third of the budget; returns the branches' ends.
std::vector<Vec3> add_wood(MeshBuilder& wood, const TreeShape& shape, std::uint64_t triangles, Rng& rng) {
  const Crown crown = crown_of(shape);
  const int segments = triangles < 600 ? 5 : (triangles < 4000 ? 8 : 14);
  const double radius_m = 0.02 * shape.height_m;
  wood.tube({0, 0, 0}, crown.centre, radius_m, 0.5 * radius_m, segments, triangles < 600 ? 1 : 4);
  const int branch_segments = triangles < 4000 ? 4 : 7;
  const int branch_rings = triangles < 4000 ? 1 : 3;
  const auto branch_triangles = static_cast<std::size_t>(2 * branch_segments * branch_rings);
  std::vector<Vec3> ends;
  while (ends.size() < 4 || (ends.size() < 60 && 3 * (wood.triangle_count() + branch_triangles) <= triangles)) {
    const Vec3 end = crown.centre + random_unit(rng) * crown.radii * rng.uniform(0.45, 0.8);
    const Vec3 root(0.0, std::min(rng.uniform(0.35, 0.62) * shape.height_m, end.y), 0.0);
    wood.tube(root, end, 0.3 * radius_m, 0.08 * radius_m, branch_segments, branch_rings);
    ends.push_back(end);
  }
  return ends;
}

// Cards cover about the same area however many there are.
void add_leaves(MeshBuilder& leaves, const TreeShape& shape, std::uint64_t cards, const std::vector<Vec3>& ends, Rng& rng) {
  const Crown crown = crown_of(shape);
  const double cover = 5.5;  // area of all cards over that of the crown's outline seen from the side
  const double area_m2 = cover * std::numbers::pi * crown.radii.x * crown.radii.y / static_cast<double>(cards);
  const double half_m = std::min(std::max(0.5 * std::sqrt(area_m2), 0.04), 0.45 * crown.radii.x);
  const double spread = 0.42;
  for (std::uint64_t i = 0; i < cards; ++i) {
    const Vec3& end = ends[i % ends.size()];
    const Vec3 offset = random_unit(rng) * std::cbrt(rng.uniform()) * spread;
    Vec3 place = (end - crown.centre) / crown.radii + offset;
    if (const double length = glm::length(place); length > 1.0) place /= length;
    const Vec3 u = random_unit(rng);
    const Vec3 turned = glm::cross(u, random_unit(rng));
    const Vec3 v = glm::length(turned) > 0.05 ? glm::normalize(turned) : glm::cross(u, glm::normalize(Vec3(u.z, u.x, u.y) + Vec3(0.1)));
    leaves.card(crown.centre + place * crown.radii, u * half_m, v * half_m, glm::normalize(place + 0.3 * u + Vec3(0.0, 0.2, 0.0)));
  }
}

}  // namespace

Model make_tree(const TreeShape& shape, std::uint64_t triangles, std::uint64_t seed) {
  Rng rng(seed, 700);
  MeshBuilder wood;
  MeshBuilder leaves;
  const std::vector<Vec3> ends = add_wood(wood, shape, triangles, rng);
  const std::uint64_t rest = triangles > wood.triangle_count() ? triangles - wood.triangle_count() : 0;
  add_leaves(leaves, shape, std::max<std::uint64_t>(rest / 2, 4), ends, rng);
  Model model;
  model.parts.push_back({wood.finish("wood"), Surface::kBark});
  model.parts.push_back({leaves.finish("leaves"), Surface::kLeaves});
  return model;
}

}  // namespace standin
