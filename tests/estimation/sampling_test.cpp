// Calibration from end to end on a small scene with the fake timer, whose milliseconds are a known function of what was drawn.
#include <gtest/gtest.h>

#include "estimation/calibrate.h"
#include "estimation/designed_scene.h"
#include "small_scenes.h"

namespace standin {
namespace {

Scene small_scene() {
  Scene scene;
  Rng rng(1);
  for (int i = 0; i < 24; ++i) {
    const Mat4 place = glm::translate(Mat4(1.0), Vec3(8.0 * (i % 5), 1.0, 8.0 * static_cast<double>(i / 5)));
    test::add_object(scene, test::random_mesh(rng, static_cast<int>(20 + rng.below(200))), place, i % 3 == 0,
                     i % 6 == 0 ? AlphaMode::kMask : AlphaMode::kOpaque);
  }
  return scene;
}

double fake_ms(const FrameCounts& counts) {
  return 0.3 + 0.02 * static_cast<double>(counts.draws) + 1e-3 * static_cast<double>(counts.triangles);
}

/// A cube of twelve triangles on [-half, half]^3, seen from both sides.
Mesh cube_mesh(float half) {
  std::vector<glm::vec3> corners;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-half, half})
      for (const auto& [u, v] : {std::pair(-half, -half), {half, -half}, {half, half}, {-half, -half}, {half, half}, {-half, half}}) {
        glm::vec3 corner;
        corner[axis] = side;
        corner[(axis + 1) % 3] = u;
        corner[(axis + 2) % 3] = v;
        corners.push_back(corner);
      }
  return test::mesh_of(corners);
}

/// 49 soups of 40,000 triangles, each shut into a cube: two million triangles that nobody outside can see.
Scene hidden_soups() {
  Scene scene;
  Rng rng(2);
  for (const bool is_cube : {false, true})
    for (int i = 0; i < 49; ++i) {
      const Mat4 place = test::moved(8.0 * (i % 7), 3.0, 8.0 * static_cast<double>(i / 7));
      if (i == 0) {
        test::add_object(scene, is_cube ? cube_mesh(2.5F) : test::random_mesh(rng, 40'000), place, true);
      } else {
        scene.objects.push_back(scene.objects.back());
        scene.objects.back().world_from_object = place;
      }
    }
  update_derived(scene);
  return scene;
}

class Sampling : public ::testing::Test {
 protected:
  [[nodiscard]] std::vector<TimedFrame> sample(double seconds, std::uint64_t seed) {
    context_->make_current();
    const auto timer = make_fake_frame_timer(fake_ms);
    CalibrationOptions options;
    options.seconds = seconds;
    options.seed = seed;
    return sample_frames(scenes_, *context_, *timer, camera_, options, {}, {});
  }

  Camera camera_{.width = 64, .height = 64};
  std::vector<TrainingScene> scenes_ = {{small_scene()}, {make_designed_scene(), true}};
  std::unique_ptr<Context> context_ = make_context(DeviceKind::kOsMesa, 64, 64);
};

TEST_F(Sampling, FindsTheCostsOfAFakeDevice) {
  const std::vector<TimedFrame> frames = sample(10.0, 1);
  ASSERT_GE(frames.size(), 100U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].designed, frames[i].group == 1);
    EXPECT_GT(frames[i].seconds, i > 0 ? frames[i - 1].seconds : 0.0);
  }
  const FitSummary fit = fit_time_model(frames, 0.95);
  EXPECT_NEAR(fit.model.milliseconds_per_unit[static_cast<std::size_t>(Term::kFrame)], 0.3, 0.01);
  EXPECT_NEAR(fit.model.milliseconds_per_unit[static_cast<std::size_t>(Term::kDraws)], 0.02, 0.001);
  EXPECT_NEAR(fit.model.milliseconds_per_unit[static_cast<std::size_t>(Term::kTriangles)], 1e-3, 2e-5);
  EXPECT_LT(fit.median_error, 0.01);
}

TEST_F(Sampling, ShowsEveryTerm) {
  Features most;
  for (const TimedFrame& frame : sample(3.0, 2))
    for (std::size_t i = 0; i < kTermCount; ++i) most.value[i] = std::max(most.value[i], frame.features.value[i]);
  for (std::size_t i = 0; i < kTermCount; ++i) EXPECT_GT(most.value[i], 0.0) << term_name(static_cast<Term>(i));
}

TEST_F(Sampling, DrawsNoMoreThanAVisibleSetWouldLeaveOfALargeScene) {
  scenes_.front().scene = hidden_soups();
  ASSERT_GT(scenes_.front().scene.triangle_count(), 1'900'000U);
  double most_triangles = 0.0, frames = 0.0, designed = 0.0;
  for (const TimedFrame& frame : sample(15.0, 3)) {
    (frame.designed ? designed : frames) += 1.0;
    if (!frame.designed) most_triangles = std::max(most_triangles, frame.features[Term::kTriangles]);
  }
  EXPECT_GE(frames, 20.0);
  EXPECT_LE(most_triangles, 2e5);
  EXPECT_LE(designed, frames + 1.0) << "the designed scene takes no more turns than the others, however small it is beside them";
}

TEST_F(Sampling, DependsOnTheSeedAlone) {
  const auto same_features = [](const TimedFrame& a, const TimedFrame& b) { return a.features.value == b.features.value; };
  const std::vector<TimedFrame> first = sample(2.0, 7), longer = sample(4.0, 7), other = sample(2.0, 8);
  ASSERT_LT(first.size(), longer.size());
  EXPECT_TRUE(std::equal(first.begin(), first.end(), longer.begin(), same_features)) << "more seconds only add frames";
  EXPECT_FALSE(std::equal(first.begin(), first.end(), other.begin(), same_features));
}

TEST_F(Sampling, StopsOnRequestAndRefusesNoTime) {
  EXPECT_THROW((void)sample(0.0, 1), Failure);
  const std::atomic<bool> stop = true;
  const auto timer = make_fake_frame_timer(fake_ms);
  context_->make_current();
  EXPECT_THROW((void)sample_frames(scenes_, *context_, *timer, camera_, {}, {}, WorkBudget(&stop)), Failure);
  EXPECT_THROW((void)sample_frames({}, *context_, *timer, camera_, {}, {}, {}), Failure);
}

TEST_F(Sampling, EndsWhenItIsToldThatThisIsEnough) {
  const auto timer = make_fake_frame_timer(fake_ms);
  context_->make_current();
  CalibrationOptions options;
  options.seconds = 25.0;
  std::vector<double> looked_at_s;
  const auto enough = [&](const std::vector<TimedFrame>& frames) {
    looked_at_s.push_back(frames.back().seconds);
    return looked_at_s.size() == 2;
  };
  const auto frames = sample_frames(scenes_, *context_, *timer, camera_, options, enough, {});
  ASSERT_EQ(looked_at_s.size(), 2U);
  EXPECT_GE(looked_at_s[0], kLookEvery_s);
  EXPECT_LT(looked_at_s[0], 2 * kLookEvery_s);
  EXPECT_GE(looked_at_s[1], 2 * kLookEvery_s);
  EXPECT_EQ(frames.back().seconds, looked_at_s[1]);
}

}  // namespace
}  // namespace standin
