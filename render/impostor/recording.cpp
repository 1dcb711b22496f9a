#include "render/impostor/recording.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "render/impostor/recorder.h"
#include "render/scene/object_bounds.h"

namespace standin {
namespace {

void validate(const Scene& scene, const BakeRequest& request) {
  if (request.objects.empty()) throw Failure(ErrorWord::kBadUsage, "bake request without objects: at least one is needed");
  for (const std::uint32_t id : request.objects)
    if (id >= scene.objects.size())
      throw Failure(ErrorWord::kBadUsage, "bake request names object " + std::to_string(id) + " of a scene with " +
                                              std::to_string(scene.objects.size()) + " objects");
}

std::vector<Vec3> world_vertices(const Scene& scene, std::span<const std::uint32_t> objects) {
  std::vector<Vec3> points;
  for (const std::uint32_t id : objects) {
    const Object& object = scene.objects[id];
    for (std::uint32_t i = 0; i < object.part_count; ++i)
      for (const glm::vec3& position : scene.meshes[scene.parts[object.first_part + i].mesh].positions)
        points.emplace_back(object.world_from_object * Vec4(Vec3(position), 1.0));
  }
  return points;
}

bool holds_masked(const Scene& scene, std::span<const std::uint32_t> objects) {
  return std::any_of(objects.begin(), objects.end(), [&](std::uint32_t id) {
    const auto first = scene.parts.begin() + static_cast<std::ptrdiff_t>(scene.objects[id].first_part);
    return std::any_of(first, first + static_cast<std::ptrdiff_t>(scene.objects[id].part_count),
                       [&](const Part& part) { return scene.materials[part.material].alpha_mode == AlphaMode::kMask; });
  });
}

Coverage coverage_of(const BakeQuality& quality) {
  if (!quality.supercover) return Coverage::kCentre;
  return quality.fuzzy ? Coverage::kFuzzy : Coverage::kClosed;
}

double most_shift(const ShiftBound& shifts, const std::vector<Layer>& layers) {
  double most = 0.0;
  for (const Layer& layer : layers)
    for (const double depth_m : {layer.near_m, layer.far_m}) {
      const Vec2 texels = shifts.texels(depth_m, layer.distance_m);
      most = std::max({most, texels.x, texels.y});
    }
  return most;
}

/// Room for so many texels beyond the objects on each side.
ImpostorFrame padded(ImpostorFrame frame, double texels) {
  constexpr double kMostTexels = 2.0;  // layers a texel apart shift no further; only a test's may
  const auto room = static_cast<std::uint32_t>(std::ceil(std::min(texels, kMostTexels)));
  frame.slope_min += static_cast<double>(room) * Vec2(-frame.slope_step.x, frame.slope_step.y);
  frame.width += 2 * room;
  frame.height += 2 * room;
  return frame;
}

}  // namespace

RequestPlanner::RequestPlanner(const Scene& scene, const BakeRequest& request) {
  validate(scene, request);
  bounds_ = bounds_of(scene, request.objects);
  points_ = world_vertices(scene, request.objects);
}

ImpostorPlan RequestPlanner::plan(const ViewCell& cell, const Camera& camera, const BakeQuality& quality) const {
  return plan_impostor(bounds_, points_, cell, camera, quality);
}

ImpostorPlan plan_request(const Scene& scene, const BakeRequest& request, const Camera& camera, const BakeQuality& quality) {
  ImpostorPlan plan = RequestPlanner(scene, request).plan(request.view_cell, camera, quality);
  if (!plan.possible) throw impossible(request, plan.why_not);
  return plan;
}

Failure impossible(const BakeRequest& request, const std::string& why) {
  return {ErrorWord::kImpostorImpossible, "impostor of " + std::to_string(request.objects.size()) + " objects from object " +
                                              std::to_string(request.objects.front()) + " on: " + why};
}

Recording record_request(const Scene& scene, const TexturePyramids& textures, const BakeRequest& request, const Camera& camera,
                         const BakeQuality& quality, const WorkBudget& budget) {
  const ImpostorPlan plan = plan_request(scene, request, camera, quality);
  const ShiftBound shifts(plan.setup, plan.frame);
  const ImpostorFrame frame = quality.seal_rims ? padded(plan.frame, most_shift(shifts, plan.layers)) : plan.frame;
  return {frame, plan.layers,
          record_layers(scene, textures, request.objects, frame, plan.layers, coverage_of(quality), budget,
                        quality.leave_out ? Texturing::kWhereTextured : Texturing::kEverywhere, quality.seal_rims ? &shifts : nullptr),
          quality.fuzzy && holds_masked(scene, request.objects)};
}

BitImage opaque_texels(const LayerImage& image) {
  BitImage opaque(image.width(), image.height());
  image.for_each_opaque([&](std::uint32_t x, std::uint32_t y) { opaque.set(x, y); });
  return opaque;
}

}  // namespace standin
