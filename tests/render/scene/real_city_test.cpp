#include "render/scene/real_city.h"

#include <gtest/gtest.h>

#include <set>

#include "render/scene/file_access.h"
#include "render/scene/real_city_layout.h"
#include "render/scene/street_models.h"
#include "tests/render/scene/temporary_folder.h"
#include "tests/render/scene/tile_maker.h"

namespace standin {
namespace {

using test::rectangle;
using test::reversed;
using test::TemporaryFolder;
using test::TileMaker;

constexpr double kHalf = 0.5;
constexpr std::uint64_t kHeavy = 10;  // a tree of these tests over a car

template <typename Use>
void each_triangle(const Mesh& mesh, const Use& use) {
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    use(Vec3(mesh.positions[mesh.indices[i]]), Vec3(mesh.positions[mesh.indices[i + 1]]), Vec3(mesh.positions[mesh.indices[i + 2]]));
}

const ModelPart* part_of(const Model& model, const std::string& name) {
  for (const ModelPart& part : model.parts) {
    if (part.mesh.name == name) return &part;
  }
  return nullptr;
}

// By the divergence theorem; the open foot lies in the plane through the origin and adds nothing.
double volume_of(const Model& model, const std::set<std::string>& parts) {
  double six = 0.0;
  for (const ModelPart& part : model.parts) {
    if (parts.contains(part.mesh.name))
      each_triangle(part.mesh, [&](const Vec3& a, const Vec3& b, const Vec3& c) { six += glm::dot(a, glm::cross(b, c)); });
  }
  return six / 6.0;
}

Polygon yard_house(bool turned) {
  Polygon polygon{{{0, 0}, {30, 0}, {30, 20}, {0, 20}}, {{{10, 5}, {20, 5}, {20, 15}, {10, 15}}}};
  if (turned) {
    std::reverse(polygon.shell.begin(), polygon.shell.end());
    std::reverse(polygon.holes[0].begin(), polygon.holes[0].end());
  }
  return polygon;
}

TEST(ExtrudedBuilding, EnclosesItsFootprintTimesItsHeight) {
  for (const bool turned : {false, true}) {
    const Model model = extruded_building(Region::of(yard_house(turned)), 5.0, {15, 10});
    EXPECT_NEAR(volume_of(model, {"walls", "flat_roof"}), (600.0 - 100.0) * 5.0 * kFloorHeight_m, 0.01)
        << "a wall or the roof faces inwards, or is missing";
    EXPECT_GT(volume_of(model, {"balconies"}), 0.0) << "balconies face inwards";
  }
}

TEST(ExtrudedBuilding, NormalsAgreeWithTheWinding) {
  const Model model = extruded_building(Region::of(yard_house(false)), 4.0, {15, 10});
  ASSERT_NE(part_of(model, "parapet"), nullptr);
  for (const ModelPart& part : model.parts) {
    const Mesh& mesh = part.mesh;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const Vec3 a = mesh.positions[mesh.indices[i]];
      const Vec3 n = glm::cross(Vec3(mesh.positions[mesh.indices[i + 1]]) - a, Vec3(mesh.positions[mesh.indices[i + 2]]) - a);
      EXPECT_GT(glm::dot(n, Vec3(mesh.normals[mesh.indices[i]])), 0.0) << mesh.name;
    }
  }
}

TEST(ExtrudedBuilding, SmallQuadrilateralsHaveGables) {
  const auto house = [](double width, double floors, const Vec2& corner) {
    return extruded_building(Region::of({{{0, 0}, {width, 0}, corner, {0, 10}}, {}}), floors, {0, 0});
  };
  const Model gabled = house(14, 1, {14, 10});
  ASSERT_NE(part_of(gabled, "roof"), nullptr);
  EXPECT_EQ(part_of(gabled, "flat_roof"), nullptr);
  const double rise_m = 0.55 * 5.0;
  EXPECT_NEAR(volume_of(gabled, {"walls", "roof", "parapet"}), 140.0 * (kFloorHeight_m + kHalf * rise_m), 0.01);
  EXPECT_EQ(part_of(house(14, 4, {14, 10}), "roof"), nullptr) << "four floors";
  EXPECT_EQ(part_of(house(14, 1, {3, 2}), "roof"), nullptr) << "not convex";
  EXPECT_EQ(part_of(extruded_building(Region::of({{{0, 0}, {50, 0}, {50, 40}, {0, 40}}, {}}), 1, {0, 0}), "roof"), nullptr) << "a hall";
}

/// A crossing, a path, a block with a yard, a small house, a pond and a lawn.
TileMaker town() {
  TileMaker tile(2446);
  tile.polygon({{"building", "apartments"}, {"building:levels", "9"}},
               {rectangle(100, 100, 200, 180), reversed(rectangle(120, 120, 180, 160))});
  tile.polygon({{"building", "house"}}, {rectangle(300, 100, 312, 110)});
  tile.line({{"highway", "residential"}}, {{0, 220}, {1400, 220}});
  tile.line({{"highway", "tertiary"}}, {{250, 0}, {250, 900}});
  tile.line({{"highway", "footway"}}, {{0, 300}, {400, 340}, {800, 300}});
  tile.polygon({{"natural", "water"}}, {rectangle(600, 500, 700, 600)});
  tile.polygon({{"leisure", "park"}}, {rectangle(300, 400, 900, 900)});
  return tile;
}

StreetMap town_map() {
  const TemporaryFolder folder;
  folder.write("14-8192-8191.mvt", town().bytes());
  return read_street_map(folder.path());
}

TEST(Ground, CoversTheMapOnce) {
  const StreetMap map = town_map();
  const Ground ground = lay_ground(map);
  const double whole = map.bounds.size().x * map.bounds.size().y;
  EXPECT_NEAR(ground.asphalt.area_m2() + ground.paving.area_m2() + ground.grass.area_m2() + ground.water.area_m2(), whole, 1.0);
  for (const Region* area : {&ground.asphalt, &ground.paving, &ground.grass, &ground.water}) EXPECT_GT(area->area_m2(), 1000.0);
  const std::array<const Region*, 4> areas{&ground.asphalt, &ground.paving, &ground.grass, &ground.water};
  for (std::size_t a = 0; a < areas.size(); ++a) {
    for (std::size_t b = a + 1; b < areas.size(); ++b) EXPECT_LT(areas[a]->common(*areas[b]).area_m2(), 0.5) << a << " and " << b;
  }
}

TEST(Ground, TilesAreLevelAndTheirKerbsFaceTheCarriageway) {
  const StreetMap map = town_map();
  const Ground ground = lay_ground(map);
  double level_m2 = 0.0;
  std::size_t kerbs = 0;
  for (double x = 0.0; x < 400.0; x += 100.0) {
    const PlanBox box{{x, 200.0}, {x + 100.0, 300.0}};
    for (const ModelPart& part : ground_tile(ground, box).parts) {
      each_triangle(part.mesh, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
        const Vec3 normal = glm::cross(b - a, c - a);
        EXPECT_GE(normal.y, -1e-9) << "faces down";
        level_m2 += 0.5 * normal.y;
        if (std::abs(normal.y) > 1e-6) return;
        ++kerbs;
        const Vec3 before = (a + b + c) / 3.0 + 0.02 * glm::normalize(normal);
        const Vec2 place = box.centre() + Vec2(before.x, before.z);
        EXPECT_TRUE(ground.asphalt.contains(place)) << part.mesh.name << " at " << place.x << ", " << place.y;
      });
    }
  }
  EXPECT_NEAR(level_m2, 4 * 100.0 * 100.0, 1.0);
  EXPECT_GT(kerbs, 10U);
}

TEST(StreetSpots, KeepClearOfHousesAndCarriageways) {
  const StreetMap map = town_map();
  const Ground ground = lay_ground(map);
  const Spots spots = find_spots(map, ground, 1);
  EXPECT_GT(spots.trees.size(), 100U);
  EXPECT_GT(spots.cars.size(), 50U);
  EXPECT_GT(spots.small.size(), 100U);
  for (const Spot& tree : spots.trees) {
    EXPECT_FALSE(ground.asphalt.contains(tree.place) || ground.water.contains(tree.place));
    for (const MapBuilding& building : map.buildings) EXPECT_FALSE(building.footprint.grown(3.0).contains(tree.place));
  }
  for (const Spot& car : spots.cars) EXPECT_TRUE(ground.asphalt.contains(car.place));
  for (std::size_t i = 0; i < spots.cars.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) EXPECT_GE(glm::distance(spots.cars[i].place, spots.cars[k].place), 6.0);
  }
}

/// Catalogues of boxes in units and at places of their own: "model#K" is 4.0 x 1.5 x (K + 1) m, wide, high and deep.
void write_furniture(const TemporaryFolder& folder, const std::string& without = "", const std::string& depth = "") {
  std::string properties = "# made up\nid=Test\n";
  for (std::size_t m = 0; m < kStreetModels.size(); ++m) {
    const std::string path(kStreetModels[m].path);
    if (path == without) continue;
    const std::string n = "#" + std::to_string(m) + "=";
    properties += "model" + n + path + "\r\nwidth" + n + "400\nheight" + n + "150.0\ndepth" + n +
                  (depth.empty() ? std::to_string(100 * (m + 1)) : depth) + "\n";
    const bool heavy = kStreetModels[m].kind == StreetModelKind::kTree;
    std::string faces;
    for (std::uint64_t i = 0; i < (heavy ? kHeavy : 1); ++i)
      faces += "g foot\nf 1 2 3 4\nf 1 2 6 5\nf 2 3 7 6\ng top\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\n";
    folder.write("furniture/all" + path, "v 5 7 9\nv 7 7 9\nv 7 7 12\nv 5 7 12\nv 5 8 9\nv 7 8 9\nv 7 8 12\nv 5 8 12\n" + faces);
  }
  folder.write("furniture/all/PluginFurnitureCatalog.properties", properties);
}

RealCityOptions town_options(const TemporaryFolder& folder) {
  folder.write("osm/14-8192-8191.mvt", town().bytes());
  return {folder.path() / "osm", folder.path() / "furniture", 900, 5000, 1};
}

TEST(StreetModels, HaveTheCataloguesSizeAndStandOnTheirFoot) {
  const TemporaryFolder folder;
  write_furniture(folder);
  Scene scene;
  const auto models = add_street_models(scene, folder.path() / "furniture");
  ASSERT_EQ(models.size(), kStreetModels.size());
  for (std::size_t m = 0; m < models.size(); ++m) {
    EXPECT_EQ(models[m].triangles, models[m].name.kind == StreetModelKind::kTree ? 12 * kHeavy : 12);
    ASSERT_EQ(models[m].part_count, 1U) << "one material, one draw call";
    Box box;
    for (const glm::vec3& p : scene.meshes[scene.parts[models[m].first_part].mesh].positions) box.extend(Vec3(p));
    const double depth_m = static_cast<double>(m + 1);
    EXPECT_LT(glm::length(box.min - Vec3(-2.0, 0.0, -0.5 * depth_m)), 1e-5) << models[m].name.path;
    EXPECT_LT(glm::length(box.max - Vec3(2.0, 1.5, 0.5 * depth_m)), 1e-5) << models[m].name.path;
  }
}

TEST(RealCity, IsWhatWasAskedAndInstanced) {
  const TemporaryFolder folder;
  write_furniture(folder);
  RealCityOptions options = town_options(folder);
  options.triangles = 0;
  const std::uint64_t least = make_real_city(options).triangle_count();
  constexpr std::uint64_t kTrees = 20;
  constexpr std::uint64_t kMore = 12 * (kHeavy - 1);  // a tree in the place of a lamp
  options.triangles = least + kTrees * kMore;
  const Scene city = make_real_city(options);
  EXPECT_EQ(city.objects.size(), options.objects);
  EXPECT_EQ(city.triangle_count(), options.triangles);
  std::map<std::string, std::size_t> kinds;
  std::set<std::uint32_t> shared;
  std::set<std::string> names;
  for (const Object& object : city.objects) {
    const std::string kind = object.name.substr(0, object.name.find('_'));
    ++kinds[kind];
    names.insert(object.name);
    if (kind == "ground" || kind == "building") continue;
    shared.insert(object.first_part);
    EXPECT_NEAR(object.bounds.min.y, kind == "car" ? 0.0 : kPavementHeight_m, 1e-5) << object.name;
  }
  EXPECT_EQ(names.size(), city.objects.size());
  EXPECT_EQ(kinds["building"], 2U);
  EXPECT_EQ(kinds["ground"], 600U);
  EXPECT_EQ(kinds["tree"], kTrees);
  EXPECT_EQ(kinds["car"], 2 * kTrees);
  EXPECT_EQ(kinds.size(), 5U);
  EXPECT_LE(shared.size(), kStreetModels.size());
  EXPECT_NEAR(city.bounds.size().x, kMapSize_m.x, 6.0);
  EXPECT_NEAR(city.bounds.size().z, kMapSize_m.y, 6.0);
}

TEST(RealCity, SameSeedSameBytesOtherSeedOtherCity) {
  const TemporaryFolder folder;
  write_furniture(folder);
  RealCityOptions options = town_options(folder);
  const auto bytes = [&](const char* name) {
    write_scene_glb(make_real_city(options), folder.path() / name);
    return read_bytes(folder.path() / name);
  };
  const auto first = bytes("a.glb");
  EXPECT_EQ(first, bytes("b.glb"));
  options.seed = 2;
  EXPECT_NE(first, bytes("c.glb"));
}

// A larger budget is met by heavier things in the place of lighter ones; one that does not fit is filled as far as there is room.
TEST(RealCity, TakesAsManyAsHaveRoom) {
  const TemporaryFolder folder;
  write_furniture(folder);
  RealCityOptions options = town_options(folder);
  options.objects = 100'000;
  options.triangles = 100'000'000;
  const Scene city = make_real_city(options);
  EXPECT_LT(city.objects.size(), 100'000U);
  EXPECT_GT(city.objects.size(), 900U);
}

struct Refused {
  ErrorWord word;
  std::string sentence;
};

Refused refusal(const RealCityOptions& options) {
  try {
    (void)make_real_city(options);
  } catch (const Failure& failure) {
    return {failure.word(), failure.what()};
  }
  return {ErrorWord::kInternal, "made a city"};
}

TEST(RealCity, RefusesWhatIsMissingOrTooLittle) {
  const TemporaryFolder folder;
  const RealCityOptions options = town_options(folder);
  EXPECT_EQ(refusal(options).word, ErrorWord::kFileMissing) << "no folder";
  std::filesystem::create_directories(options.furniture);
  EXPECT_EQ(refusal(options).word, ErrorWord::kFileMissing);
  EXPECT_NE(refusal(options).sentence.find("PluginFurnitureCatalog.properties"), std::string::npos);
  write_furniture(folder, "/scopia/van/van.obj");
  EXPECT_EQ(refusal(options).word, ErrorWord::kFileMissing);
  EXPECT_NE(refusal(options).sentence.find("/scopia/van/van.obj"), std::string::npos);
  write_furniture(folder, "", "wide");
  EXPECT_EQ(refusal(options).word, ErrorWord::kFileBroken);
  EXPECT_NE(refusal(options).sentence.find("=wide is not a length"), std::string::npos);
  write_furniture(folder);
  RealCityOptions few = options;
  few.objects = 20;
  EXPECT_EQ(refusal(few).word, ErrorWord::kBadUsage);
}

}  // namespace
}  // namespace standin
