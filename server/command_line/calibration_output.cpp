#include "server/command_line/calibration_output.h"

#include <cmath>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "estimation/explain.h"
#include "estimation/learning_curve_json.h"
#include "estimation/self_test.h"

namespace standin {
namespace {

using nlohmann::json;

json terms_json(const std::vector<FittedTerm>& terms) {
  json list = json::array();
  for (const auto& term : terms)
    list.push_back({{"name", term.name},
                    {"milliseconds_per_unit", term.milliseconds_per_unit},
                    {"relative_standard_error", term.relative_standard_error ? json(*term.relative_standard_error) : json()},
                    {"at_bound", term.at_bound}});
  return list;
}

json null_if_infinite(double number) {
  return std::isfinite(number) ? json(number) : json();
}

json covariance_json(const FitSummary& fit) {
  json matrix = json::array();
  for (std::size_t i = 0; i < fit.terms.size(); ++i) {
    json row = json::array();
    for (std::size_t j = 0; j < fit.terms.size(); ++j) row.push_back(null_if_infinite(fit.relative_covariance[i * fit.terms.size() + j]));
    matrix.push_back(row);
  }
  return matrix;
}

json fit_json(const FitSummary& fit, const std::vector<LearningPoint>& curve) {
  json terms = json::object();
  for (std::size_t i = 0; i < kTermCount; ++i) terms[std::string(term_name(static_cast<Term>(i)))] = fit.model.milliseconds_per_unit[i];
  return {{"stopped", fit.stopped},
          {"frames", fit.frames},
          {"unsteady_frames", fit.unsteady_frames},
          {"held_out_frames", fit.held_out_frames},
          {"misses", fit.misses},
          {"median_error", fit.median_error},
          {"p90_error", fit.p90_error},
          {"coverage", fit.measured_coverage},
          {"bound_over_measured_median", fit.bound_over_measured_median},
          {"milliseconds_per_unit", terms},
          {"combination", fit.model.combination == Combination::kSum ? "sum" : "max"},
          {"sum_error", fit.sum_error},
          {"max_error", fit.max_error},
          {"condition_number", null_if_infinite(fit.condition_number)},
          {"terms", terms_json(fit.terms)},
          {"relative_covariance", covariance_json(fit)},
          {"left_out", fit.left_out},
          {"learning_curve", learning_curve_json(curve)},
          {"warnings", fit.warnings},
          {"explanation", explain(fit)}};
}

void print_unsteady(std::uint32_t frames) {
  if (frames > 0) std::printf("%u more were passed over: their repeats disagree\n", frames);
}

void print_fit_text(const FitSummary& fit, const std::vector<LearningPoint>& curve) {
  std::printf(
      "%u frames, of which %u held out: median error %.1f %%, p90 %.1f %%, the bound covers %.2f %% and is %.2fx the measured time at the "
      "median\n",
      fit.frames, fit.held_out_frames, 100 * fit.median_error, 100 * fit.p90_error, 100 * fit.measured_coverage,
      fit.bound_over_measured_median);
  print_unsteady(fit.unsteady_frames);
  for (const LearningPoint& point : curve)
    std::printf("  after %5.1f s: %4u frames, median error %4.1f %%, p90 %4.1f %%, covered %5.1f %%, bound over measured %.2f\n",
                point.seconds, point.frames, 100 * point.median_error, 100 * point.p90_error, 100 * point.coverage,
                point.bound_over_measured_median);
  if (fit.model.combination == Combination::kMax)
    std::printf("geometry and fill overlap: the error is %.1f %% where they add up, %.1f %% where the longer one counts\n",
                100 * fit.sum_error, 100 * fit.max_error);
  for (const auto& reason : fit.left_out) std::printf("  left out: %s\n", reason.c_str());
  for (const auto& warning : fit.warnings) std::printf("  warning: %s\n", warning.c_str());
}

}  // namespace

void print_fit(const FitSummary& fit, const std::vector<LearningPoint>& curve, bool with_explanation, bool as_json) {
  if (as_json) {
    std::cout << fit_json(fit, curve).dump(2) << "\n";
    return;
  }
  print_fit_text(fit, curve);
  if (!with_explanation) return;
  for (const auto& sentence : explain(fit)) std::printf("%s\n", sentence.c_str());
}

void print_evaluation(const Evaluation& evaluation, double coverage, bool as_json) {
  const std::uint32_t allowed = most_misses(evaluation.frames, coverage);
  if (as_json) {
    const json object = {{"frames", evaluation.frames},
                         {"unsteady_frames", evaluation.unsteady_frames},
                         {"median_error", evaluation.median_error},
                         {"p90_error", evaluation.p90_error},
                         {"coverage", evaluation.coverage},
                         {"misses", evaluation.misses},
                         {"most_misses", allowed},
                         {"bound_over_measured_median", evaluation.bound_over_measured_median}};
    std::cout << object.dump(2) << "\n";
    return;
  }
  std::printf(
      "%u frames: median error %.1f %%, p90 %.1f %%; %u above the bound (%u would speak against its %.3g %%), which is %.2fx the measured "
      "time at the median\n",
      evaluation.frames, 100 * evaluation.median_error, 100 * evaluation.p90_error, evaluation.misses, allowed + 1, 100 * coverage,
      evaluation.bound_over_measured_median);
  print_unsteady(evaluation.unsteady_frames);
}

// A table for people (Markdown), or JSON.
std::size_t print_self_test(bool as_json) {
  json rows = json::array();
  std::size_t failed = 0;
  if (!as_json) std::printf("| case | expected | got | |\n|---|---|---|---|\n");
  for (const auto& test_case : self_test_cases()) {
    const SelfTestOutcome outcome = run_self_test(test_case);
    failed += outcome.passed ? 0 : 1;
    rows.push_back({{"name", test_case.name}, {"expected", test_case.expected}, {"got", outcome.got}, {"passed", outcome.passed}});
    if (!as_json)
      std::printf("| %s | %s | %s | %s |\n", test_case.name.c_str(), test_case.expected.c_str(), outcome.got.c_str(),
                  outcome.passed ? "ok" : "FAILED");
  }
  if (as_json) std::cout << json({{"cases", rows}, {"passed", rows.size() - failed}, {"failed", failed}}).dump(2) << "\n";
  return failed;
}

}  // namespace standin
