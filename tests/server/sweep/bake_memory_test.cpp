#include "server/job/bake_memory.h"

#include <gtest/gtest.h>

namespace standin {
namespace {

Candidate request() {
  Candidate candidate;
  candidate.objects = {3, 5};
  candidate.view_cell = Shaft{.apex = {1, 2, 3}, .tan_half = {0.25, 0.5}, .min_distance_m = 9.0};
  return candidate;
}

Impostor impostor_of(std::uint32_t object) {
  Impostor impostor;
  impostor.objects = {object};
  return impostor;
}

TEST(BakeMemory, RecallsWhatWasAskedForInTheSameWordsOnly) {
  BakeMemory memory;
  memory.keep(request(), impostor_of(7));
  ASSERT_TRUE(memory.recall(request()).has_value());
  EXPECT_EQ(memory.recall(request())->value().objects.front(), 7U);
  std::vector<Candidate> others(6, request());
  others[0].technique = Technique::kPlanar;
  others[1].objects = {3};
  std::get<Shaft>(others[2].view_cell).min_distance_m = 9.5;
  std::get<Shaft>(others[3].view_cell).tan_half.y = 0.25;
  std::get<Shaft>(others[4].view_cell).apex.z = 4;
  others[5].view_cell = Box{{0, 0, 0}, {1, 1, 1}};
  for (const Candidate& other : others) EXPECT_FALSE(memory.recall(other).has_value());
  Candidate elsewhere = request();  // what was estimated, and for which cells, does not matter
  elsewhere.cells = {4};
  elsewhere.bytes = 3.0;
  elsewhere.node = 8;
  EXPECT_TRUE(memory.recall(elsewhere).has_value());
}

TEST(BakeMemory, ThatThereIsNoneIsKnownToo) {
  BakeMemory memory;
  memory.keep(request(), std::nullopt);
  const auto known = memory.recall(request());
  ASSERT_TRUE(known.has_value());
  EXPECT_FALSE(known->has_value());
}

TEST(BakeMemory, ForgetsWhatTheLastTwoJobsDidNotAskFor) {
  BakeMemory memory;
  memory.keep(request(), impostor_of(7));
  memory.begin_job();
  EXPECT_TRUE(memory.recall(request()).has_value());
  memory.begin_job();
  EXPECT_TRUE(memory.recall(request()).has_value()) << "asked for in the job before";
  memory.begin_job();
  memory.begin_job();
  EXPECT_FALSE(memory.recall(request()).has_value());
  EXPECT_EQ(memory.kept(), 1U);
  EXPECT_EQ(memory.recalled(), 2U);
}

}  // namespace
}  // namespace standin
