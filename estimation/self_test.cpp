#include "estimation/self_test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "estimation/self_test_frames.h"
#include "render/base/error.h"

namespace standin {
namespace {

using namespace self_test;

constexpr double kCoverage = 0.99;
using Frames = std::vector<TimedFrame>;
using Columns = std::vector<std::vector<double>>;

template <typename... Values>
std::string text(const char* format, Values... values) {
  std::array<char, 600> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  return line.data();
}

std::string name_of(std::size_t term) {
  return std::string(term_name(static_cast<Term>(term)));
}

/// The first sentence that begins with `start`, or holds it, else nothing.
std::string sentence_with(const std::vector<std::string>& sentences, const std::string& start) {
  for (const std::string& sentence : sentences)
    if (sentence.find(start) != std::string::npos) return sentence;
  return "";
}

std::string all_of(const std::vector<std::string>& sentences) {
  std::string joined;
  for (const std::string& sentence : sentences) joined += (joined.empty() ? "" : "; ") + sentence;
  return joined.empty() ? "none" : joined;
}

/// Times as `change(exact milliseconds, row)`.
Frames frames_with(std::uint64_t seed, std::size_t count, const std::function<double(double, std::size_t)>& change) {
  Frames frames = exact_frames(seed, count);
  for (std::size_t row = 0; row < count; ++row) frames[row].milliseconds = change(frames[row].milliseconds, row);
  return frames;
}

Frames noisy_frames(std::uint64_t seed, std::size_t count, double noise) {
  return frames_with(seed, count, [=](double ms, std::size_t row) {
    Rng rng(seed + 1000, row);
    return ms * std::exp(noise * normal(rng));
  });
}

SelfTestOutcome within(const char* what, double error, double limit) {
  return {text("%s %.1e", what, error), error <= limit};
}

SelfTestOutcome coefficients_within(const Frames& frames, double limit) {
  return within("greatest coefficient error", coefficient_error(fit_time_model(frames, kCoverage).model, true_model()), limit);
}

/// As `outcome`, and a warning that holds `words` is given.
SelfTestOutcome with_warning(SelfTestOutcome outcome, const FitSummary& fit, const std::string& words) {
  const std::string warning = sentence_with(fit.warnings, words);
  outcome.passed = outcome.passed && !warning.empty();
  outcome.got += "; warned: " + (warning.empty() ? all_of(fit.warnings) : warning);
  return outcome;
}

SelfTestOutcome refused(const Frames& frames, const std::string& words) {
  try {
    (void)fit_time_model(frames, kCoverage);
  } catch (const Failure& failure) {
    return {failure.what(), failure.word() == ErrorWord::kBadUsage && std::string(failure.what()).find(words) != std::string::npos};
  }
  return {"a model", false};
}

// ---- columns ----

SelfTestOutcome duplicate_features() {
  Frames frames = exact_frames(1, 300);
  for (TimedFrame& frame : frames) {
    frame.features.value[2] = frame.features.value[1];
    frame.milliseconds = true_model().predicted_ms(frame.features);
  }
  const FitSummary fit = fit_time_model(frames, kCoverage);
  const std::string named = sentence_with(fit.left_out, name_of(2) + ":");
  return {text("median error %.1e; left out: %s", fit.median_error, all_of(fit.left_out).c_str()),
          fit.median_error <= 1e-9 && fit.left_out.size() == 1 && !named.empty()};
}

SelfTestOutcome duplicate_columns_in_the_fit() {
  const auto a = random_column(2, 100, 0.1, 1.0), b = random_column(3, 100, 0.1, 1.0);
  const FitProblem problem = problem_of_columns({a, a, b}, {2.0, 3.0, 1.0});
  const FitResult fit = fit_robustly(problem, {});
  const double sum = fit.milliseconds_per_unit[0] + fit.milliseconds_per_unit[1];
  return {text("predictions within %.1e, the two sum to 5 within %.1e", prediction_error(problem, fit), std::abs(sum / 5.0 - 1.0)),
          prediction_error(problem, fit) <= 1e-12 && std::abs(sum / 5.0 - 1.0) <= 1e-12};
}

SelfTestOutcome collinear_features() {
  Frames frames = exact_frames(4, 300);
  for (TimedFrame& frame : frames) {
    frame.features.value[3] = 2.0 * frame.features.value[1] + 0.5 * frame.features.value[2] + 3.0;
    frame.milliseconds = true_model().predicted_ms(frame.features);
  }
  const FitSummary fit = fit_time_model(frames, kCoverage);
  return {text("median error %.1e; left out: %s", fit.median_error, all_of(fit.left_out).c_str()),
          fit.median_error <= 1e-9 && fit.left_out.size() == 1 && !sentence_with(fit.left_out, name_of(3) + ":").empty()};
}

SelfTestOutcome nearly_collinear_features() {
  Frames frames = exact_frames(5, 300);
  for (std::size_t row = 0; row < frames.size(); ++row) {
    Rng rng(5, 10'000 + row);
    frames[row].features.value[2] = frames[row].features.value[1] * (1.0 + 4e-6 * rng.uniform());
    frames[row].milliseconds = true_model().predicted_ms(frames[row].features);
  }
  const FitSummary fit = fit_time_model(frames, kCoverage);
  return with_warning(within("median error", fit.median_error, 1e-9), fit, name_of(1) + ", " + name_of(2));
}

SelfTestOutcome scales_far_apart() {
  const std::vector<double> costs = {2e9, 3e-9, 0.5};
  const FitProblem problem =
      problem_of_columns({random_column(6, 200, 0.0, 1e-9), random_column(7, 200, 0.0, 1e9), std::vector<double>(200, 1.0)}, costs);
  return within("greatest coefficient error", coefficient_error(fit_robustly(problem, {}), costs), 1e-10);
}

SelfTestOutcome constant_column() {
  Frames frames = exact_frames(8, 300);
  for (TimedFrame& frame : frames) {
    frame.features.value[1] = 40.0;
    frame.milliseconds = true_model().predicted_ms(frame.features);
  }
  const FitSummary fit = fit_time_model(frames, kCoverage);
  return {text("median error %.1e; left out: %s", fit.median_error, all_of(fit.left_out).c_str()),
          fit.median_error <= 1e-9 && fit.left_out.size() == 1 && !sentence_with(fit.left_out, name_of(1) + ":").empty()};
}

// ---- rows ----

SelfTestOutcome fewer_rows_than_terms_in_the_fit() {
  Columns columns;
  for (std::uint64_t j = 0; j < 8; ++j) columns.push_back(random_column(10 + j, 5, 0.1, 1.0));
  const FitProblem problem = problem_of_columns(columns, std::vector<double>(8, 1.0));
  const FitResult fit = fit_robustly(problem, {});
  const auto errors = std::count_if(fit.relative_standard_error.begin(), fit.relative_standard_error.end(),
                                    [](double error) { return std::isfinite(error); });
  return {text("predictions within %.1e, %d standard errors", prediction_error(problem, fit), static_cast<int>(errors)),
          prediction_error(problem, fit) <= 1e-9 && errors == 0};
}

SelfTestOutcome few_frames() {
  const FitSummary fit = fit_time_model(noisy_frames(20, 3 * kTermCount, 0.01), kCoverage);
  return with_warning(within("median error", fit.median_error, 0.1), fit, "frames are few");
}

SelfTestOutcome all_frames_equal() {
  const Frames frames(30, exact_frames(21, 1)[0]);
  const FitSummary fit = fit_time_model(frames, kCoverage);
  const double error = std::abs(fit.model.predicted_ms(frames[0].features) / frames[0].milliseconds - 1.0);
  return {text("predicts it within %.1e; %zu of %zu terms left out and named", error, fit.left_out.size(), kTermCount),
          error <= 1e-9 && fit.left_out.size() == kTermCount - 1};
}

SelfTestOutcome outliers() {
  const Frames frames = frames_with(22, 500, [](double ms, std::size_t row) { return row % 5 == 2 ? 10.0 * ms : ms; });
  const FitSummary fit = fit_time_model(frames, kCoverage);
  return with_warning(within("greatest coefficient error", coefficient_error(fit.model, true_model()), 0.02), fit, "20 % of the frames");
}

SelfTestOutcome outliers_in_noise() {
  Frames frames = noisy_frames(23, 1000, 0.03);
  for (std::size_t row = 0; row < frames.size(); row += 5) frames[row].milliseconds *= 10.0;
  return coefficients_within(frames, 0.1);
}

// ---- times ----

SelfTestOutcome quantised_times() {
  const Frames frames = frames_with(30, 500, [](double ms, std::size_t) { return std::max(1e-3, std::round(1e3 * ms) / 1e3); });
  return coefficients_within(frames, 1e-3);
}

SelfTestOutcome quantised_short_times() {
  TimeModel truth = true_model();
  for (double& cost : truth.milliseconds_per_unit) cost *= 0.01;
  Frames frames = exact_frames(31, 500, truth);
  for (TimedFrame& frame : frames) frame.milliseconds = std::max(1e-3, std::round(1e3 * frame.milliseconds) / 1e3);
  const FitSummary fit = fit_time_model(frames, kCoverage);
  return with_warning(within("median error", fit.median_error, 0.03), fit, "steps of 0.001 ms");
}

/// Frames from 10 us to 100 s; `noise` is relative.
Frames seven_decades(std::uint64_t seed, double noise) {
  TimeModel truth = true_model();
  truth.milliseconds_per_unit[static_cast<std::size_t>(Term::kFrame)] = 0.005;
  Frames frames = exact_frames(seed, 700, truth);
  for (std::size_t row = 0; row < frames.size(); ++row) {
    Rng rng(seed, 10'000 + row);
    TimedFrame& frame = frames[row];
    const double wanted_ms = row == 0 ? 0.01 : row == 1 ? 1e5 : std::pow(10.0, rng.uniform(-2.0, 5.0));
    const double scale = (wanted_ms - 0.005) / (frame.milliseconds - 0.005);
    for (double& value : frame.features.value) value *= scale;
    frame.features[Term::kFrame] = 1.0;
    frame.milliseconds = truth.predicted_ms(frame.features) * std::exp(noise * normal(rng));
  }
  return frames;
}

SelfTestOutcome exact_decades() {
  TimeModel truth = true_model();
  truth.milliseconds_per_unit[static_cast<std::size_t>(Term::kFrame)] = 0.005;
  return within("greatest coefficient error", coefficient_error(fit_time_model(seven_decades(32, 0.0), kCoverage).model, truth), 1e-8);
}

SelfTestOutcome noisy_decades() {
  TimeModel truth = true_model();
  truth.milliseconds_per_unit[static_cast<std::size_t>(Term::kFrame)] = 0.005;
  const FitSummary fit = fit_time_model(seven_decades(33, 0.03), kCoverage);
  double worst = 0.0;  // of frames whose time matters
  for (const TimedFrame& frame : seven_decades(34, 0.0))
    if (frame.milliseconds > 1.0) worst = std::max(worst, std::abs(fit.model.predicted_ms(frame.features) / frame.milliseconds - 1.0));
  return within("greatest error on fresh frames above 1 ms", worst, 0.05);
}

SelfTestOutcome growing_noise() {
  const Frames frames = frames_with(35, 800, [](double ms, std::size_t row) {
    Rng rng(35, 10'000 + row);
    return ms * std::exp(std::min(0.3, 0.02 + 0.02 * ms) * normal(rng));
  });
  const FitSummary fit = fit_time_model(frames, kCoverage);
  SelfTestOutcome outcome = within("greatest coefficient error", coefficient_error(fit.model, true_model()), 0.15);
  outcome.got += text("; covers %.1f %%", 100.0 * fit.measured_coverage);
  outcome.passed = outcome.passed && fit.measured_coverage >= 0.97;
  return outcome;
}

SelfTestOutcome wants_to_be_negative() {
  const TimeModel truth = true_model();
  Frames frames = exact_frames(36, 400);
  for (TimedFrame& frame : frames)
    frame.milliseconds = std::max(0.05, frame.milliseconds - 1.5 * truth.milliseconds_per_unit[1] * frame.features.value[1]);
  const FitSummary fit = fit_time_model(frames, kCoverage);
  const double least = *std::min_element(fit.model.milliseconds_per_unit.begin(), fit.model.milliseconds_per_unit.end());
  return {text("coefficient %g, least of all %g; left out: %s", fit.model.milliseconds_per_unit[1], least, all_of(fit.left_out).c_str()),
          fit.model.milliseconds_per_unit[1] == 0.0 && least >= 0.0 && !sentence_with(fit.left_out, name_of(1) + ":").empty()};
}

SelfTestOutcome refused_time(double bad) {
  Frames frames = exact_frames(37, 50);
  frames[17].milliseconds = bad;
  return refused(frames, "frame 17: its time");
}

SelfTestOutcome refused_feature(double bad) {
  Frames frames = exact_frames(38, 50);
  frames[3].features.value[1] = bad;
  return refused(frames, "frame 3: feature " + name_of(1));
}

SelfTestOutcome change_of_speed() {
  Frames frames = noisy_frames(39, 500, 0.03);
  for (std::size_t row = 240; row < frames.size(); ++row) frames[row].milliseconds *= 1.4;
  const FitSummary fit = fit_time_model(frames, kCoverage);
  SelfTestOutcome outcome = with_warning({text("median error %.2f", fit.median_error), fit.median_error < 0.25}, fit, "as slow as before");
  std::size_t at = 0;
  double ratio = 0.0;
  std::sscanf(sentence_with(fit.warnings, "as slow as before").c_str(), "from frame %zu on the machine was %lfx", &at, &ratio);
  outcome.passed = outcome.passed && at >= 230 && at <= 250 && std::abs(ratio / 1.4 - 1.0) < 0.1;
  return outcome;
}

// ---- models ----

/// Geometry and fill cost about the same, so that either may be the longer.
SelfTestOutcome stages(Combination combination) {
  TimeModel truth = true_model();
  truth.combination = combination;
  std::array<double, 3> of_stage{};
  for (std::size_t i = 0; i < kTermCount; ++i)
    of_stage[static_cast<std::size_t>(stage_of(static_cast<Term>(i)))] += truth.milliseconds_per_unit[i] * feature_scale(i);
  for (std::size_t i = 0; i < kTermCount; ++i)
    if (stage_of(static_cast<Term>(i)) == Stage::kFill) truth.milliseconds_per_unit[i] *= of_stage[1] / of_stage[2];
  Frames frames = exact_frames(40, 500, truth);
  Rng rng(40);
  for (TimedFrame& frame : frames) frame.milliseconds *= std::exp(0.03 * normal(rng));
  const FitSummary fit = fit_time_model(frames, kCoverage);
  return {text("%s; mean error %.3f as a sum, %.3f as a maximum", fit.model.combination == Combination::kSum ? "sum" : "maximum",
               fit.sum_error, fit.max_error),
          fit.model.combination == combination};
}

SelfTestOutcome gradients() {
  Columns columns;
  for (std::uint64_t j = 0; j < 6; ++j) columns.push_back(random_column(50 + j, 40, 0.5, 1.0));
  FitProblem problem = problem_of_columns(columns, std::vector<double>(6, 1.0));
  Rng rng(50);
  for (double& ms : problem.milliseconds) ms *= std::exp(0.2 * normal(rng));
  problem.stages = {Stage::kShared, Stage::kGeometry, Stage::kGeometry, Stage::kFill, Stage::kFill, Stage::kFill};
  const bool sum = gradients_agree(problem, Combination::kSum, std::vector<double>(6, 0.9), 1e-6);
  const bool max = gradients_agree(problem, Combination::kMax, {0.9, 0.3, 0.3, 0.9, 0.9, 0.9}, 1e-6);
  return {text("sum %s, maximum %s", sum ? "agrees" : "differs", max ? "agrees" : "differs"), sum && max};
}

}  // namespace

std::vector<SelfTestCase> self_test_cases() {
  const double inf = std::numeric_limits<double>::infinity(), nan = std::nan("");
  return {
      {"duplicate features", "the second is named in left_out; held-out error <= 1e-9", duplicate_features},
      {"duplicate columns, in the fit itself", "predictions within 1e-12, the two coefficients share the cost",
       duplicate_columns_in_the_fit},
      {"a feature that is a combination of others", "it is named in left_out; held-out error <= 1e-9", collinear_features},
      {"features alike to 4e-6", "held-out error <= 1e-9; a warning names both", nearly_collinear_features},
      {"columns of scale 1e-9 and 1e9", "coefficients within 1e-10", scales_far_apart},
      {"a constant column", "it is named in left_out, as the frame's own cost; held-out error <= 1e-9", constant_column},
      {"5 rows, 8 terms, in the fit itself", "predictions within 1e-9, no standard errors", fewer_rows_than_terms_in_the_fit},
      {"fewer frames than terms", "refused: at least 20 timed frames",
       [] { return refused(exact_frames(9, kTermCount - 2), "at least 20 timed frames"); }},
      {"one frame", "refused: at least 20 timed frames",
       [] { return refused(exact_frames(9, 1), "at least 20 timed frames, there are 1"); }},
      {"no frame", "refused: at least 20 timed frames", [] { return refused({}, "at least 20 timed frames, there are 0"); }},
      {"three frames a term", "held-out median error <= 0.1 at 1 % noise; a warning asks for more frames", few_frames},
      {"all frames equal", "predicts that time within 1e-9; all terms but one named in left_out", all_frames_equal},
      {"20 % outliers at 10x", "coefficients within 2 %; a warning states their share", outliers},
      {"20 % outliers at 10x in 3 % noise", "coefficients within 10 %", outliers_in_noise},
      {"times in steps of 1 us, frames of 0.3 to 20 ms", "coefficients within 1e-3", quantised_times},
      {"times in steps of 1 us, frames of 3 to 200 us", "held-out median error <= 3 %; a warning states the step", quantised_short_times},
      {"frames from 10 us to 100 s, exact", "coefficients within 1e-8", exact_decades},
      {"frames from 10 us to 100 s, 3 % noise", "fresh frames above 1 ms within 5 %", noisy_decades},
      {"noise that grows with size, 2 % to 30 %", "coefficients within 15 %; the bound covers >= 97 % held out", growing_noise},
      {"a term that wants to be negative", "it is exactly 0 and named in left_out; none is negative", wants_to_be_negative},
      {"a time that is NaN", "refused, naming frame 17", [nan] { return refused_time(nan); }},
      {"a time that is infinite", "refused, naming frame 17", [inf] { return refused_time(inf); }},
      {"a time of zero", "refused, naming frame 17", [] { return refused_time(0.0); }},
      {"a negative time", "refused, naming frame 17", [] { return refused_time(-1.0); }},
      {"a feature that is NaN", "refused, naming frame 3 and the feature", [nan] { return refused_feature(nan); }},
      {"a negative feature", "refused, naming frame 3 and the feature", [] { return refused_feature(-1.0); }},
      {"1.4x slower from frame 240 of 500 on", "a warning states the place within 10 frames and the ratio within 10 %", change_of_speed},
      {"stages that add up, 3 % noise", "the sum is chosen", [] { return stages(Combination::kSum); }},
      {"stages that overlap, 3 % noise", "the maximum is chosen", [] { return stages(Combination::kMax); }},
      {"derivatives of the cost functions", "Ceres' gradient checker agrees within 1e-6", gradients},
  };
}

SelfTestOutcome run_self_test(const SelfTestCase& test_case) {
  try {
    return test_case.run();
  } catch (const std::exception& error) {
    return {std::string("failed: ") + error.what(), false};
  }
}

}  // namespace standin
