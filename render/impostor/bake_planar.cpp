#include "render/impostor/bake_planar.h"

#include <array>
#include <cmath>

#include "render/impostor/recording.h"

namespace standin {
namespace {

/// Parts per axis: a shaft's right and up (the third is 1), a box's x, y and z.
using Cut = std::array<std::uint32_t, 3>;

/// The square pyramids that shafts are need not be equal halves of one: a part is the shaft about its middle ray that holds all four of its
/// corner rays, and begins where the first of them does.
Shaft shaft_around(const Shaft& whole, const std::array<Vec3, 4>& corner_rays) {
  Vec3 sum(0.0);
  for (const Vec3& ray : corner_rays) sum += glm::normalize(ray);
  Shaft part = whole;
  part.axis = glm::normalize(sum);
  part.right = glm::normalize(glm::cross(whole.up, part.axis));
  part.up = glm::cross(part.axis, part.right);
  part.min_distance_m = std::numeric_limits<double>::infinity();
  part.tan_half = Vec2(0.0);
  for (const Vec3& ray : corner_rays) {
    const double along = glm::dot(ray, part.axis);
    part.tan_half = glm::max(part.tan_half, glm::abs(Vec2(glm::dot(ray, part.right), glm::dot(ray, part.up))) / along);
    part.min_distance_m = std::min(part.min_distance_m, whole.min_distance_m * along);
  }
  return part;
}

/// Tangent of border i of n equal angles from -atan(tan_half) to atan(tan_half); the outermost ones exactly.
double border(double tan_half, std::uint32_t i, std::uint32_t n) {
  if (i == 0 || i == n) return i == 0 ? -tan_half : tan_half;
  return std::tan(std::atan(tan_half) * (2.0 * i / n - 1.0));
}

ViewCell part_of(const Shaft& shaft, const Cut& cut, const Cut& at) {
  if (cut == Cut{1, 1, 1}) return shaft;
  std::array<Vec3, 4> rays;
  for (std::uint32_t corner = 0; corner < 4; ++corner)
    rays.at(corner) = shaft.axis + border(shaft.tan_half.x, at[0] + corner % 2, cut[0]) * shaft.right +
                      border(shaft.tan_half.y, at[1] + corner / 2, cut[1]) * shaft.up;
  return shaft_around(shaft, rays);
}

ViewCell part_of(const Box& box, const Cut& cut, const Cut& at) {
  Box part = box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    const auto border_at = [&](std::uint32_t k) { return k == cut[i] ? box.max[axis] : box.min[axis] + box.size()[axis] * k / cut[i]; };
    part.min[axis] = border_at(at[i]);
    part.max[axis] = border_at(at[i] + 1);
  }
  return part;
}

ViewCell part_of(const ViewCell& cell, const Cut& cut, const Cut& at) {
  return std::visit([&](const auto& shape) { return part_of(shape, cut, at); }, cell);
}

/// visit(part) for each part until it returns false; whether it never did.
template <class Visit>
bool for_each_part(const ViewCell& cell, const Cut& cut, const Visit& visit) {
  for (std::uint32_t z = 0; z < cut[2]; ++z)
    for (std::uint32_t y = 0; y < cut[1]; ++y)
      for (std::uint32_t x = 0; x < cut[0]; ++x)
        if (!visit(part_of(cell, cut, {x, y, z}))) return false;
  return true;
}

/// Whether a cut of the cell serves, tried from the fewest parts on.
template <class Serves>
std::optional<Cut> fewest(const ViewCell& cell, std::uint32_t max_parts, const Serves& serves) {
  const bool shaft = std::holds_alternative<Shaft>(cell);
  for (std::uint32_t parts = 1; parts <= max_parts; ++parts)
    for (std::uint32_t x = 1; x <= parts; ++x) {
      if (parts % x != 0) continue;
      const std::uint32_t rest = parts / x;
      for (std::uint32_t y = shaft ? rest : 1; y <= rest; ++y)
        if (const Cut cut{x, y, rest / y}; rest % y == 0 && serves(cut)) return cut;
    }
  return std::nullopt;
}

}  // namespace

Impostor bake_planar(const Scene& scene, const TexturePyramids& textures, const BakeRequest& request, const Camera& camera,
                     const BakeQuality& quality, const WorkBudget& budget) {
  const ImpostorPlan plan = plan_request(scene, request, camera, quality);
  if (plan.layers.size() > 1)
    throw impossible(request, "needs " + std::to_string(plan.layers.size()) + " layers; a planar impostor has one");
  Impostor impostor = bake_layered(scene, textures, request, camera, quality, budget);
  impostor.technique = Technique::kPlanar;
  return impostor;
}

std::vector<BakeRequest> planar_requests(const Scene& scene, const BakeRequest& request, const Camera& camera, const BakeQuality& quality,
                                         std::uint32_t max_parts) {
  BakeQuality planar = quality;
  planar.max_layers = 1;
  const RequestPlanner planner(scene, request);
  const auto one_layer_is_enough = [&](const ViewCell& part) { return planner.plan(part, camera, planar).possible; };
  const auto cut = fewest(request.view_cell, max_parts,
                          [&](const Cut& candidate) { return for_each_part(request.view_cell, candidate, one_layer_is_enough); });
  if (!cut) throw impossible(request, "one layer each is not enough for " + std::to_string(max_parts) + " parts of the view cell");
  std::vector<BakeRequest> requests;
  for_each_part(request.view_cell, *cut, [&](const ViewCell& part) {
    requests.push_back({request.objects, part});
    return true;
  });
  return requests;
}

}  // namespace standin
