#include "render/scene/city.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "render/base/error.h"
#include "tests/render/scene/city_table.h"

namespace standin {
namespace {

std::string kind_of(const Object& object) {
  return object.name.substr(0, object.name.find('_'));
}

class CityOfAnySize : public testing::TestWithParam<CityOptions> {};

TEST_P(CityOfAnySize, CountsAreWhatWasAsked) {
  const CityOptions options = GetParam();
  const Scene city = make_city(options);
  EXPECT_EQ(city.objects.size(), options.objects);
  const auto asked = static_cast<double>(options.triangles);
  EXPECT_NEAR(static_cast<double>(city.triangle_count()), asked, 0.01 * asked);
  std::set<std::string> names;
  std::set<std::string> kinds;
  for (const Object& object : city.objects) {
    EXPECT_GE(object.triangle_count, 2U) << object.name;
    EXPECT_GT(object.bounds.diagonal(), 0.01) << object.name;
    EXPECT_GT(object.area_m2, 1e-4) << object.name;
    names.insert(object.name);
    kinds.insert(kind_of(object));
  }
  EXPECT_EQ(names.size(), city.objects.size());
  EXPECT_EQ(kinds, (std::set<std::string>{"building", "car", "furniture", "ground", "tree"}));
}

INSTANTIATE_TEST_SUITE_P(City, CityOfAnySize,
                         testing::Values(CityOptions{16, 3'200, 1}, CityOptions{16, 400'000, 2}, CityOptions{17, 3'400, 3},
                                         CityOptions{30, 60'000, 1}, CityOptions{200, 200'000, 1}, CityOptions{333, 66'600, 9},
                                         CityOptions{1000, 1'000'000, 4}, CityOptions{5287, 1'057'400, 1}, CityOptions{5287, 10'400'000, 1},
                                         CityOptions{5287, 10'400'000, 77}));

// Every mesh keeps the promises of scene.h.
TEST(City, MeshesAreSound) {
  for (const CityOptions& options : {CityOptions{16, 3'200, 1}, CityOptions{60, 120'000, 2}, CityOptions{16, 300'000, 1}}) {
    const Scene city = make_city(options);
    for (const Mesh& mesh : city.meshes) {
      SCOPED_TRACE(mesh.name);
      ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
      ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
      for (const glm::vec3& normal : mesh.normals) ASSERT_NEAR(glm::length(normal), 1.0F, 1e-4F);
      for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        ASSERT_LT(std::max({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]}), mesh.positions.size());
        const Vec3 a = mesh.positions[mesh.indices[i]];
        const Vec3 n = glm::cross(Vec3(mesh.positions[mesh.indices[i + 1]]) - a, Vec3(mesh.positions[mesh.indices[i + 2]]) - a);
        ASSERT_GT(glm::length(n), 0.0) << "triangle " << i / 3;
        ASSERT_GT(glm::dot(n, Vec3(mesh.normals[mesh.indices[i]])) / glm::length(n), -0.5) << "inside out at triangle " << i / 3;
        if (mesh.name.find("leaves") != std::string::npos) break;  // cards are lit like the crown, whichever way they face
      }
    }
  }
}

TEST(City, SameSeedSameCityAnotherSeedAnother) {
  const Scene a = make_city({120, 60'000, 5});
  const Scene b = make_city({120, 60'000, 5});
  const Scene c = make_city({120, 60'000, 6});
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (std::size_t m = 0; m < a.meshes.size(); ++m) ASSERT_TRUE(a.meshes[m].positions == b.meshes[m].positions);
  bool differs = false;
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    ASSERT_EQ(a.objects[i].world_from_object, b.objects[i].world_from_object);
    differs = differs || a.objects[i].world_from_object != c.objects[i].world_from_object;
  }
  for (std::size_t t = 0; t < a.textures.size(); ++t) ASSERT_TRUE(a.textures[t].rgba == b.textures[t].rgba);
  EXPECT_TRUE(differs);
}

TEST(City, HasTheExtentOfVienna) {
  const Scene city = make_city({});
  EXPECT_NEAR(city.bounds.size().x, 1500.0, 15.0);
  EXPECT_NEAR(city.bounds.size().z, 1000.0, 10.0);
  for (const Object& object : city.objects) {
    const double height_m = object.bounds.size().y;
    if (kind_of(object) == "building") {
      EXPECT_TRUE(height_m > 12.0 && height_m < 28.0) << object.name << " " << height_m;
    } else if (kind_of(object) == "tree") {
      EXPECT_TRUE(height_m > 5.0 && height_m < 15.0) << object.name << " " << height_m;
      EXPECT_TRUE(object.triangle_count > 4'000 && object.triangle_count < 20'000) << object.triangle_count;
    }
  }
}

// Half a metre behind the front line of every built block there is a building, all around: nobody sees through a block.
TEST(City, StreetsAreCanyons) {
  const Scene city = make_city({400, 200'000, 1});
  const auto built_at = [&](const Vec3& at) {
    return std::any_of(city.objects.begin(), city.objects.end(),
                       [&](const Object& object) { return kind_of(object) == "building" && object.bounds.contains(at); });
  };
  int blocks = 0;
  for (const Object& tile : city.objects) {
    if (kind_of(tile) != "ground" || tile.part_count == 3) continue;  // three parts: a park with its lawn
    ++blocks;
    const Vec3 centre = tile.bounds.centre();
    const Vec3 half = 0.5 * tile.bounds.size() - 0.5 * 14.5 - 0.5;
    for (double along = -1.0; along <= 1.0; along += 0.02) {
      for (const double side : {-1.0, 1.0}) {
        EXPECT_TRUE(built_at({centre.x + along * half.x, 5.0, centre.z + side * half.z}));
        EXPECT_TRUE(built_at({centre.x + side * half.x, 5.0, centre.z + along * half.z}));
      }
    }
  }
  EXPECT_EQ(blocks, 14);
}

TEST(City, InstancesShareMeshes) {
  const Scene city = make_city({1000, 1'000'000, 1});
  std::uint64_t stored = 0;
  for (const Mesh& mesh : city.meshes) stored += mesh.triangle_count();
  EXPECT_LT(stored * 8, city.triangle_count());
}

TEST(City, RefusesWhatCannotBeBuilt) {
  for (const CityOptions& options : {CityOptions{15, 100'000, 1}, CityOptions{100, 19'999, 1}}) {
    try {
      (void)make_city(options);
      ADD_FAILURE() << "built";
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.word(), ErrorWord::kBadUsage);
    }
  }
}

TEST(City, TablesInTheRepositoryAreCurrent) {
  std::ifstream file(std::string(STANDIN_SOURCE_DIR) + "/tests/bench/city.md");
  std::stringstream written;
  written << file.rdbuf();
  EXPECT_EQ(written.str(), test::city_tables()) << "run city_table > tests/bench/city.md";
}

}  // namespace
}  // namespace standin
