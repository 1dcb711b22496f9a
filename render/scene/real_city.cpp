#include "render/scene/real_city.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <string>

#include "render/base/error.h"
#include "render/base/rng.h"
#include "render/scene/city_textures.h"
#include "render/scene/real_city_layout.h"
#include "render/scene/street_models.h"

namespace standin {
namespace {

constexpr double kTile_m = 50.0;

// Which of a kind's models stands where: whole rounds in which each has its weight's share, shuffled, so that any start of the list holds
// about the shares that were asked for.
class Deck {
 public:
  Deck(const std::vector<StreetModel>& models, StreetModelKind kind, std::size_t count, Rng& rng) {
    std::vector<std::size_t> round;
    for (std::size_t m = 0; m < models.size(); ++m) {
      if (models[m].name.kind == kind) round.insert(round.end(), static_cast<std::size_t>(std::lround(2.0 * models[m].name.weight)), m);
    }
    while (cards_.size() < count) {
      for (std::size_t i = round.size(); i > 1; --i) std::swap(round[i - 1], round[rng.below(i)]);
      cards_.insert(cards_.end(), round.begin(), round.end());
    }
    cards_.resize(count);
    sums_.push_back(0);
    for (const std::size_t card : cards_) sums_.push_back(sums_.back() + models[card].triangles);
  }

  [[nodiscard]] std::size_t size() const { return cards_.size(); }
  [[nodiscard]] std::size_t operator[](std::size_t i) const { return cards_[i]; }
  /// Triangles of the first `count`.
  [[nodiscard]] std::uint64_t triangles(std::size_t count) const { return sums_[count]; }

 private:
  std::vector<std::size_t> cards_;
  std::vector<std::uint64_t> sums_;
};

struct Mix {
  std::size_t trees = 0;
  std::size_t cars = 0;
  std::size_t small = 0;
};

// The fewest trees with which `objects` draw `triangles`: two cars to a tree while there is room, small things for the rest.
Mix mix_of(std::size_t objects, std::uint64_t triangles, const Deck& trees, const Deck& cars, const Deck& small) {
  Mix mix;
  for (std::size_t t = 0; t <= std::min(trees.size(), objects); ++t) {
    mix.trees = t;
    mix.cars = std::min({2 * t, cars.size(), objects - t});
    mix.small = std::min(small.size(), objects - t - mix.cars);
    mix.cars = std::min(cars.size(), objects - t - mix.small);  // where small things have no room left
    if (trees.triangles(t) + cars.triangles(mix.cars) + small.triangles(mix.small) < triangles) continue;
    if (t + mix.cars + mix.small == objects) break;
  }
  return mix;
}

class RealCity {
 public:
  explicit RealCity(const RealCityOptions& options) : options_(options), map_(read_street_map(options.osm)), ground_(lay_ground(map_)) {
    scene_.name = "city";
    add_city_materials(scene_, options.seed);
  }

  Scene run() {
    const std::vector<StreetModel> models = add_street_models(scene_, options_.furniture);
    add_ground();
    add_buildings();
    if (scene_.objects.size() > options_.objects) {
      throw Failure(ErrorWord::kBadUsage, "a city of " + std::to_string(options_.objects) +
                                              " objects: its ground and buildings alone are " + std::to_string(scene_.objects.size()));
    }
    place_models(models);
    update_derived(scene_);
    return std::move(scene_);
  }

 private:
  // From the plan, whose origin is its north-western corner, to the world, whose origin is its middle.
  [[nodiscard]] Vec3 world(const Vec2& place, double height_m = 0.0) const {
    const Vec2 p = place - map_.bounds.centre();
    return {p.x, height_m, p.y};
  }

  void add_own(const std::string& name, Model model, const Vec2& place, std::uint32_t colour) {
    const auto first = static_cast<std::uint32_t>(scene_.parts.size());
    for (ModelPart& part : model.parts) {
      own_triangles_ += part.mesh.triangle_count();
      part.mesh.name = name + "_" + part.mesh.name;
      scene_.parts.push_back({static_cast<std::uint32_t>(scene_.meshes.size()), city_material(part.surface, colour)});
      scene_.meshes.push_back(std::move(part.mesh));
    }
    const auto count = static_cast<std::uint32_t>(model.parts.size());
    if (count > 0) add_object(name, glm::translate(Mat4(1.0), world(place)), first, count);
  }

  void add_object(const std::string& name, const Mat4& world_from_object, std::uint32_t first_part, std::uint32_t part_count) {
    Object object;
    object.name = name;
    object.gltf_node = name;
    object.world_from_object = world_from_object;
    object.first_part = first_part;
    object.part_count = part_count;
    scene_.objects.push_back(std::move(object));
  }

  void add_ground() {
    const Vec2 size = map_.bounds.size();
    for (int j = 0; j * kTile_m < size.y; ++j) {
      const double y = j * kTile_m;
      const Ground row = ground_.within({{0.0, y}, {size.x, std::min(y + kTile_m, size.y)}});  // cutting the whole each time is slow
      for (int i = 0; i * kTile_m < size.x; ++i) {
        const PlanBox box{{i * kTile_m, y}, glm::min(Vec2(i * kTile_m, y) + kTile_m, size)};
        add_own("ground_" + std::to_string(scene_.objects.size()), ground_tile(row, box), box.centre(), 0);
      }
    }
  }

  void add_buildings() {
    Rng rng(options_.seed, 901);
    for (std::size_t b = 0; b < map_.buildings.size(); ++b) {
      const MapBuilding& building = map_.buildings[b];
      const Vec2 origin = building.bounds.centre();
      add_own("building_" + std::to_string(b), extruded_building(building.footprint, building.floors, origin), origin,
              static_cast<std::uint32_t>(rng.below(kFacadeColours)));
    }
  }

  void place_models(const std::vector<StreetModel>& models) {
    const Spots spots = find_spots(map_, ground_, options_.seed);
    Rng rng(options_.seed, 902);
    const Deck trees(models, StreetModelKind::kTree, spots.trees.size(), rng);
    const Deck cars(models, StreetModelKind::kCar, spots.cars.size(), rng);
    const Deck small(models, StreetModelKind::kSmall, spots.small.size(), rng);
    const std::uint64_t wanted = options_.triangles > own_triangles_ ? options_.triangles - own_triangles_ : 0;
    const Mix mix = mix_of(options_.objects - scene_.objects.size(), wanted, trees, cars, small);
    add_kind("tree", models, trees, spots.trees, mix.trees, kPavementHeight_m);
    add_kind("car", models, cars, spots.cars, mix.cars, 0.0);
    add_kind("small", models, small, spots.small, mix.small, kPavementHeight_m);
  }

  void add_kind(const std::string& kind, const std::vector<StreetModel>& models, const Deck& deck, const std::vector<Spot>& spots,
                std::size_t count, double height_m) {
    for (std::size_t i = 0; i < count; ++i) {
      const StreetModel& model = models[deck[i]];
      Mat4 place = glm::translate(Mat4(1.0), world(spots[i].place, height_m));
      place = glm::rotate(place, spots[i].yaw_rad, Vec3(0.0, 1.0, 0.0));
      place = glm::scale(place, Vec3(spots[i].scale));
      add_object(kind + "_" + std::to_string(i), place, model.first_part, model.part_count);
    }
  }

  const RealCityOptions& options_;
  StreetMap map_;
  Ground ground_;
  Scene scene_;
  std::uint64_t own_triangles_ = 0;
};

}  // namespace

Scene make_real_city(const RealCityOptions& options) {
  return RealCity(options).run();
}

}  // namespace standin
