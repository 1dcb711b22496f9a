#include "server/sweep/acceptance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/sweep/points.h"

namespace standin {
namespace {

using nlohmann::json;
using test::point;
using testing::HasSubstr;

std::vector<Criterion> read(const char* text) {
  return acceptance_from_json(json::parse(text), "a.json");
}

std::vector<Verdict> judged(const char* text) {
  return judge(read(text), {point(10, 5000, 2), point(16, 1000)});
}

TEST(Acceptance, PassesAtTheLimitAndFailsAByteAbove) {
  EXPECT_TRUE(judged(R"([{"target": "t", "budget_ms": 16, "max_total_bytes": 1100, "max_texture_bytes": 1e3}])")[0].failures.empty());
  const auto failed = judged(R"([{"target": "t", "budget_ms": 16, "max_total_bytes": 1099}])");
  ASSERT_EQ(failed[0].failures.size(), 1U);
  EXPECT_EQ(sentence(failed[0]), "at 16 ms: failed, 1100 bytes in all, at most 1099 accepted");
  EXPECT_THAT(sentence(judged(R"([{"target": "t", "budget_ms": 16, "max_texture_bytes": 999}])")[0]), HasSubstr("1000 bytes of texture"));
}

TEST(Acceptance, UnsolvedFailsUnlessItIsPutUpWith) {
  EXPECT_THAT(sentence(judged(R"([{"target": "t", "budget_ms": 10}])")[0]), HasSubstr("2 CPVs unsolved, at most 0 accepted"));
  EXPECT_FALSE(judged(R"([{"target": "t", "budget_ms": 10, "max_unsolved": 1}])")[0].failures.empty());
  EXPECT_EQ(sentence(judged(R"([{"target": "t", "budget_ms": 10, "max_unsolved": 2}])")[0]), "at 10 ms: passed");
  EXPECT_EQ(to_json(judged(R"([{"target": "t", "budget_ms": 10}])"))[0]["passed"], false);
}

TEST(Acceptance, OnlyTheOwnTargetIsJudged) {
  const auto criteria = read(R"([{"target": "t", "budget_ms": 16}, {"target": "u", "budget_ms": 8}])");
  ASSERT_EQ(criteria_for(criteria, "t", "a.json").size(), 1U);
  const Failure failure = test::failure_of([&] { static_cast<void>(criteria_for(criteria, "v", "a.json")); });
  EXPECT_EQ(failure.word(), ErrorWord::kBadConfig);
  EXPECT_THAT(failure.what(), HasSubstr("a.json has no criterion for target v, only for t, u"));
}

TEST(Acceptance, WhatIsWrongIsNamed) {
  const std::vector<std::pair<const char*, const char*>> rows = {
      {"{}", "not a list"},
      {"[]", "at least one"},
      {"[3]", "[0] = 3 violates: an object"},
      {R"([{"budget_ms": 16}])", "[0] lacks \"target\""},
      {R"([{"target": "t"}])", "[0] lacks \"budget_ms\""},
      {R"([{"target": "t", "budget_ms": 16}, {"target": "t", "budget_ms": 0}])", "[1].budget_ms = 0 violates: a number > 0"},
      {R"([{"target": "t", "budget_ms": "16"}])", "[0].budget_ms = \"16\""},
      {R"([{"target": "", "budget_ms": 16}])", "[0].target"},
      {R"([{"target": "t", "budget_ms": 16, "max_bytes": 3}])", "[0].max_bytes = 3 is not a known key"},
      {R"([{"target": "t", "budget_ms": 16, "max_total_bytes": -1}])", "[0].max_total_bytes = -1"},
      {R"([{"target": "t", "budget_ms": 16, "max_unsolved": 0.5}])", "[0].max_unsolved = 0.5 violates: a whole number"}};
  for (const auto& [text, sentence] : rows) {
    const Failure failure = test::failure_of([&, given = text] { static_cast<void>(read(given)); });
    EXPECT_EQ(failure.word(), ErrorWord::kBadConfig) << text;
    EXPECT_THAT(failure.what(), HasSubstr(sentence)) << text;
  }
}

}  // namespace
}  // namespace standin
