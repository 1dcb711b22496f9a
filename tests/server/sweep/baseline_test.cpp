#include "server/sweep/baseline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/sweep/points.h"

namespace standin {
namespace {

using test::point;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(Baseline, TheSameCurveIsNoWorse) {
  const std::vector<CurvePoint> curve = {point(8, 90000, 4), point(10, 5000), point(16, 1200), point(20, 0)};
  const CurveComparison comparison = compare_curves(curve, curve, 0.0);
  EXPECT_THAT(comparison.compared_ms, ElementsAre(8, 10, 16, 20));
  EXPECT_TRUE(comparison.regressions.empty());
  EXPECT_TRUE(comparison.not_compared_ms.empty());
}

TEST(Baseline, MemoryMayGrowByTheToleranceAndNoByteMore) {
  const std::vector<CurvePoint> before = {point(10, 10000)};
  EXPECT_TRUE(compare_curves(before, {point(10, 10200)}, 0.02).regressions.empty());
  EXPECT_TRUE(compare_curves(before, {point(10, 400)}, 0.0).regressions.empty());
  const auto worse = compare_curves(before, {point(10, 10201)}, 0.02).regressions;
  ASSERT_EQ(worse.size(), 1U);
  EXPECT_EQ(worse[0].kind, Regression::kMemory);
  EXPECT_THAT(sentence(worse[0]), HasSubstr("at 10 ms: 10000 bytes of texture before, 10201 now (+2.01 %)"));
}

TEST(Baseline, MemoryFromNothingIsWorseAtAnyTolerance) {
  const auto worse = compare_curves({point(10, 0)}, {point(10, 1)}, 100.0).regressions;
  ASSERT_EQ(worse.size(), 1U);
  EXPECT_THAT(sentence(worse[0]), HasSubstr("there was none"));
}

TEST(Baseline, ABudgetNoLongerMetIsWorseHoweverLittleItTakes) {
  const auto worse = compare_curves({point(10, 10000)}, {point(10, 10, 1)}, 0.02).regressions;
  ASSERT_EQ(worse.size(), 1U);
  EXPECT_EQ(worse[0].kind, Regression::kUnsolved);
  EXPECT_THAT(sentence(worse[0]), HasSubstr("at 10 ms: the budget was met before, now 1 CPVs are unsolved"));
  EXPECT_EQ(to_json(compare_curves({point(10, 10000)}, {point(10, 10, 1)}, 0.02), 0.02)["regressions"][0]["kind"], "unsolved");
}

TEST(Baseline, UnmetBudgetsAreHeldAgainstHowManyWereUnsolved) {
  const std::vector<CurvePoint> before = {point(10, 10000, 5)};
  EXPECT_TRUE(compare_curves(before, {point(10, 10000, 5)}, 0.02).regressions.empty());
  EXPECT_TRUE(compare_curves(before, {point(10, 90000, 0)}, 0.02).regressions.empty()) << "solving more costs memory";
  EXPECT_EQ(compare_curves(before, {point(10, 11000, 5)}, 0.02).regressions.size(), 1U);
  const auto worse = compare_curves(before, {point(10, 10, 6)}, 0.02).regressions;
  ASSERT_EQ(worse.size(), 1U);
  EXPECT_THAT(sentence(worse[0]), HasSubstr("5 CPVs unsolved before, 6 now"));
}

TEST(Baseline, BudgetsThatOneCurveLacksAreNamed) {
  const CurveComparison comparison = compare_curves({point(10, 1), point(12, 1)}, {point(9, 1), point(12, 1)}, 0.0);
  EXPECT_THAT(comparison.compared_ms, ElementsAre(12));
  EXPECT_THAT(comparison.not_compared_ms, ElementsAre(9, 10));
  const Failure failure = test::failure_of([] { static_cast<void>(compare_curves({point(10, 1)}, {point(12, 1)}, 0.0)); });
  EXPECT_EQ(failure.word(), ErrorWord::kBadUsage);
}

TEST(Baseline, OfAnotherSceneCameraOrTargetIsRefused) {
  const CurveSubject now{"city.glb", "llvmpipe", 45.0, 512, 384};
  EXPECT_NO_THROW(require_same_subject(now, now, "a.json"));
  const auto refused = [&](const std::function<void(CurveSubject&)>& change) {
    CurveSubject before = now;
    change(before);
    const Failure failure = test::failure_of([&] { require_same_subject(before, now, "a.json"); });
    EXPECT_EQ(failure.word(), ErrorWord::kBadUsage);
    return std::string(failure.what());
  };
  EXPECT_THAT(refused([](CurveSubject& s) { s.scene = "town.glb"; }), HasSubstr("another scene: town.glb, this sweep is of city.glb"));
  EXPECT_THAT(refused([](CurveSubject& s) { s.target = "radeon"; }), HasSubstr("another target: radeon"));
  EXPECT_THAT(refused([](CurveSubject& s) { s.fov_y_deg = 60.0; }), HasSubstr("another camera: 512 x 384 pixels, 60"));
  EXPECT_THAT(refused([](CurveSubject& s) { s.width = 640; }), HasSubstr("another camera: 640"));
}

}  // namespace
}  // namespace standin
