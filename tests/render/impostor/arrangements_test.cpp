// Impostors all around a cell and all around an object: nothing is left out, nothing stands twice, and from everywhere they promise to
// serve there is one that serves and keeps its promise.
#include "render/impostor/arrangements.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "render/base/error.h"
#include "tests/render/impostor/ray_judge.h"

namespace standin {
namespace {

constexpr Box kCell{Vec3(-5.0), Vec3(5.0)};

/// Objects all around the cell, from inside it to 120 m away.
struct Surroundings {
  Surroundings() {
    Rng rng(31);
    test::SmallScene small;
    for (int i = 0; i < 80; ++i) {
      const Vec3 low = test::random_point(rng, {Vec3(-120.0, -60.0, -120.0), Vec3(120.0, 60.0, 120.0)});
      triangles.push_back(test::random_triangles(rng, {low, low + rng.uniform(1.0, 12.0)}, 4));
      small.add_object(triangles.back());
    }
    scene = std::move(small.scene);
  }
  Scene scene;
  std::vector<std::vector<test::WorldTriangle>> triangles;  // by object
};

/// By brute force: the least distance over a grid of points of both boxes, never below the true one.
double sampled_distance(const Box& a, const Box& b) {
  double least = 1e300;
  const Vec3 from = glm::clamp(a.centre(), b.min, b.max);
  Vec3 p = glm::clamp(from, a.min, a.max);
  for (int i = 0; i < 60; ++i) {  // alternating projections between convex sets converge to the nearest pair
    const Vec3 q = glm::clamp(p, b.min, b.max);
    p = glm::clamp(q, a.min, a.max);
    least = std::min(least, glm::length(p - q));
  }
  return least;
}

TEST(EnvironmentMap, HoldsEveryFarObjectOnceAndNoNearOne) {
  const Surroundings around;
  constexpr double kFarField = 40.0;
  std::map<std::uint32_t, int> times;
  const auto requests = environment_map_requests(around.scene, kCell, kFarField);
  EXPECT_EQ(requests.size(), 6U);
  for (const BakeRequest& request : requests) {
    EXPECT_TRUE(std::is_sorted(request.objects.begin(), request.objects.end()));
    for (const std::uint32_t id : request.objects) ++times[id];
  }
  int far_objects = 0;
  for (std::uint32_t id = 0; id < around.scene.objects.size(); ++id) {
    const bool is_far = sampled_distance(around.scene.objects[id].bounds, kCell) >= kFarField;
    far_objects += is_far ? 1 : 0;
    EXPECT_EQ(times[id], is_far ? 1 : 0) << "object " << id;
  }
  EXPECT_GT(far_objects, 30);
  EXPECT_LT(far_objects, 80);
}

TEST(EnvironmentMap, OfVisibleObjectsHoldsNoOthers) {
  const Surroundings around;
  std::vector<std::uint32_t> visible;
  for (std::uint32_t id = 0; id < around.scene.objects.size(); id += 3) visible.push_back(id);
  std::vector<std::uint32_t> of_all, of_visible;
  for (const BakeRequest& request : environment_map_requests(around.scene, kCell, 40.0))
    std::ranges::copy_if(request.objects, std::back_inserter(of_all), [](std::uint32_t id) { return id % 3 == 0; });
  for (const BakeRequest& request : environment_map_requests(around.scene, visible, kCell, 40.0))
    of_visible.insert(of_visible.end(), request.objects.begin(), request.objects.end());
  EXPECT_GT(of_visible.size(), 5U);
  EXPECT_EQ(of_visible, of_all);
}

TEST(EnvironmentMap, EveryFaceKeepsThePromise) {
  const Surroundings around;
  const Camera camera;
  int judged = 0;
  for (const BakeRequest& request : environment_map_requests(around.scene, kCell, 40.0)) {
    const Impostor impostor = bake_layered(around.scene, request, camera, {});
    std::vector<test::WorldTriangle> triangles;
    for (const std::uint32_t id : request.objects)
      triangles.insert(triangles.end(), around.triangles[id].begin(), around.triangles[id].end());
    const test::Verdict verdict = test::judge(test::opaque_surfaces(triangles), impostor, camera.pixel_angle_rad(), 300, 6);
    judged += verdict.judged;
    EXPECT_EQ(verdict.gaps, 0);
    EXPECT_LE(verdict.worst_parallax, 1.0 + 1e-6);
  }
  EXPECT_GT(judged, 300);
}

TEST(EnvironmentMap, HasNoFaceWithoutObjectsAndNeedsAFarField) {
  const Surroundings around;
  EXPECT_TRUE(environment_map_requests(around.scene, kCell, 1e6).empty());
  EXPECT_THROW((void)environment_map_requests(around.scene, kCell, 0.0), Failure);
  test::SmallScene below;
  below.add_object(test::rectangle({-500, -80, -500}, {1000, 0, 0}, {0, 0, 1000}));
  const auto requests = environment_map_requests(below.scene, kCell, 40.0);
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(plan_impostor(below.scene.objects[0].bounds, kCell, {}, {.max_resolution = 100'000}).frame.forward, Vec3(0, -1, 0));
}

TEST(ViewIndependent, EveryViewpointThatIsFarEnoughLiesInAShaft) {
  Rng rng(8);
  test::SmallScene small;
  small.add_object(test::random_triangles(rng, {Vec3(3.0, 4.0, 5.0), Vec3(5.0, 7.0, 6.0)}, 20));
  const Vec3 centre = small.scene.objects[0].bounds.centre();
  for (const std::uint32_t side : {1U, 2U, 3U}) {
    const auto requests = view_independent_requests(small.scene, {0}, 6.0, side);
    EXPECT_EQ(requests.size(), 6U * side * side);
    for (int i = 0; i < 20000; ++i) {
      Vec3 direction = test::random_point(rng, {Vec3(-1.0), Vec3(1.0)});
      if (i % 4 == 0) direction = glm::sign(direction);                 // towards the cube's corners
      if (i % 4 == 1) direction[i % 3] = std::abs(direction.x) + 1e-9;  // near its edges
      const double distance = i % 3 == 0 ? 6.0 : 6.0 * std::exp(rng.uniform(0.0, 6.0));
      const Vec3 viewpoint = centre + distance * glm::normalize(direction);
      EXPECT_TRUE(std::any_of(requests.begin(), requests.end(), [&](const BakeRequest& r) { return encloses(r.view_cell, viewpoint); }))
          << viewpoint.x << " " << viewpoint.y << " " << viewpoint.z << ", " << side << " patches a side";
    }
  }
}

TEST(ViewIndependent, EveryShaftKeepsThePromise) {
  Rng rng(9);
  const auto triangles = test::random_triangles(rng, {Vec3(-1.0), Vec3(1.0)}, 30);
  test::SmallScene small;
  small.add_object(triangles);
  Camera camera;
  camera.width = camera.height = 128;
  for (const BakeRequest& request : view_independent_requests(small.scene, {0}, 12.0, 1)) {
    const Impostor impostor = bake_layered(small.scene, request, camera, {});
    const test::Verdict verdict = test::judge(test::opaque_surfaces(triangles), impostor, camera.pixel_angle_rad(), 200, 2);
    EXPECT_GT(verdict.judged, 50);
    EXPECT_EQ(verdict.gaps, 0);
    EXPECT_LE(verdict.worst_parallax, 1.0 + 1e-6);
  }
  EXPECT_THROW((void)view_independent_requests(small.scene, {}, 12.0, 1), Failure);
  EXPECT_THROW((void)view_independent_requests(small.scene, {0}, 0.0, 1), Failure);
}

}  // namespace
}  // namespace standin
