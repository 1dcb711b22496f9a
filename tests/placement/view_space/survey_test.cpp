#include "placement/view_space/survey.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/ascii_world.h"

namespace standin {
namespace {

struct Surveyed {
  Scene scene = test::ascii_world({".........TTT", ".........TTT", ".........TTT"});
  std::vector<std::uint32_t> rank = test::identity_rank(scene);
  ViewSpace space = make_box_view_space({{{10, 1.6, 13}, {14, 1.8, 17}}, {{50, 1.6, 13}, {54, 1.8, 17}}}, {});
  TimeModel model = test::triangle_time_model();
  Camera camera;
  SurveyOptions options;
  Subdivision subdivision;

  Surveyed() {
    SubdivisionOptions generous;
    generous.predicted_budget_ms = 1e9;
    subdivision = subdivide(scene, rank, space, {}, model, camera, {}, generous, {});
    options.views = 2000;
  }
  [[nodiscard]] Survey run(int threads = 1) {
    options.threads = threads;
    return survey_views(scene, space, subdivision, model, camera, options, {});
  }
};

TEST(Survey, PercentilesAreNearestRank) {
  EXPECT_EQ(percentile({5, 1, 4, 2, 3}, 0.5), 3);
  EXPECT_EQ(percentile({5, 1, 4, 2, 3}, 0.9), 5);
  EXPECT_EQ(percentile({5, 1, 4, 2, 3}, 0.2), 1);
  EXPECT_EQ(percentile({5, 1, 4, 2, 3}, 0.0), 1);
  EXPECT_EQ(percentile({}, 0.5), 0);
}

TEST(Survey, FindsTheForestToBlame) {
  Surveyed world;
  const Survey survey = world.run();
  EXPECT_EQ(survey.uniform.size(), 2000U);
  EXPECT_NEAR(survey.worst_frame_ms, 10.802, 1e-9);  // nine trees and the ground
  EXPECT_NEAR(survey.worst_bound_ms, 10.802, 1e-9);
  EXPECT_LT(survey.p50_ms, 0.1);  // most directions see none
  EXPECT_LE(survey.p50_ms, survey.p90_ms);
  EXPECT_LE(survey.p99_ms, survey.worst_frame_ms);
  ASSERT_FALSE(survey.worst.empty());
  EXPECT_EQ(world.scene.objects[survey.worst[0].causes[0].object].name, "tree");
  EXPECT_NEAR(survey.worst[0].causes[0].predicted_ms, 1.2, 1e-9);
}

TEST(Survey, ViewsLieWhereTheyAreSaidToAndStayWithinTheBounds) {
  Surveyed world;
  const Survey survey = world.run();
  for (const SurveyedView& view : survey.uniform) {
    EXPECT_TRUE(world.subdivision.cells[view.cell].box.contains(view.view.position));
    EXPECT_NEAR(glm::length(view.view.direction), 1.0, 1e-12);
    EXPECT_LE(view.predicted_ms, world.subdivision.cells[view.cell].worst_predicted_ms + 1e-9);
  }
  ASSERT_EQ(survey.hot.size(), survey.regions.size() * world.options.views_per_region);
  for (std::size_t i = 0; i < survey.hot.size(); ++i) {
    const SurveyedRegion& region = survey.regions[i / world.options.views_per_region];
    EXPECT_EQ(survey.hot[i].cell, region.cell);
    EXPECT_EQ(interval_of(survey.hot[i].view.direction, region.interval.level), region.interval);
    EXPECT_LE(survey.hot[i].predicted_ms, region.bound_predicted_ms + 1e-9);
    EXPECT_GE(region.looseness(), 1.0);
  }
}

TEST(Survey, DirectionsAreUniformOnTheSphere) {
  Surveyed world;
  const Survey survey = world.run();
  Vec3 mean(0.0);
  double up_half = 0.0;
  for (const SurveyedView& view : survey.uniform) {
    mean += view.view.direction / 2000.0;
    up_half += std::abs(view.view.direction.y) > 0.5 ? 1.0 / 2000.0 : 0.0;
  }
  EXPECT_LT(glm::length(mean), 0.06);
  EXPECT_NEAR(up_half, 0.5, 0.05);  // Archimedes: heights are uniform
}

TEST(Survey, TheSameForAnyNumberOfThreads) {
  Surveyed world;
  const Survey one = world.run(1), three = world.run(3);
  for (std::size_t i = 0; i < one.uniform.size(); ++i) {
    ASSERT_EQ(one.uniform[i].view.position, three.uniform[i].view.position);
    ASSERT_EQ(one.uniform[i].predicted_ms, three.uniform[i].predicted_ms);
  }
  ASSERT_EQ(one.hot.size(), three.hot.size());
  for (std::size_t i = 0; i < one.hot.size(); ++i) ASSERT_EQ(one.hot[i].predicted_ms, three.hot[i].predicted_ms);
}

}  // namespace
}  // namespace standin
