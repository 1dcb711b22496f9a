#include "render/visibility/visible_set.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "render/base/parallel.h"
#include "render/base/rng.h"

namespace standin {
namespace {

// A whole batch: kShares x kShares equal shares of the sphere, kRaysPerShare rays each.
constexpr std::uint64_t kShares = 76;
constexpr std::uint64_t kRaysPerShare = 8;
static_assert(kRaysPerShare * kShares * kShares >= 46'100, "ln 0.01 / ln(1 - 1e-4): what certifies a share of 1e-4 at 99 %");
// Aimed in one round: at each object at least kLeastAimed rays, and so many more that all together are a quarter of a batch.
constexpr std::uint64_t kLeastAimed = 2;
constexpr std::uint64_t kAimedRays = kRaysPerShare * kShares * kShares / 4;
constexpr std::uint64_t kExploringRays = 64;  // per object found
constexpr double kExploredBounds = 2.0;       // times the found object's size
constexpr double kExploredRegion = 0.2;       // times the region's

Vec3 random_point(Rng& rng, const Box& box) {
  const double x = rng.uniform();
  const double y = rng.uniform();
  const double z = rng.uniform();
  return box.min + Vec3(x, y, z) * box.size();
}

/// Directions that can lead from a region into the scene: all, or those of a cone where the region lies clear of it.
struct DirectionCap {
  Vec3 axis{0.0, 1.0, 0.0};
  Vec3 right{1.0, 0.0, 0.0};
  Vec3 up{0.0, 0.0, 1.0};
  double height = 2.0;  // 1 - cos of the half angle

  DirectionCap(const Box& region, const Box& scene) {
    const Vec3 way = scene.centre() - region.centre();
    const double distance_m = glm::length(way);
    const double reach_m = 0.5 * (region.diagonal() + scene.diagonal()) * (1.0 + 1e-9);
    if (reach_m >= distance_m) return;
    axis = way / distance_m;
    right = glm::normalize(glm::cross(axis, std::abs(axis.y) < 0.9 ? Vec3(0.0, 1.0, 0.0) : Vec3(1.0, 0.0, 0.0)));
    up = glm::cross(right, axis);
    height = 1.0 - std::sqrt(1.0 - (reach_m / distance_m) * (reach_m / distance_m));
  }
  [[nodiscard]] double share_of_sphere() const { return 0.5 * height; }

  /// Uniform over share (i, j) of shares x shares equal ones (Archimedes).
  [[nodiscard]] Vec3 random_direction(Rng& rng, std::uint64_t i, std::uint64_t j, std::uint64_t shares) const {
    const double along = 1.0 - height * (static_cast<double>(i) + rng.uniform()) / static_cast<double>(shares);
    const double turn = 2.0 * std::numbers::pi * (static_cast<double>(j) + rng.uniform()) / static_cast<double>(shares);
    const double radius = std::sqrt(std::max(0.0, 1.0 - along * along));
    return along * axis + radius * (std::cos(turn) * right + std::sin(turn) * up);
  }
};

/// Side of a whole batch: as many rays as the cap's share of the sphere asks for, but no fewer than a sixteenth, so that what covers little
/// of the sphere is still seen well.
std::uint64_t whole_batch(const DirectionCap& cap) {
  return static_cast<std::uint64_t>(std::ceil(static_cast<double>(kShares) * std::sqrt(std::max(cap.share_of_sphere(), 1.0 / 16.0))));
}

bool meet(const Box& a, const Box& b) {
  return !intersection(a, b).empty();
}

class RegionSampler {
 public:
  RegionSampler(const Scene& scene, const Raytracer& raytracer, const Box& region, const VisibilityOptions& options, std::uint64_t stream,
                const WorkBudget& budget)
      : scene_(scene),
        raytracer_(raytracer),
        region_(region),
        cap_(region, scene.bounds),
        budget_(budget),
        rng_(options.seed, stream),
        rays_left_(options.rays),
        uniform_hits_(scene.objects.size()) {
    for (const Object& object : scene.objects) confirmed_.push_back(meet(region, object.bounds));
  }

  VisibleSet sample() {
    const std::uint64_t whole = whole_batch(cap_);
    std::uint64_t shares = whole;
    bool certified = false;
    while (!certified && shares > 0) {
      shoot_aimed(rays_left_ / 2);
      shares = std::min(whole, static_cast<std::uint64_t>(std::sqrt(static_cast<double>(rays_left_ / kRaysPerShare))));
      const bool found_new = shoot_uniform(shares);
      certified = shares == whole && !found_new;
    }
    return summary(certified);
  }

 private:
  [[nodiscard]] bool is_found(std::uint32_t object) const { return confirmed_[object] || uniform_hits_[object] > 0; }

  [[nodiscard]] std::optional<Hit> shoot_at(const Vec3& target, const Vec3& position) const {
    const Vec3 way = target - position;
    const double length = glm::length(way);
    return length > 0.0 ? raytracer_.nearest(position, way / length) : std::nullopt;
  }

  // At all that has not been found, however small it looks, as far as `limit` goes.
  void shoot_aimed(std::uint64_t limit) {
    if (limit == 0) return;
    const auto count = static_cast<std::uint32_t>(confirmed_.size());
    const auto first = static_cast<std::uint32_t>(rng_.below(count));
    const std::uint64_t rays_each = std::max(kLeastAimed, kAimedRays / count);
    for (std::uint32_t i = 0; i < count; ++i) {
      budget_.check();
      const std::uint32_t object = (first + i) % count;
      for (std::uint64_t k = 0; k < rays_each && !is_found(object); ++k) {
        if (limit-- == 0 || rays_left_ == 0) return;
        --rays_left_;
        const Vec3 position = random_point(rng_, region_);
        const auto hit = shoot_at(random_point(rng_, scene_.objects[object].bounds), position);
        if (!hit) continue;
        const bool is_new = !is_found(hit->object);
        confirmed_[hit->object] = true;
        if (is_new) explore(position, hit->object);
      }
    }
  }

  // A batch over shares x shares equal shares of the sphere. Returns whether it met anything new.
  bool shoot_uniform(std::uint64_t shares) {
    rays_left_ -= kRaysPerShare * shares * shares;
    uniform_rays_ += kRaysPerShare * shares * shares;
    bool found_new = false;
    for (std::uint64_t i = 0; i < shares; ++i) {
      budget_.check();
      for (std::uint64_t ray = 0; ray < kRaysPerShare * shares; ++ray) {
        const Vec3 position = random_point(rng_, region_);
        const auto hit = raytracer_.nearest(position, cap_.random_direction(rng_, i, ray / kRaysPerShare, shares));
        if (!hit) continue;
        const bool is_new = !is_found(hit->object);
        ++uniform_hits_[hit->object];
        if (is_new) explore(position, hit->object);
        found_new = found_new || is_new;
      }
    }
    return found_new;
  }

  // Where one thing is seen, its neighbours are: through the same gap, from about the same place. What is found so is explored in turn.
  void explore(const Vec3& from, std::uint32_t object) {
    std::vector<std::pair<Vec3, std::uint32_t>> waiting = {{from, object}};
    while (!waiting.empty()) {
      const auto [centre, found] = waiting.back();
      waiting.pop_back();
      const Box& bounds = scene_.objects[found].bounds;
      for (std::uint64_t i = 0; i < kExploringRays && rays_left_ > 0; ++i) {
        --rays_left_;
        const Vec3 moved = centre + kExploredRegion * (random_point(rng_, region_) - region_.centre());
        const Vec3 position = glm::clamp(moved, region_.min, region_.max);
        const auto hit = shoot_at(bounds.centre() + kExploredBounds * (random_point(rng_, bounds) - bounds.centre()), position);
        if (!hit || is_found(hit->object)) continue;
        confirmed_[hit->object] = true;
        waiting.emplace_back(position, hit->object);
      }
    }
  }

  [[nodiscard]] VisibleSet summary(bool certified) const {
    VisibleSet set;
    std::uint64_t singletons = 0;
    for (std::uint32_t object = 0; object < confirmed_.size(); ++object) {
      if (is_found(object)) set.objects.push_back(object);
      if (!confirmed_[object] && uniform_hits_[object] == 1) ++singletons;
    }
    set.missed_ray_share =
        uniform_rays_ > 0 ? cap_.share_of_sphere() * static_cast<double>(singletons) / static_cast<double>(uniform_rays_) : 1.0;
    set.certified = certified;
    return set;
  }

  const Scene& scene_;
  const Raytracer& raytracer_;
  const Box& region_;
  DirectionCap cap_;
  const WorkBudget& budget_;
  Rng rng_;
  std::uint64_t rays_left_;
  std::uint64_t uniform_rays_ = 0;
  // A uniform ray's find is confirmed by other uniform rays and by aimed ones, but not by the exploration that it started itself.
  std::vector<std::uint32_t> uniform_hits_;
  std::vector<bool> confirmed_;  // met by an aimed ray, first found by exploring, or no ray is needed
};

/// Distance at which the ray enters the box; infinity where it misses it.
double entry_distance(const Box& box, const Vec3& origin, const Vec3& direction) {
  double enter = 0.0;
  double leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (origin[axis] < box.min[axis] || origin[axis] > box.max[axis]) return std::numeric_limits<double>::infinity();
      continue;
    }
    const double a = (box.min[axis] - origin[axis]) / direction[axis];
    const double b = (box.max[axis] - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

constexpr int kProbeRegions = 16;
constexpr int kProbeObjects = 256;
constexpr int kProbeRays = 16;

// Hidden: each of a few rays from the region to the object's box is stopped before it gets there.
bool seems_hidden(const Scene& scene, const Raytracer& raytracer, const Box& region, std::uint32_t object, Rng& rng) {
  const Box& bounds = scene.objects[object].bounds;
  if (meet(region, bounds)) return false;
  for (int i = 0; i < kProbeRays; ++i) {
    const Vec3 position = random_point(rng, region);
    const Vec3 direction = glm::normalize(random_point(rng, bounds) - position);
    const auto hit = raytracer.nearest(position, direction);
    if (!hit || hit->object == object || hit->distance_m >= entry_distance(bounds, position, direction)) return false;
  }
  return true;
}

}  // namespace

std::vector<VisibleSet> sample_visible_sets(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions,
                                            const VisibilityOptions& options, int threads, const WorkBudget& budget) {
  std::vector<VisibleSet> sets(regions.size());
  if (scene.objects.empty()) return sets;
  std::atomic<std::size_t> done{0};
  parallel_for(regions.size(), threads, budget, [&](std::size_t i) {
    sets[i] = RegionSampler(scene, raytracer, regions[i], options, i, budget).sample();
    budget.report("visibility", static_cast<double>(++done) / static_cast<double>(regions.size()));
  });
  return sets;
}

double probe_occlusion(const Scene& scene, const Raytracer& raytracer, const std::vector<Box>& regions, std::uint64_t seed) {
  if (regions.empty() || scene.objects.empty()) return 0.0;
  Rng rng(seed);
  double hidden = 0.0;
  double probed = 0.0;
  for (int r = 0; r < kProbeRegions; ++r) {
    const Box& region = regions[rng.below(regions.size())];
    for (int k = 0; k < kProbeObjects; ++k) {
      const auto object = static_cast<std::uint32_t>(rng.below(scene.objects.size()));
      const auto triangles = static_cast<double>(scene.objects[object].triangle_count);
      probed += triangles;
      if (seems_hidden(scene, raytracer, region, object, rng)) hidden += triangles;
    }
  }
  return probed > 0.0 ? hidden / probed : 0.0;
}

}  // namespace standin
