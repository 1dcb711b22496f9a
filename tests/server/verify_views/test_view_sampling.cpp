#include <gtest/gtest.h>

#include <map>

#include "server/verify/view_sampling.h"
#include "tests/server/verify_views/small_placement.h"

namespace standin {
namespace {

constexpr std::uint32_t kViews = 480;

class ViewSampling : public testing::Test {
 protected:
  [[nodiscard]] std::vector<VerifiedView> sample(std::uint32_t count = kViews, std::uint64_t seed = 7) const {
    return sample_views(world.placement, world.view_space, count, seed);
  }
  [[nodiscard]] std::map<ViewOrigin, std::vector<View>> by_origin() const {
    std::map<ViewOrigin, std::vector<View>> views;
    for (const auto& view : sample()) views[view.origin].push_back(view.view);
    return views;
  }
  /// Indices of the CPVs whose closed region holds the view.
  [[nodiscard]] std::vector<std::size_t> regions_of(const View& view) const {
    std::vector<std::size_t> regions;
    for (std::size_t i = 0; i < world.placement.cpvs.size(); ++i) {
      const auto& cpv = world.placement.cpvs[i];
      if (world.placement.cells[cpv.cell].box.contains(view.position) && holds(world.placement.intervals[cpv.interval], view.direction))
        regions.push_back(i);
    }
    return regions;
  }
  static bool holds(const DirectionInterval& interval, const Vec3& direction) {
    const FaceFrame& frame = face_frame(interval.face);
    const double along = glm::dot(direction, frame.n);
    const double a = std::atan2(glm::dot(direction, frame.u), along), b = std::atan2(glm::dot(direction, frame.v), along);
    const auto [a0, a1, b0, b1] = interval.angles_rad();
    constexpr double kSlack = 1e-9;
    return a >= a0 - kSlack && a <= a1 + kSlack && b >= b0 - kSlack && b <= b1 + kSlack;
  }

  test::SmallPlacement world;
};

TEST_F(ViewSampling, EveryPositionIsInTheViewSpaceAndEveryDirectionHasLengthOne) {
  for (const auto& sampled : sample()) {
    EXPECT_TRUE(world.view_space.boxes[0].contains(sampled.view.position));
    EXPECT_NEAR(glm::length(sampled.view.direction), 1.0, 1e-12);
  }
}

TEST_F(ViewSampling, FirstViewsDoNotDependOnHowManyFollow) {
  const auto few = sample(10), many = sample(100);
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i].view.position, many[i].view.position);
    EXPECT_EQ(few[i].view.direction, many[i].view.direction);
  }
  EXPECT_NE(sample(10, 8)[0].view.position, few[0].view.position);
}

TEST_F(ViewSampling, HalfIsRandomAndMostOfThatInsideSlowRegions) {
  const auto views = by_origin();
  const auto& random = views.at(ViewOrigin::kRandom);
  EXPECT_EQ(random.size(), kViews / 2);
  const auto inside = std::count_if(random.begin(), random.end(), [&](const View& view) { return !regions_of(view).empty(); });
  EXPECT_GE(inside, 3 * static_cast<long>(random.size()) / 4);
  EXPECT_LT(inside, static_cast<long>(random.size()));
}

TEST_F(ViewSampling, CornersAreCornersOfCellAndInterval) {
  const auto views = by_origin();  // outlives the loop
  for (const View& view : views.at(ViewOrigin::kCorner)) {
    EXPECT_TRUE(view.position.x == -4.0 || view.position.x == 0.0) << view.position.x;
    EXPECT_EQ(std::abs(view.position.y), 1.0);
    EXPECT_TRUE(view.position.z == 0.0 || std::abs(view.position.z) == 4.0) << view.position.z;
    bool is_corner = false;
    for (const auto& interval : world.placement.intervals)
      for (const Vec3& corner : interval.corner_directions()) is_corner = is_corner || corner == view.direction;
    EXPECT_TRUE(is_corner);
  }
}

TEST_F(ViewSampling, BordersAreOnTheBorderOfAnInterval) {
  const auto views = by_origin();  // outlives the loop
  for (const View& view : views.at(ViewOrigin::kBorder)) {
    double nearest_rad = 1.0;
    for (const auto& interval : world.placement.intervals) {
      const FaceFrame& frame = face_frame(interval.face);
      const double along = glm::dot(view.direction, frame.n);
      const double a = std::atan2(glm::dot(view.direction, frame.u), along), b = std::atan2(glm::dot(view.direction, frame.v), along);
      const auto [a0, a1, b0, b1] = interval.angles_rad();
      for (const double off : {a - a0, a - a1, b - b0, b - b1}) nearest_rad = std::min(nearest_rad, std::abs(off));
    }
    EXPECT_LT(nearest_rad, 1e-12);
    EXPECT_FALSE(regions_of(view).empty());
  }
}

// Bounds after are 10, 10.5, 11 and 11.5 ms: the last region is visited first, the first one last, and so again.
TEST_F(ViewSampling, TightViewsStartWhereTheBoundIsNearestTheBudget) {
  const auto tight = by_origin().at(ViewOrigin::kTight);
  ASSERT_GE(tight.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) {
    const auto regions = regions_of(tight[i]);
    EXPECT_NE(std::find(regions.begin(), regions.end(), 3 - i % 4), regions.end()) << i;
  }
}

TEST_F(ViewSampling, PathsRunStraightAndLookAhead) {
  const auto path = by_origin().at(ViewOrigin::kPath);
  ASSERT_GE(path.size(), 16U);
  for (std::size_t run = 0; run + 8 <= path.size(); run += 8)
    for (std::size_t i = run; i + 1 < run + 8; ++i) {
      const Vec3 step = path[i + 1].position - path[i].position;
      EXPECT_NEAR(glm::dot(glm::normalize(step), path[i].direction), 1.0, 1e-9);
    }
}

TEST_F(ViewSampling, WithoutSlowRegionsViewsAreRandomOrOnPaths) {
  world.placement.cpvs.clear();
  for (const auto& view : sample()) EXPECT_TRUE(view.origin == ViewOrigin::kRandom || view.origin == ViewOrigin::kPath);
}

TEST_F(ViewSampling, UnsolvedRegionsAreNeverCalledTight) {
  for (auto& cpv : world.placement.cpvs) cpv.solved = cpv.cell == 0 && cpv.interval == 0;
  const auto views = by_origin();  // outlives the loop
  for (const View& view : views.at(ViewOrigin::kTight)) {
    const auto regions = regions_of(view);
    EXPECT_NE(std::find(regions.begin(), regions.end(), 0U), regions.end());
  }
}

}  // namespace
}  // namespace standin
