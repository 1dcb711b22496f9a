#include "estimation/fit_warnings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

namespace standin {
namespace {

constexpr double kFramesPerTerm = 10.0;
constexpr double kIllConditioned = 1e6;
constexpr double kInTheMixture = 0.2;  // share of the weakest direction from which a term is named
constexpr double kCoarseStep = 0.01;   // of the median time
constexpr double kMostOutliers = 0.1;
constexpr double kOutlierScales = 3.0;
constexpr double kLeastOutlier = 0.1;      // a machine steadier than this has no outliers worth a word
constexpr std::size_t kLeastRun = 20;      // frames on either side of a change of speed
constexpr double kLeastSpeedStep = 0.1;    // of the logarithm
constexpr double kSpeedEvidence = 8.0;     // standard errors
constexpr double kScaleOfMedian = 1.4826;  // median of |x| to standard deviation, for a normal x

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double spread(std::vector<double> values) {
  const double centre = median(values);
  for (double& value : values) value = std::abs(value - centre);
  return kScaleOfMedian * median(std::move(values));
}

template <typename... Values>
std::string text(const char* format, Values... values) {
  std::array<char, 400> line{};
  std::snprintf(line.data(), line.size(), format, values...);
  return line.data();
}

std::optional<std::string> few_frames(std::size_t frames, std::size_t terms) {
  if (static_cast<double>(frames) >= kFramesPerTerm * static_cast<double>(terms)) return std::nullopt;
  return text("%zu frames are few for %zu terms: let it time more (--seconds), at least 10 frames a term", frames, terms);
}

std::optional<std::string> ill_conditioned(const FittedForm& fitted) {
  if (fitted.fit.condition_number <= kIllConditioned) return std::nullopt;
  std::string names;
  for (std::size_t k = 0; k < fitted.terms.size(); ++k)
    if (std::abs(fitted.fit.weakest_direction[k]) > kInTheMixture)
      names += (names.empty() ? "" : ", ") + std::string(term_name(static_cast<Term>(fitted.terms[k])));
  return text("the frames hardly tell apart %s (condition number %.1e): add scenes in which they differ", names.c_str(),
              fitted.fit.condition_number);
}

std::optional<std::string> coarse_times(const std::vector<TimedFrame>& frames) {
  std::vector<double> times;
  times.reserve(frames.size());
  for (const TimedFrame& frame : frames) times.push_back(frame.milliseconds);
  const double middle = median(times);
  std::sort(times.begin(), times.end());
  double step = 0.0;
  for (std::size_t i = 1; i < times.size(); ++i)
    if (const double gap = times[i] - times[i - 1]; gap > 1e-9 * times[i] && (step == 0.0 || gap < step)) step = gap;
  if (!(step > kCoarseStep * middle)) return std::nullopt;
  for (const double time : times)
    if (std::abs(time / step - std::round(time / step)) > 1e-3) return std::nullopt;
  return text("times come in steps of %.3g ms, %.0f %% of the median frame: time with a finer clock, or larger frames", step,
              100.0 * step / middle);
}

struct SpeedStep {
  std::size_t first = 0;  // of the frames after it
  double ratio = 1.0;
};

/// The likeliest place of a step in the level of `logs`: where the sums on both sides differ most (values far off cut short).
std::size_t likeliest_step(const std::vector<double>& logs) {
  const double centre = median(logs), limit = kOutlierScales * spread(logs);
  const auto n = static_cast<double>(logs.size());
  double total = 0.0;
  std::vector<double> sums;
  sums.reserve(logs.size());
  for (const double value : logs) sums.push_back(total += std::clamp(value - centre, -limit, limit));
  std::size_t best = kLeastRun;
  double greatest = 0.0;
  for (std::size_t k = kLeastRun; k + kLeastRun <= logs.size(); ++k) {
    const auto left = static_cast<double>(k);
    const double difference = std::abs(sums[k - 1] - left / n * total) / std::sqrt(left * (n - left));
    if (difference > greatest) greatest = difference, best = k;
  }
  return best;
}

/// A step between the medians of two runs, if it is plain beside the spread within them.
std::optional<SpeedStep> speed_step(const std::vector<double>& logs) {
  if (logs.size() < 2 * kLeastRun) return std::nullopt;
  const std::size_t at = likeliest_step(logs);
  const auto border = logs.begin() + static_cast<std::ptrdiff_t>(at);
  const double before = median({logs.begin(), border}), after = median({border, logs.end()});
  std::vector<double> within = logs;
  for (std::size_t i = 0; i < within.size(); ++i) within[i] -= i < at ? before : after;
  const double error = spread(std::move(within)) * std::sqrt(1.0 / static_cast<double>(at) + 1.0 / static_cast<double>(logs.size() - at));
  if (!(std::abs(after - before) > std::max(kLeastSpeedStep, kSpeedEvidence * error))) return std::nullopt;
  return SpeedStep{at, std::exp(after - before)};
}

/// Scene by scene: one that the model takes for too cheap is no change of speed. Nearly empty frames do not matter to the fit, nor here.
std::optional<std::string> two_speeds(const std::vector<TimedFrame>& frames, const TimeModel& model) {
  std::map<std::uint32_t, std::vector<std::size_t>> by_scene;
  for (std::size_t row = 0; row < frames.size(); ++row)
    if (frames[row].milliseconds > kSmallFrameMs && model.predicted_ms(frames[row].features) > 0.0)
      by_scene[frames[row].group].push_back(row);
  for (const auto& [group, rows] : by_scene) {
    std::vector<double> logs;
    for (const std::size_t row : rows) logs.push_back(std::log(frames[row].milliseconds / model.predicted_ms(frames[row].features)));
    if (const auto step = speed_step(logs))
      return text("from frame %zu on the machine was %.2fx as slow as before: time again with other programs and power saving off",
                  rows[step->first], step->ratio);
  }
  return std::nullopt;
}

std::optional<std::string> many_outliers(const std::vector<TimedFrame>& frames, const TimeModel& model) {
  std::vector<double> errors;
  errors.reserve(frames.size());
  for (const TimedFrame& frame : frames)
    errors.push_back(std::abs(model.predicted_ms(frame.features) - frame.milliseconds) / (frame.milliseconds + kSmallFrameMs));
  const double limit = std::max(kLeastOutlier, kOutlierScales * kScaleOfMedian * median(errors));
  const auto outliers = static_cast<double>(std::count_if(errors.begin(), errors.end(), [=](double error) { return error > limit; }));
  const double share = outliers / static_cast<double>(frames.size());
  if (!(share > kMostOutliers)) return std::nullopt;
  return text("%.0f %% of the frames are off by more than %.0f %%, far more than the others: time again with other programs closed",
              100.0 * share, 100.0 * limit);
}

}  // namespace

std::vector<std::string> fit_warnings(const std::vector<TimedFrame>& frames, const FittedForm& fitted) {
  std::vector<std::string> warnings;
  for (const auto& warning : {few_frames(frames.size(), fitted.terms.size()), ill_conditioned(fitted), coarse_times(frames),
                              two_speeds(frames, fitted.model), many_outliers(frames, fitted.model)})
    if (warning) warnings.push_back(*warning);
  return warnings;
}

}  // namespace standin
