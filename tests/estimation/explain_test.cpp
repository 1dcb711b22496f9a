#include "estimation/explain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace standin {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

FitSummary fit_with(std::initializer_list<std::pair<Term, double>> milliseconds) {
  FitSummary fit;
  for (const auto& [term, ms] : milliseconds) {
    fit.model.milliseconds_per_unit[static_cast<std::size_t>(term)] = ms;
    fit.terms.push_back({std::string(term_name(term)), ms, 0.1, false});
  }
  return fit;
}

TEST(Explain, SaysWhatCostsWhatInPicturableUnits) {
  const auto words = explain(fit_with({{Term::kDraws, 0.0021}, {Term::kTexturedPixels, 1.4e-5}, {Term::kFrame, 0.13}}));
  EXPECT_THAT(words, Contains("an empty frame costs 130 us"));
  EXPECT_THAT(words, Contains("a draw call costs 2.1 us"));
  EXPECT_THAT(words, Contains("a draw call costs as much as 150 textured pixels"));
  EXPECT_THAT(words, Contains("a million textured pixels costs 14 ms"));
}

TEST(Explain, SaysNothingOfTermsThatCostNothing) {
  for (const auto& sentence : explain(fit_with({{Term::kTexturedPixels, 1.4e-5}}))) {
    EXPECT_THAT(sentence, Not(HasSubstr("draw call")));
    EXPECT_THAT(sentence, Not(HasSubstr("nan")));
    EXPECT_THAT(sentence, Not(HasSubstr("inf")));
  }
}

TEST(Explain, OwnsUpToWhatIsUncertain) {
  FitSummary fit = fit_with({{Term::kTextureSwitches, 0.01}, {Term::kDraws, 0.002}});
  fit.terms[0].relative_standard_error = 0.8;
  EXPECT_THAT(explain(fit), Contains("a change of an impostor atlas's texture costs 10 us (+- 80 %)"));
  EXPECT_THAT(explain(fit), Contains("a draw call costs 2.0 us"));
}

TEST(Explain, SaysWhetherStagesOverlap) {
  FitSummary fit = fit_with({{Term::kFrame, 0.1}});
  EXPECT_THAT(explain(fit), Contains(HasSubstr("nothing overlaps")));
  fit.model.combination = Combination::kMax;
  EXPECT_THAT(explain(fit), Contains(HasSubstr("the slower of the two")));
}

}  // namespace
}  // namespace standin
