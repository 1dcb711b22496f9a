#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <thread>

#include "render/base/rng.h"
#include "render/visibility/raytracer.h"
#include "tests/render/visibility/hand_made_scene.h"

namespace standin {
namespace {

using test::SceneMaker;

Vec3 random_vector(Rng& rng, double size) {
  const double x = rng.uniform(-size, size);
  const double y = rng.uniform(-size, size);
  return {x, y, rng.uniform(-size, size)};
}

Vec3 random_direction(Rng& rng) {
  for (;;) {
    const Vec3 direction = random_vector(rng, 1.0);
    const double length = glm::length(direction);
    if (length > 0.1 && length < 1.0) return direction / length;
  }
}

struct OracleHit {
  Hit hit;
  double border = 0.0;  // least barycentric coordinate: how surely the ray meets the triangle
};

// Every triangle of the scene, in double.
std::vector<OracleHit> brute_force(const Scene& scene, const Vec3& origin, const Vec3& direction) {
  std::vector<OracleHit> hits;
  for (std::uint32_t id = 0; id < scene.objects.size(); ++id) {
    const Object& object = scene.objects[id];
    const Mesh& mesh = scene.meshes[scene.parts[object.first_part].mesh];
    for (std::size_t k = 0; k < mesh.indices.size(); k += 3) {
      const auto corner = [&](std::size_t i) {
        return Vec3(object.world_from_object * Vec4(Vec3(mesh.positions[mesh.indices[k + i]]), 1.0));
      };
      const Mat3 basis(corner(1) - corner(0), corner(2) - corner(0), -direction);
      if (std::abs(glm::determinant(basis)) < 1e-12) continue;
      const Vec3 uvt = glm::inverse(basis) * (origin - corner(0));
      const double border = std::min({uvt.x, uvt.y, 1.0 - uvt.x - uvt.y});
      if (uvt.z > 0.0 && border > -1e-4) hits.push_back({{uvt.z, id}, border});
    }
  }
  std::sort(hits.begin(), hits.end(), [](const OracleHit& a, const OracleHit& b) { return a.hit.distance_m < b.hit.distance_m; });
  return hits;
}

Scene random_triangles(Rng& rng, const Vec3& origin) {
  SceneMaker maker;
  std::vector<std::uint32_t> meshes;
  for (int m = 0; m < 5; ++m) {
    std::vector<glm::vec3> positions;
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i < 30; ++i) {
      positions.emplace_back(random_vector(rng, 1.0));
      indices.push_back(i);
    }
    meshes.push_back(maker.add_mesh(positions, indices));
  }
  for (int i = 0; i < 25; ++i) {
    Mat4 transform = glm::translate(Mat4(1.0), origin + random_vector(rng, 4.0));
    transform = glm::rotate(transform, rng.uniform(0, 6), random_direction(rng));
    transform = glm::scale(transform, Vec3(rng.uniform(0.3, 2), rng.uniform(0.3, 2), i % 2 == 0 ? 1.0 : -1.0));
    maker.add_object(meshes[rng.below(meshes.size())], transform);
  }
  return maker.take();
}

void expect_hits_of_brute_force(std::uint64_t seed, const Vec3& offset) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  Rng rng(seed);
  const Scene scene = random_triangles(rng, offset);
  const Raytracer raytracer(scene);
  int compared = 0;
  for (int i = 0; i < 12'000; ++i) {
    const Vec3 origin = offset + random_vector(rng, 8.0);
    const Vec3 direction = random_direction(rng);
    const auto expected = brute_force(scene, origin, direction);
    if (std::any_of(expected.begin(), expected.end(), [](const OracleHit& hit) { return std::abs(hit.border) < 1e-4; })) continue;
    const auto all = raytracer.all(origin, direction, 0.0, 1e9);
    ASSERT_EQ(all.size(), expected.size()) << "ray " << i;
    for (std::size_t k = 0; k < all.size(); ++k) EXPECT_NEAR(all[k].distance_m, expected[k].hit.distance_m, 1e-3);
    const auto nearest = raytracer.nearest(origin, direction);
    ASSERT_EQ(nearest.has_value(), !expected.empty());
    if (!nearest) continue;
    EXPECT_NEAR(nearest->distance_m, expected.front().hit.distance_m, 1e-4);
    const bool clear = expected.size() == 1 || expected[1].hit.distance_m - expected[0].hit.distance_m > 1e-3;
    EXPECT_TRUE(!clear || nearest->object == expected.front().hit.object);
    ++compared;
  }
  EXPECT_GT(compared, 1000);
}

TEST(Raytracer, FindsTheHitsOfBruteForce) {
  expect_hits_of_brute_force(61, Vec3(0.0));
}

TEST(Raytracer, FindsTheSameAMillionMetresFromTheOrigin) {
  expect_hits_of_brute_force(62, Vec3(1e6, -1e6, 1e6));
}

TEST(Raytracer, DistancesOfAPaneByHand) {
  SceneMaker maker;
  const auto pane = maker.pane_mesh();
  maker.add_object(pane, glm::translate(Mat4(1.0), Vec3(0, 0, -3)));
  maker.add_object(pane, glm::translate(Mat4(1.0), Vec3(0, 0, -7)));
  const Scene scene = maker.take();
  const Raytracer raytracer(scene);
  const Vec3 forward(0, 0, -1);
  const auto first = raytracer.nearest(Vec3(0.1, 0.2, 0), forward);
  ASSERT_TRUE(first);
  EXPECT_NEAR(first->distance_m, 3.0, 1e-6);
  EXPECT_EQ(first->object, 0U);
  const auto second = raytracer.nearest(Vec3(0.1, 0.2, 0), forward, 3.5);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->object, 1U);
  EXPECT_FALSE(raytracer.nearest(Vec3(0.1, 0.2, 0), forward, 8.0));
  EXPECT_FALSE(raytracer.nearest(Vec3(0.1, 0.2, 0), -forward));
  EXPECT_EQ(raytracer.all(Vec3(0.1, 0.2, 0), forward, 0.0, 6.999).size(), 1U);
  EXPECT_EQ(raytracer.all(Vec3(0.1, 0.2, 0), forward, 2.999, 7.001).size(), 2U);
  EXPECT_EQ(raytracer.all(Vec3(0.1, 0.2, 0), forward, 3.001, 7.001).size(), 1U);
  const Raytracer only_second(scene, {1}, {});
  EXPECT_EQ(only_second.nearest(Vec3(0.1, 0.2, 0), forward)->object, 1U);
}

TEST(Raytracer, ReportsEveryCoincidentHitAndPrefersTheLowestObject) {
  for (const int count : {2, 9, 40}) {
    SceneMaker maker;
    const auto pane = maker.pane_mesh();
    const auto copy = maker.pane_mesh();
    for (int i = 0; i < count; ++i) maker.add_object(i % 2 == 0 ? copy : pane, Mat4(1.0));
    const Scene scene = maker.take();
    const Raytracer raytracer(scene);
    const Vec3 origin(0.3, 0.1, 5);
    EXPECT_EQ(raytracer.nearest(origin, Vec3(0, 0, -1))->object, 0U);
    const auto hits = raytracer.all(origin, Vec3(0, 0, -1), 0.0, 10.0);
    ASSERT_EQ(hits.size(), static_cast<std::size_t>(count));
    for (std::uint32_t i = 0; i < hits.size(); ++i) EXPECT_EQ(hits[i].object, i);
  }
}

// From the centre of a closed cube, aimed exactly at its edges, corners and face diagonals, and all around.
TEST(Raytracer, DoesNotLeakThroughSharedEdges) {
  const std::uint64_t seed = 63;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  Rng rng(seed);
  SceneMaker maker;
  maker.add_box(Box{Vec3(-1.0), Vec3(1.0)});
  const Scene scene = maker.take();
  const Raytracer raytracer(scene);
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 origin = i % 2 == 0 ? Vec3(0.0) : random_vector(rng, 0.9);
    Vec3 target = random_vector(rng, 1.0);
    for (int axis = 0; axis < 3; ++axis)
      if (axis == i % 3 || rng.below(2) == 0) target[axis] = target[axis] < 0.0 ? -1.0 : 1.0;
    if (i % 5 == 0) target[(i + 1) % 3] = target[(i + 2) % 3];  // on a diagonal
    EXPECT_TRUE(raytracer.nearest(origin, glm::normalize(target - origin))) << "ray " << i;
  }
}

// A pane whose left half is transparent, before an opaque pane.
TEST(Raytracer, LooksThroughMaskedTexels) {
  SceneMaker maker;
  Texture texture{"half", 4, 1, {}};
  for (int x = 0; x < 4; ++x) texture.rgba.insert(texture.rgba.end(), {255, 255, 255, static_cast<std::uint8_t>(x < 2 ? 0 : 255)});
  maker.scene().textures.push_back(texture);
  Material masked;
  masked.texture = 0;
  masked.alpha_mode = AlphaMode::kMask;
  maker.scene().materials.push_back(masked);
  const auto pane = maker.pane_mesh();
  maker.add_object(pane, Mat4(1.0), 1);
  maker.add_object(pane, glm::translate(Mat4(1.0), Vec3(0, 0, -1)));
  const Scene scene = maker.take();
  const Raytracer raytracer(scene);
  const auto object_at = [](const Raytracer& rays, double x) { return rays.nearest(Vec3(x, 0.3, 5), Vec3(0, 0, -1))->object; };
  EXPECT_EQ(object_at(raytracer, -0.01), 1U);
  EXPECT_EQ(object_at(raytracer, 0.01), 0U);
  EXPECT_EQ(raytracer.all(Vec3(-0.5, 0.3, 5), Vec3(0, 0, -1), 0, 100).size(), 1U);
  EXPECT_EQ(raytracer.all(Vec3(0.5, 0.3, 5), Vec3(0, 0, -1), 0, 100).size(), 2U);
  EXPECT_EQ(object_at(Raytracer(scene, Raytracer::Options{.honour_masks = false, .threads = 1}), -0.5), 0U);
}

TEST(Raytracer, BaseAlphaCountsAndTheCutoffItselfIsOpaque) {
  SceneMaker maker;
  Material masked;
  masked.alpha_mode = AlphaMode::kMask;
  masked.alpha_cutoff = 0.5F;
  masked.base_colour.a = 0.5F;
  maker.scene().materials.push_back(masked);
  masked.base_colour.a = 0.49F;
  maker.scene().materials.push_back(masked);
  masked.alpha_mode = AlphaMode::kOpaque;
  maker.scene().materials.push_back(masked);
  const auto pane = maker.pane_mesh();
  for (std::uint32_t material = 1; material <= 3; ++material)
    maker.add_object(pane, glm::translate(Mat4(1.0), Vec3(0, 0, -1.0 * material)), material);
  const Scene scene = maker.take();
  const auto hits = Raytracer(scene).all(Vec3(0.3, 0.1, 5), Vec3(0, 0, -1), 0, 100);
  ASSERT_EQ(hits.size(), 2U);
  EXPECT_EQ(hits[0].object, 0U);
  EXPECT_EQ(hits[1].object, 2U);
}

// A transform without inverse must not make its object vanish.
TEST(Raytracer, SeesObjectsFlattenedByTheirTransform) {
  SceneMaker maker;
  maker.add_box(Box{Vec3(-1, -1, 0), Vec3(1, 1, 0)});
  const Scene scene = maker.take();
  const auto hit = Raytracer(scene).nearest(Vec3(0.5, 0.25, 2), Vec3(0, 0, -1));
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance_m, 2.0, 1e-6);
}

TEST(Raytracer, AnswersOnAnEmptyScene) {
  const Scene scene;
  const Raytracer raytracer(scene);
  EXPECT_FALSE(raytracer.nearest(Vec3(0.0), Vec3(0, 0, -1)));
  EXPECT_TRUE(raytracer.all(Vec3(0.0), Vec3(0, 0, -1), 0, 10).empty());
}

}  // namespace
}  // namespace standin
