#include "render/visibility/aimed_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "render/visibility/region_rays.h"

namespace standin {
namespace {

constexpr int kRounds = 2;                    // over the unseen objects, at most
constexpr double kRaysPerSteradian = 1000.0;  // aimed at an object in a round, by the solid angle of its bounds; one at least ...
constexpr double kMostRays = 8.0;             // ... and no more than these
constexpr int kExploringRays = 64;            // per object found
constexpr double kExploredBounds = 2.0;       // times the found object's size
constexpr double kExploredRegion = 0.2;       // times the region's

// Of the box's sphere, as seen from the nearest position of the region.
double solid_angle(const Box& region, const Box& object) {
  const double radius_m = 0.5 * object.diagonal();
  const double sine = radius_m > 0.0 ? radius_m / (distance(region, object) + radius_m) : 0.0;
  return 2.0 * std::numbers::pi * (1.0 - std::sqrt(1.0 - sine * sine));
}

// Where a ray from `position` in the box along `way` leaves it.
Vec3 exit_point(const Box& box, const Vec3& position, const Vec3& way) {
  double leave = 1.0;
  for (int axis = 0; axis < 3; ++axis)
    if (way[axis] != 0.0) leave = std::min(leave, ((way[axis] > 0.0 ? box.max : box.min)[axis] - position[axis]) / way[axis]);
  return position + std::max(0.0, leave) * way;
}

}  // namespace

AimedSearch::AimedSearch(const Scene& scene, const Raytracer& raytracer, const Box& region, std::uint64_t rays, Rng& rng,
                         const WorkBudget& budget)
    : scene_(scene), raytracer_(raytracer), region_(region), rays_left_(rays), rng_(rng), budget_(budget) {
  for (const Object& object : scene.objects) seen_.push_back(!intersection(region, object.bounds).empty());
}

std::vector<std::uint32_t> AimedSearch::seen() const {
  std::vector<std::uint32_t> objects;
  for (std::uint32_t object = 0; object < seen_.size(); ++object)
    if (seen_[object]) objects.push_back(object);
  return objects;
}

void AimedSearch::aim() {
  std::vector<Aim> left = aims();
  kept_rays_ = rays_left_ / 2;
  for (int round = 0; round < kRounds && shoot(left) > 0; ++round) std::erase_if(left, [&](const Aim& aim) { return seen_[aim.object]; });
}

std::vector<AimedSearch::Aim> AimedSearch::aims() const {
  std::vector<Aim> aims;
  for (std::uint32_t object = 0; object < seen_.size(); ++object) {
    if (seen_[object] || scene_.objects[object].triangle_count == 0) continue;
    const double rays = kRaysPerSteradian * solid_angle(region_, scene_.objects[object].bounds);
    aims.push_back({object, static_cast<std::uint32_t>(std::clamp(rays, 1.0, kMostRays))});
  }
  return aims;
}

std::uint64_t AimedSearch::shoot(const std::vector<Aim>& aims) {
  std::uint64_t found = 0;
  for (const Aim& aim : aims) {
    budget_.check();
    for (std::uint32_t i = 0; i < aim.rays && !seen_[aim.object] && rays_left_ > kept_rays_ && spend(); ++i) {
      const Vec3 target = target_on(aim.object);
      const Vec3 inside = random_point(rng_, region_);
      const Vec3 position = exit_point(region_, inside, target - inside);
      const auto hit = shoot_at(target, position);
      if (hit && add(hit->object, position)) ++found;
    }
  }
  return found;
}

bool AimedSearch::add(std::uint32_t object, const Vec3& position) {
  if (seen_[object]) return false;
  seen_[object] = true;
  std::vector<std::pair<Vec3, std::uint32_t>> waiting = {{position, object}};
  while (!waiting.empty()) {
    const auto [centre, found] = waiting.back();
    waiting.pop_back();
    const Box& bounds = scene_.objects[found].bounds;
    for (int i = 0; i < kExploringRays && spend(); ++i) {
      const Vec3 moved = centre + kExploredRegion * (random_point(rng_, region_) - region_.centre());
      const Vec3 inside = glm::clamp(moved, region_.min, region_.max);
      const Vec3 target = bounds.centre() + kExploredBounds * (random_point(rng_, bounds) - bounds.centre());
      const Vec3 from = exit_point(region_, inside, target - inside);
      const auto hit = shoot_at(target, from);
      if (!hit || seen_[hit->object]) continue;
      seen_[hit->object] = true;
      waiting.emplace_back(from, hit->object);
    }
  }
  return true;
}

// Triangles lie where the object can be seen; much of its bounds is empty.
Vec3 AimedSearch::target_on(std::uint32_t id) {
  const Object& object = scene_.objects[id];
  const Mesh& mesh = scene_.meshes[scene_.parts[object.first_part + rng_.below(object.part_count)].mesh];
  if (mesh.indices.empty()) return random_point(rng_, object.bounds);
  const std::size_t triangle = rng_.below(mesh.triangle_count());
  const double side = std::sqrt(rng_.uniform());
  const double along = rng_.uniform();
  const auto corner = [&](std::size_t k) { return Vec3(mesh.positions[mesh.indices[3 * triangle + k]]); };
  const Vec3 point = (1.0 - side) * corner(0) + side * (1.0 - along) * corner(1) + side * along * corner(2);
  return Vec3(object.world_from_object * Vec4(point, 1.0));
}

std::optional<Hit> AimedSearch::shoot_at(const Vec3& target, const Vec3& position) const {
  const Vec3 way = target - position;
  const double length = glm::length(way);
  return length > 0.0 ? raytracer_.nearest(position, way / length) : std::nullopt;
}

}  // namespace standin
