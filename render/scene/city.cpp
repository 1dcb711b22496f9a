#include "render/scene/city.h"

#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <span>
#include <string>

#include "render/base/error.h"
#include "render/scene/city_layout.h"

namespace standin {
namespace {

// Shares of the drawn triangles; trees get what is left (43 %).
constexpr double kBuildingShare = 2.46 / 10.4;
constexpr double kCarShare = 1.93 / 10.4;
constexpr double kTileShare = 0.01;
constexpr double kFurnitureShare = 1.58 / 10.4 - kTileShare;

constexpr std::array<double, kFurnitureKinds> kFurnitureWeights{1.0, 0.5, 1.1, 0.8, 0.9, 2.2};
constexpr std::array<double, 6> kTreeWeights{0.55, 0.75, 0.9, 1.1, 1.3, 1.55};
constexpr std::array<double, 3> kCarWeights{1.0, 0.8, 1.2};
constexpr std::array<double, 2> kTileWeights{1.0, 1.0};

std::vector<double> building_weights() {
  std::vector<double> weights;
  for (const BuildingShape& shape : kBuildingShapes) weights.push_back(shape.width_m * shape.floors);
  return weights;
}

using Maker = std::function<Model(std::uint32_t variant, std::uint64_t triangles)>;

// Turns the places of one kind into objects that share their variants' meshes.
class CityBuilder {
 public:
  explicit CityBuilder(Scene& scene) : scene_(scene) {}

  [[nodiscard]] std::uint64_t triangles() const { return triangles_; }

  // Divides `triangles` over the places in proportion to their variants' weights.
  void add(const std::string& kind, std::span<const Place> places, std::span<const double> weights, double triangles, const Maker& make) {
    double sum = 0.0;
    for (const Place& place : places) sum += weights[place.model];
    std::vector<Variant> variants(weights.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      Variant& variant = variants[places[i].model];
      if (variant.surfaces.empty()) {
        const auto budget = static_cast<std::uint64_t>(std::lround(triangles * weights[places[i].model] / sum));
        add_variant(variant, kind + "_model_" + std::to_string(places[i].model), make(places[i].model, budget));
      }
      add_object(kind + "_" + std::to_string(i), places[i], variant);
    }
  }

 private:
  struct Variant {
    std::uint32_t first_mesh = 0;
    std::vector<Surface> surfaces;  // of the meshes from `first_mesh` on
    std::uint64_t triangles = 0;
  };

  void add_variant(Variant& variant, const std::string& name, Model model) {
    variant.first_mesh = static_cast<std::uint32_t>(scene_.meshes.size());
    variant.triangles = model.triangle_count();
    for (ModelPart& part : model.parts) {
      part.mesh.name = name + "_" + part.mesh.name;
      variant.surfaces.push_back(part.surface);
      scene_.meshes.push_back(std::move(part.mesh));
    }
  }

  void add_object(const std::string& name, const Place& place, const Variant& variant) {
    Object object;
    object.name = name;
    object.gltf_node = name;
    object.world_from_object = glm::translate(Mat4(1.0), place.position);
    object.world_from_object = glm::rotate(object.world_from_object, place.yaw_rad, Vec3(0.0, 1.0, 0.0));
    object.world_from_object = glm::scale(object.world_from_object, place.scale);
    object.first_part = static_cast<std::uint32_t>(scene_.parts.size());
    object.part_count = static_cast<std::uint32_t>(variant.surfaces.size());
    for (std::uint32_t p = 0; p < object.part_count; ++p) {
      scene_.parts.push_back({variant.first_mesh + p, city_material(variant.surfaces[p], place.colour)});
    }
    triangles_ += variant.triangles;
    scene_.objects.push_back(std::move(object));
  }

  Scene& scene_;
  std::uint64_t triangles_ = 0;
};

void check(const CityOptions& options) {
  if (options.objects < 16)
    throw Failure(ErrorWord::kBadUsage, "a city of " + std::to_string(options.objects) + " objects: needs at least 16");
  if (options.triangles < std::uint64_t{200} * options.objects) {
    throw Failure(ErrorWord::kBadUsage, "a city of " + std::to_string(options.triangles) + " triangles in " +
                                            std::to_string(options.objects) + " objects: needs at least 200 triangles per object");
  }
}

}  // namespace

Scene make_city(const CityOptions& options) {
  check(options);
  const auto total = static_cast<double>(options.triangles);
  const CityLayout layout = lay_out_city(city_counts(options.objects), options.seed);
  TileShape lawn = layout.tile;
  lawn.lawn = true;
  Scene scene;
  scene.name = "city";
  add_city_materials(scene, options.seed);
  CityBuilder builder(scene);
  builder.add("ground", layout.tiles, kTileWeights, total * kTileShare,
              [&](std::uint32_t variant, std::uint64_t n) { return make_tile(variant == 1 ? lawn : layout.tile, n); });
  builder.add("building", layout.buildings, building_weights(), total * kBuildingShare,
              [](std::uint32_t variant, std::uint64_t n) { return make_building(kBuildingShapes[variant], n); });
  builder.add("car", layout.cars, kCarWeights, total * kCarShare,
              [](std::uint32_t variant, std::uint64_t n) { return make_car(kCarShapes[variant], n); });
  builder.add("furniture", layout.furniture, kFurnitureWeights, total * kFurnitureShare,
              [](std::uint32_t variant, std::uint64_t n) { return make_furniture(static_cast<FurnitureKind>(variant), n); });
  builder.add("tree", layout.trees, kTreeWeights, total - static_cast<double>(builder.triangles()),
              [&](std::uint32_t variant, std::uint64_t n) {
                return make_tree(kTreeShapes[variant], n, options.seed * kTreeShapes.size() + variant);
              });
  update_derived(scene);
  return scene;
}

}  // namespace standin
