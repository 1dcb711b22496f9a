// The whole of verification on two walls, with a timer that counts triangles instead of milliseconds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/image/image_error.h"
#include "server/verify/frame_pictures.h"
#include "server/verify/verify.h"
#include "tests/server/verify_views/small_placement.h"

namespace standin {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// 1 ms a triangle, in the model and on the timer.
Target one_ms_per_triangle() {
  Target target;
  target.model.milliseconds_per_unit[static_cast<std::size_t>(Term::kTriangles)] = 1.0;
  target.model.milliseconds_per_unit[static_cast<std::size_t>(Term::kImpostorQuads)] = 2.0;
  return target;
}

TimingSession count_triangles(Context&) {
  return {nullptr, make_fake_frame_timer([](const FrameCounts& counts) { return static_cast<double>(counts.triangles); })};
}

class VerifyPlacement : public testing::Test {
 protected:
  VerifyResult verify(double budget_ms, const VerifyOptions& options, const StartTiming& timing = count_triangles) {
    const VerifyInput input{world.scene,  target,    world.placement, world.view_space,
                            world.camera, world.glb, budget_ms,       world.camera.pixel_angle_rad()};
    return verify_placement(input, *context, timing, options, {});
  }

  test::SmallPlacement world;
  Target target = one_ms_per_triangle();
  std::unique_ptr<Context> context = make_context(DeviceKind::kOsMesa, 64, 64);
};

TEST_F(VerifyPlacement, TimesWhatTheLookUpSays) {
  const auto quad_triangles = 2.0 * world.placement.impostors[0].quads;
  ASSERT_LT(quad_triangles, test::kWallTriangles);
  const VerifyResult result = verify(100.0, {.views = 64});
  int with_impostor = 0;
  for (const auto& view : result.views) {
    ASSERT_TRUE(view.measured_before_ms && view.measured_after_ms);
    const bool sees_wall = *view.measured_before_ms >= test::kWallTriangles;
    if (view.cpv && sees_wall) {
      EXPECT_EQ(*view.measured_after_ms, *view.measured_before_ms - test::kWallTriangles + quad_triangles);
      ++with_impostor;
    } else if (!view.cpv) {
      EXPECT_EQ(*view.measured_after_ms, *view.measured_before_ms);
      EXPECT_EQ(view.mean_error, 0.0);
    }
  }
  EXPECT_GT(with_impostor, 20);
}

TEST_F(VerifyPlacement, EstimatesAgreeWithCountsWhereAllIsInView) {
  for (const auto& view : verify(100.0, {.views = 64}).views) {
    EXPECT_EQ(view.estimated_before_ms, *view.measured_before_ms);
    EXPECT_EQ(view.estimated_after_ms, *view.measured_after_ms);
  }
}

TEST_F(VerifyPlacement, CountsViewsOverTheBudget) {
  const VerifyResult generous = verify(1000.0, {.views = 32});
  EXPECT_EQ(generous.over_budget_measured, 0U);
  EXPECT_EQ(generous.over_budget_estimated, 0U);
  EXPECT_LT(generous.worst_over_budget, 1.0);
  const VerifyResult tight = verify(1.0, {.views = 32});
  std::uint32_t over = 0;
  double worst = 0.0;
  for (const auto& view : tight.views) {
    over += *view.measured_after_ms > 1.0 ? 1U : 0U;
    worst = std::max(worst, *view.measured_after_ms);
  }
  EXPECT_GT(over, 0U);
  EXPECT_EQ(tight.over_budget_measured, over);
  EXPECT_EQ(tight.over_budget_estimated, over);
  EXPECT_EQ(tight.worst_over_budget, worst);
}

TEST_F(VerifyPlacement, ComparesTheWorstFrameWithTheSurvey) {
  const VerifyInput input{world.scene, target, world.placement,           world.view_space, world.camera, world.glb,
                          100.0,       1e-3,   2.0 * test::kWallTriangles};
  const VerifyResult result = verify_placement(input, *context, count_triangles, {.views = 64}, {});
  double worst_ms = 0.0;
  for (const auto& view : result.views) worst_ms = std::max(worst_ms, *view.measured_before_ms);
  ASSERT_TRUE(result.worst_before_over_surveyed);
  EXPECT_DOUBLE_EQ(*result.worst_before_over_surveyed, worst_ms / (2.0 * test::kWallTriangles));
  EXPECT_FALSE(verify(100.0, {.views = 4}).worst_before_over_surveyed);
}

TEST_F(VerifyPlacement, TheSurveysSlowestViewsAreAmongThem) {
  VerifyInput input{world.scene, target, world.placement, world.view_space, world.camera, world.glb, 100.0, 1e-3};
  for (int i = 0; i < 5; ++i) input.surveyed_views.push_back({Vec3(0.25 * i, 1.0, 0.0), Vec3(0.0, 0.0, -1.0)});
  const auto surveyed = [&](std::uint32_t count) {
    std::vector<Vec3> positions;
    const VerifyResult result = verify_placement(input, *context, count_triangles, {.views = count}, {});
    EXPECT_EQ(result.views.size(), count);
    for (const auto& view : result.views)
      if (view.origin == ViewOrigin::kSurveyed) positions.push_back(view.view.position);
    return positions;
  };
  EXPECT_EQ(surveyed(64).size(), 5U);
  EXPECT_EQ(surveyed(12), (std::vector<Vec3>{Vec3(0.0, 1.0, 0.0), Vec3(0.25, 1.0, 0.0), Vec3(0.5, 1.0, 0.0)})) << "a quarter at most";
}

TEST_F(VerifyPlacement, CoverageIsTheShareOfFramesWithinTheirBound) {
  EXPECT_EQ(verify(100.0, {.views = 64}).measured_coverage, 1.0);
  const auto hundredfold = [](Context&) -> TimingSession {
    return {nullptr, make_fake_frame_timer([](const FrameCounts& counts) { return 100.0 * static_cast<double>(counts.triangles); })};
  };
  const VerifyResult slow = verify(100.0, {.views = 64}, hundredfold);
  int empty_frames = 0;
  for (const auto& view : slow.views) empty_frames += (*view.measured_before_ms == 0.0 ? 1 : 0) + (*view.measured_after_ms == 0.0 ? 1 : 0);
  EXPECT_EQ(slow.measured_coverage, empty_frames / 128.0);
  EXPECT_LT(*slow.measured_coverage, 0.9);
}

TEST_F(VerifyPlacement, TheSlowestEstimatesAreTimedBefore) {
  VerifyOptions options{.views = 64, .measured_before = 16};
  const VerifyResult result = verify(100.0, options);
  double least_timed = 1e9, most_untimed = 0.0;
  int timed = 0;
  for (const auto& view : result.views) {
    EXPECT_TRUE(view.measured_after_ms.has_value());
    timed += view.measured_before_ms ? 1 : 0;
    (view.measured_before_ms ? least_timed = std::min(least_timed, view.estimated_before_ms)
                             : most_untimed = std::max(most_untimed, view.estimated_before_ms));
  }
  EXPECT_EQ(timed, 16);
  EXPECT_GE(least_timed, most_untimed);
  EXPECT_THAT(result.left_out, Contains(HasSubstr("frame times before")));
}

TEST_F(VerifyPlacement, WithoutTheTargetsDeviceNothingIsTimedAndItSaysSo) {
  const VerifyResult result = verify(100.0, {.views = 16}, {});
  for (const auto& view : result.views) EXPECT_FALSE(view.measured_before_ms || view.measured_after_ms);
  EXPECT_EQ(result.over_budget_measured, 0U);
  EXPECT_THAT(result.left_out, Contains(HasSubstr("not measured")));
  EXPECT_FALSE(result.pictures.empty());
}

TEST_F(VerifyPlacement, RaysFindThePromiseKept) {
  const VerifyResult result = verify(100.0, {.views = 1, .judged_views = 8});
  EXPECT_EQ(result.judged_views, 8U);
  EXPECT_EQ(result.gap_pixels, 0U);
  EXPECT_GT(result.shown_pixels, 0U);
  EXPECT_LT(result.baseless_pixels, result.shown_pixels / 10);
  EXPECT_LE(result.max_parallax_ratio, 1.0);
  EXPECT_GE(*result.silhouette_bloat_px, 0.0);
  EXPECT_LE(*result.silhouette_bloat_px, 1.0);
}

TEST_F(VerifyPlacement, RaysFindAHole) {
  ImpostorSet holed = world.impostors;
  for (std::size_t i = 3; i < holed.pages[0].rgba.size(); i += 4) holed.pages[0].rgba[i] = 0;
  world.glb = encode_impostor_glb(holed);
  const VerifyResult result = verify(100.0, {.views = 16, .judged_views = 8});
  EXPECT_GT(result.gap_pixels, 0U);
  EXPECT_GT(result.mean_error, 0.05);
  EXPECT_GT(result.mean_flip, 0.1);
}

TEST_F(VerifyPlacement, PicturesShowTheSameScene) {
  const VerifyResult result = verify(100.0, {.views = 32, .pictures = 4});
  EXPECT_EQ(result.pictures.size(), 4U);
  EXPECT_LT(result.mean_error, 0.03);
  EXPECT_GT(result.mean_error, 0.0);
  EXPECT_LT(result.mean_flip, 0.1);
  EXPECT_GT(result.mean_flip, result.mean_error) << "edges of full contrast are seen";
  for (const auto& pictures : result.pictures) {
    const auto& view = result.views[pictures.view];
    EXPECT_NEAR(mean_error(pictures.original, pictures.with_impostors), view.mean_error, 1e-12);
    EXPECT_NEAR(mean_flip(pictures.original, pictures.with_impostors), view.mean_flip, 1e-12);
    for (std::size_t i = 3; i < pictures.original.rgba.size(); i += 4) ASSERT_EQ(pictures.original.rgba[i], 255);
  }
}

TEST_F(VerifyPlacement, WithoutViewsOrImpostorsThereIsStillAResult) {
  world.placement.cpvs.clear();
  world.placement.impostors.clear();
  world.glb = encode_impostor_glb({});
  const VerifyResult result = verify(100.0, {.views = 4});
  EXPECT_EQ(result.views.size(), 4U);
  EXPECT_EQ(result.judged_views, 0U);
  EXPECT_THAT(result.left_out, Contains(HasSubstr("no impostor")));
}

TEST(WorstViews, ByTurnsTheLargestErrorAndTheSlowest) {
  std::vector<VerifiedView> views(4);
  views[0].mean_error = 0.5;
  views[1].mean_error = 0.1;
  views[2].estimated_after_ms = 9.0;
  views[3].estimated_after_ms = 10.0;
  views[2].measured_after_ms = 12.0;  // what was measured counts
  EXPECT_THAT(worst_views(views, 3), testing::ElementsAre(0, 2, 1));
  EXPECT_THAT(worst_views(views, 9), testing::UnorderedElementsAre(0, 1, 2, 3));
  EXPECT_TRUE(worst_views({}, 4).empty());
}

TEST(ViewPictures, StandSideBySide) {
  const auto column = [](std::uint8_t top, std::uint8_t bottom) {
    return Texture{"", 1, 2, {top, top, top, 255, bottom, bottom, bottom, 255}};
  };
  const ViewPictures pictures{0, column(1, 2), column(3, 4), column(5, 6)};
  const Texture row = pictures.side_by_side();
  EXPECT_EQ(row.width, 3);
  EXPECT_EQ(row.height, 2);
  std::vector<int> reds;
  for (std::size_t i = 0; i < row.rgba.size(); i += 4) reds.push_back(row.rgba[i]);
  EXPECT_THAT(reds, testing::ElementsAre(1, 3, 5, 2, 4, 6));
}

}  // namespace
}  // namespace standin
