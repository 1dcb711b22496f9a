// The timing protocol on made-up times and the fake timer; nothing here judges a real duration.
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <thread>

#include "render/base/error.h"
#include "render/device/draw_order.h"
#include "render/device/reference_frame.h"
#include "render/device/sample_statistics.h"
#include "tests/render/device/mixed_scene.h"

namespace standin::test {
namespace {

Repeat clean(double reference_ms, double frame_ms) {
  return {.reference = {reference_ms, reference_ms}, .frame = {frame_ms, 1.05 * frame_ms}};
}

Repeat contaminated(double reference_ms, double frame_ms) {
  return {.reference = {reference_ms, reference_ms}, .frame = {frame_ms, 1.2 * frame_ms}};
}

TEST(SampleStatistics, HostSpeedCancels) {
  // The host slows down by 1.5x in the middle; one repeat alone is disturbed.
  const std::vector<Repeat> repeats = {clean(2, 20), clean(2, 20), clean(3, 30), clean(3, 30), clean(3, 45)};
  const FrameSample sample = summarise(repeats, 2.5);
  EXPECT_DOUBLE_EQ(sample.milliseconds, 25.0);
  EXPECT_DOUBLE_EQ(sample.raw_milliseconds, 20.0);
  EXPECT_DOUBLE_EQ(sample.spread, 0.0);
  EXPECT_EQ(sample.rejected, 0);
  EXPECT_DOUBLE_EQ(sample.spent_milliseconds, 145.0 + 13.0);
}

TEST(SampleStatistics, ContaminatedRepeatsDoNotCountUnlessAllAre) {
  const FrameSample mixed = summarise(std::vector{contaminated(2, 4), clean(2, 20), contaminated(2, 90)}, 2.0);
  EXPECT_DOUBLE_EQ(mixed.milliseconds, 20.0);
  EXPECT_DOUBLE_EQ(mixed.raw_milliseconds, 20.0);
  EXPECT_EQ(mixed.rejected, 2);
  const FrameSample all = summarise(std::vector{contaminated(2, 4), contaminated(2, 6), contaminated(2, 8)}, 2.0);
  EXPECT_DOUBLE_EQ(all.milliseconds, 6.0);
  EXPECT_EQ(all.rejected, 3);
}

TEST(SampleStatistics, DrawsAtMostTwiceAsOftenAsAsked) {
  std::vector<Repeat> repeats;
  while (needs_another(repeats, 3)) repeats.push_back(clean(1, 1));
  EXPECT_EQ(repeats.size(), 3U);
  repeats.assign(2, contaminated(1, 1));
  while (needs_another(repeats, 3)) repeats.push_back(clean(1, 1));
  EXPECT_EQ(repeats.size(), 5U);
  repeats.clear();
  while (needs_another(repeats, 3)) repeats.push_back(contaminated(1, 1));
  EXPECT_EQ(repeats.size(), 6U);
}

TEST(SampleStatistics, TheClockFollowsWhereTheWorkIsDone) {
  const Duration here{.cpu_ms = 3.0, .wall_ms = 3.1}, disturbed{.cpu_ms = 3.0, .wall_ms = 9.0}, elsewhere{.cpu_ms = 0.2, .wall_ms = 4.0};
  EXPECT_EQ(fitting_clock(std::vector{disturbed, here, disturbed}), Clock::kThreadCpu);
  EXPECT_EQ(fitting_clock(std::vector{elsewhere, elsewhere, {.cpu_ms = 0.3, .wall_ms = 5.0}}), Clock::kWall);
  EXPECT_EQ(least_ms(std::vector{disturbed, elsewhere}, Clock::kThreadCpu), 0.2);
  EXPECT_EQ(least_ms(std::vector{disturbed, elsewhere}, Clock::kWall), 4.0);
}

TEST(SampleStatistics, ByTheWallClockNothingIsContaminated) {
  const Duration elsewhere{.cpu_ms = 0.2, .wall_ms = 4.0};
  EXPECT_TRUE(elsewhere.contaminated());
  EXPECT_FALSE(on_clock(elsewhere, Clock::kWall).contaminated());
  EXPECT_EQ(on_clock(elsewhere, Clock::kWall).cpu_ms, 4.0);
  EXPECT_EQ(on_clock(elsewhere, Clock::kThreadCpu).cpu_ms, 0.2);
}

TEST(DrawOrder, MaskedThenOctaveThenStateThenDistanceThenPiece) {
  const OrderedDraw far_opaque{.key = draw_key(false, 1000.0, 0), .distance_m = 1000.0, .piece = 0};
  const OrderedDraw near_masked{.key = draw_key(true, 1.0, 0), .distance_m = 1.0, .piece = 0};
  const OrderedDraw near_late_state{.key = draw_key(false, 8.0, ~0U), .distance_m = 8.0, .piece = 0};
  const OrderedDraw next_octave{.key = draw_key(false, 16.0, 0), .distance_m = 16.0, .piece = 0};
  const OrderedDraw same_octave{.key = draw_key(false, 15.9, 3), .distance_m = 15.9, .piece = 0};
  EXPECT_LT(far_opaque, near_masked);
  EXPECT_LT(near_late_state, next_octave);
  EXPECT_LT(same_octave, near_late_state);
  EXPECT_LT((OrderedDraw{1, 2.0, 5}), (OrderedDraw{1, 2.5, 1}));
  EXPECT_LT((OrderedDraw{1, 2.0, 1}), (OrderedDraw{1, 2.0, 5}));
  EXPECT_EQ(draw_key(false, 0.0, 0), draw_key(false, 1e-5, 0));  // no logarithm of zero
}

class FrameTimerTest : public DeviceTest {};

TEST_F(FrameTimerTest, TheFakeTimerIsAFunctionOfTheCounts) {
  const Scene scene = mixed_scene(1, 30, 8.0);
  Renderer renderer(*context, scene, small_camera());
  const View view{.position = Vec3(0.0, 0.0, 9.0)};
  const FrameCounts frame = renderer.draw(view, everything(scene));
  ASSERT_GT(frame.draws, 0U);
  const auto timer = make_fake_frame_timer(
      [](const FrameCounts& c) { return 0.5 + 0.1 * static_cast<double>(c.draws) + 0.01 * static_cast<double>(c.triangles); });
  for (int i = 0; i < 2; ++i) {
    const FrameSample sample = timer->time(renderer, view, everything(scene));
    EXPECT_DOUBLE_EQ(sample.milliseconds, 0.5 + 0.1 * static_cast<double>(frame.draws) + 0.01 * static_cast<double>(frame.triangles));
    EXPECT_DOUBLE_EQ(sample.raw_milliseconds, sample.milliseconds);
  }
  EXPECT_DOUBLE_EQ(timer->reference_ms(), 1.0);
}

TEST_F(FrameTimerTest, TheCpuTimerMeasuresSomethingAndLeavesTheFrameReadable) {
  const Scene scene = mixed_scene(2, 30, 8.0);
  Renderer renderer(*context, scene, small_camera());
  const View view{.position = Vec3(0.0, 0.0, 9.0)};
  renderer.draw(view, everything(scene));
  const Texture before = renderer.read_pixels();
  const auto timer = make_frame_timer(*context, {.warm_up = 1, .repeats = 3, .reference_ms = 4.0});
  const FrameSample sample = timer->time(renderer, view, everything(scene));
  EXPECT_TRUE(std::isfinite(sample.milliseconds) && sample.milliseconds > 0.0);
  EXPECT_DOUBLE_EQ(timer->reference_ms(), 4.0);
  EXPECT_EQ(timer->clock(), Clock::kThreadCpu);
  const auto wall = make_frame_timer(*context, {.warm_up = 1, .repeats = 3, .clock = Clock::kWall});
  EXPECT_EQ(wall->clock(), Clock::kWall);
  EXPECT_GT(wall->time(renderer, view, everything(scene)).milliseconds, 0.0);
  EXPECT_EQ(renderer.read_pixels().rgba, before.rgba);
}

TEST_F(FrameTimerTest, AProtocolOutOfRangeIsBadUsage) {
  for (const TimingProtocol& protocol : {TimingProtocol{.warm_up = -1}, TimingProtocol{.repeats = 0}, TimingProtocol{.reference_ms = -1.0},
                                         TimingProtocol{.reference_ms = std::nan("")}}) {
    try {
      [[maybe_unused]] const auto timer = make_frame_timer(*context, protocol);
      ADD_FAILURE();
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.word(), ErrorWord::kBadUsage);
    }
  }
}

// Target files hold times in units of this frame: it may not change unnoticed.
TEST_F(FrameTimerTest, TheReferenceFrameStaysWhatItWas) {
  ReferenceFrame reference(*context);
  EXPECT_EQ(reference.draw(),
            (FrameCounts{.draws = 43, .triangles = 2552, .texture_switches = 8, .program_switches = 6, .impostor_draws = 0}));
}

std::filesystem::path lock_file() {
  return std::filesystem::path(testing::TempDir()) / ("standin-lock-test-" + std::to_string(getpid()));
}

TEST(TimingLock, ASecondHolderWaitsAndCanBeCancelled) {
  const std::filesystem::path file = lock_file();
  auto holder = std::make_unique<TimingLock>(WorkBudget(), file);
  const std::atomic<bool> stop = true;
  try {
    const TimingLock second(WorkBudget(&stop), file);
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kCancelled);
  }
  std::atomic<bool> acquired = false;
  std::thread waiter([&] {
    const TimingLock second(WorkBudget(), file);
    acquired = true;
  });
  EXPECT_FALSE(acquired);
  holder.reset();
  waiter.join();
  EXPECT_TRUE(acquired);
  std::filesystem::remove(file);
}

TEST(TimingLock, AnUnusableFileIsAnEnvironmentFailure) {
  try {
    const TimingLock lock(WorkBudget(), "/nonexistent-folder/lock");
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kDeviceUnavailable);
  }
}

}  // namespace
}  // namespace standin::test
