#include "render/scene/real_city_layout.h"

#include <cmath>
#include <map>
#include <numbers>

#include "render/base/rng.h"

namespace standin {
namespace {

constexpr double kPavement_m = 3.0;
constexpr double kHouseStrip_m = 1.5;
constexpr double kTreeClearance_m = 3.5;  // of walls
constexpr double kTreeStep_m = 9.0;
constexpr double kCarStep_m = 6.5;
constexpr double kSmallStep_m = 8.0;
constexpr double kParkTree_m2 = 120.0;  // of green for each tree

template <typename T>
void shuffle(std::vector<T>& items, Rng& rng) {
  for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[rng.below(i)]);
}

double distance_to(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 ab = b - a;
  const double length2 = glm::dot(ab, ab);
  const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, ab) / length2, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + t * ab);
}

// Whether something already stands nearer than `apart_m`; a grid of cells of that size.
class Spacing {
 public:
  explicit Spacing(double apart_m) : apart_m_(apart_m) {}

  [[nodiscard]] bool take(const Vec2& p) {
    const auto cell = [&](double v) { return static_cast<std::int64_t>(std::floor(v / apart_m_)); };
    for (std::int64_t y = cell(p.y) - 1; y <= cell(p.y) + 1; ++y) {
      for (std::int64_t x = cell(p.x) - 1; x <= cell(p.x) + 1; ++x) {
        const auto found = cells_.find({x, y});
        if (found == cells_.end()) continue;
        for (const Vec2& other : found->second) {
          if (glm::distance(p, other) < apart_m_) return false;
        }
      }
    }
    cells_[{cell(p.x), cell(p.y)}].push_back(p);
    return true;
  }

 private:
  double apart_m_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<Vec2>> cells_;
};

// Calls use(place, direction) every `step_m` along the line, from half a step on.
template <typename Use>
void along(const Path& line, double step_m, const Use& use) {
  double next_m = 0.5 * step_m;
  double walked_m = 0.0;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const double length_m = glm::distance(line[i], line[i + 1]);
    for (; length_m > 0.0 && next_m <= walked_m + length_m; next_m += step_m) {
      const Vec2 direction = (line[i + 1] - line[i]) / length_m;
      use(line[i] + (next_m - walked_m) * direction, direction);
    }
    walked_m += length_m;
  }
}

double yaw_of(const Vec2& direction) {
  return std::atan2(direction.x, direction.y);
}

class SpotFinder {
 public:
  SpotFinder(const StreetMap& map, const Ground& ground, std::uint64_t seed) : map_(map), ground_(ground), rng_(seed, 900) {
    std::vector<Region> houses;
    for (const MapBuilding& building : map.buildings) houses.push_back(building.footprint.grown(0.0));
    const Region all = Region::united(houses);
    near_houses_ = all.grown(0.8);
    under_crowns_ = all.grown(kTreeClearance_m);
    edge_ = ground.asphalt.grown(0.5);
  }

  Spots run() {
    for (std::size_t s = 0; s < map_.streets.size(); ++s) add_along(s);
    for (const Region& green : map_.greens) add_in(green);
    shuffle(spots_.trees, rng_);
    shuffle(spots_.cars, rng_);
    shuffle(spots_.small, rng_);
    return std::move(spots_);
  }

 private:
  [[nodiscard]] bool inside(const Vec2& p, double margin_m) const {
    return p.x >= margin_m && p.y >= margin_m && p.x <= map_.bounds.max.x - margin_m && p.y <= map_.bounds.max.y - margin_m;
  }

  void add_along(std::size_t index) {
    const MapStreet& street = map_.streets[index];
    const double edge_m = 0.5 * street.width_m;
    for (const double side : {-1.0, 1.0}) {
      const auto beside = [&](const Vec2& p, const Vec2& d, double out_m) { return p + side * out_m * Vec2(-d.y, d.x); };
      along(street.line, kTreeStep_m,
            [&](const Vec2& p, const Vec2& d) { offer_tree(beside(p, d, edge_m + 2.0 + rng_.uniform(-0.3, 0.3))); });
      along(street.line, kSmallStep_m,
            [&](const Vec2& p, const Vec2& d) { offer_small(beside(p, d, edge_m + 0.8), -side * Vec2(-d.y, d.x)); });
      if (!street.vehicles || street.width_m < 6.0) continue;
      along(street.line, kCarStep_m, [&](const Vec2& p, const Vec2& d) { offer_car(beside(p, d, edge_m - 1.25), side * d, index); });
    }
  }

  void add_in(const Region& green) {
    const Region part = green.within(map_.bounds);
    PlanBox box;
    for (const Polygon& polygon : part.polygons()) box.extend(polygon.shell);
    if (part.area_m2() < kParkTree_m2) return;
    const auto tries = static_cast<std::uint64_t>(std::ceil(box.size().x * box.size().y / kParkTree_m2));
    for (std::uint64_t i = 0; i < tries; ++i) {
      const Vec2 p(rng_.uniform(box.min.x, box.max.x), rng_.uniform(box.min.y, box.max.y));
      if (part.contains(p)) offer_tree(p);
    }
  }

  void offer_tree(const Vec2& p) {
    if (!inside(p, 4.0) || edge_.contains(p) || under_crowns_.contains(p) || ground_.water.contains(p) || !trees_.take(p)) return;
    spots_.trees.push_back({p, rng_.uniform(0.0, 2.0 * std::numbers::pi), rng_.uniform(0.8, 1.2)});
  }

  void offer_small(const Vec2& p, const Vec2& facing) {
    if (!inside(p, 1.0) || edge_.contains(p) || near_houses_.contains(p) || ground_.water.contains(p) || !small_.take(p)) return;
    spots_.small.push_back({p, yaw_of(facing), 1.0});
  }

  void offer_car(const Vec2& p, const Vec2& direction, std::size_t street) {
    if (!inside(p, 3.0) || !ground_.asphalt.contains(p) || near_houses_.contains(p) || on_another_street(p, street) || !cars_.take(p))
      return;
    spots_.cars.push_back({p, yaw_of(direction) + rng_.uniform(-0.03, 0.03), 1.0});
  }

  // Nobody parks in a junction.
  [[nodiscard]] bool on_another_street(const Vec2& p, std::size_t street) const {
    for (std::size_t s = 0; s < map_.streets.size(); ++s) {
      const MapStreet& other = map_.streets[s];
      if (s == street) continue;
      for (std::size_t i = 0; i + 1 < other.line.size(); ++i) {
        if (distance_to(p, other.line[i], other.line[i + 1]) < 0.5 * other.width_m + 2.5) return true;
      }
    }
    return false;
  }

  const StreetMap& map_;
  const Ground& ground_;
  Rng rng_;
  Region near_houses_;
  Region under_crowns_;
  Region edge_;
  Spacing trees_{5.0};
  Spacing cars_{6.0};
  Spacing small_{5.0};
  Spots spots_;
};

Region streets_of(const StreetMap& map, bool vehicles, double more_m) {
  std::vector<Region> strips;
  for (const MapStreet& street : map.streets) {
    if (street.vehicles == vehicles) strips.push_back(Region::around(street.line, 0.5 * street.width_m + more_m));
  }
  return Region::united(strips).within(map.bounds);
}

Region united_within(const std::vector<Region>& regions, const PlanBox& bounds) {
  return Region::united(regions).within(bounds);
}

}  // namespace

Ground lay_ground(const StreetMap& map) {
  const PlanBox& box = map.bounds;
  Ground ground;
  ground.asphalt = streets_of(map, true, 0.0);
  std::vector<Region> paved;
  paved.push_back(streets_of(map, true, kPavement_m));
  paved.push_back(streets_of(map, false, 0.0));
  for (const MapBuilding& building : map.buildings) paved.push_back(building.footprint.grown(kHouseStrip_m));
  ground.paving = united_within(paved, box).minus(ground.asphalt);
  ground.water = united_within(map.waters, box).minus(ground.asphalt).minus(ground.paving);
  const Region all = Region::of({{box.min, {box.max.x, box.min.y}, box.max, {box.min.x, box.max.y}}, {}});
  ground.grass = all.minus(ground.asphalt).minus(ground.paving).minus(ground.water);
  return ground;
}

Spots find_spots(const StreetMap& map, const Ground& ground, std::uint64_t seed) {
  return SpotFinder(map, ground, seed).run();
}

}  // namespace standin
