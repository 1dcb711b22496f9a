// How good the time model is on scenes it has not seen, from saved samples (`calibrate --samples`, `calibrate --evaluate --samples`),
// beside two floors: the same frames timed twice, and a model that is told the pixels which the device counted. Results: time_model.md.
//
//   time_model TRAIN.csv NAME=TEST.csv ... [again NAME=SAME.csv ...]
#include <algorithm>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "estimation/calibrate.h"
#include "estimation/samples_file.h"

namespace {

using namespace standin;
using Frames = std::vector<TimedFrame>;

constexpr double kLeastFrame_ms = 1.0;  // shorter frames turn no placement

Frames long_frames(const Frames& frames) {
  Frames kept;
  for (const TimedFrame& frame : frames)
    if (frame.milliseconds >= kLeastFrame_ms) kept.push_back(frame);
  return kept;
}

Frames first_seconds(const Frames& frames, double seconds) {
  Frames first;
  for (const TimedFrame& frame : frames)
    if (frame.seconds <= seconds) first.push_back(frame);
  return first;
}

/// Samples in milliseconds of the reference frame that the training's are in.
Frames frames_of(const std::string& file, double reference_ms) {
  CalibrationSamples samples = read_samples(file);
  for (TimedFrame& frame : samples.frames) frame.milliseconds *= reference_ms / samples.machine.reference_ms;
  return samples.frames;
}

/// Frames of originals alone, their pixel terms scaled to what passed in the device.
Frames with_counted_pixels(const Frames& frames) {
  Frames told;
  for (TimedFrame frame : frames) {
    if (frame.features[Term::kImpostorPixels] > 0.0) continue;
    double estimated = 0.0;
    for (std::size_t i = 0; i < kTermCount; ++i)
      if (is_pixel_term(static_cast<Term>(i))) estimated += frame.features.value[i];
    for (std::size_t i = 0; i < kTermCount; ++i)
      if (is_pixel_term(static_cast<Term>(i)) && estimated > 0.0) frame.features.value[i] *= frame.passed_pixels / estimated;
    told.push_back(frame);
  }
  return told;
}

void print(const std::string& name, const TimeModel& model, const Frames& frames) {
  if (frames.empty()) return;
  const Evaluation e = evaluate(model, frames);
  std::printf("| %s | %u | %.1f %% | %.1f %% | %u (%u) | %.2f |\n", name.c_str(), e.frames, 100 * e.median_error, 100 * e.p90_error,
              e.misses, most_misses(e.frames, model.coverage), e.bound_over_measured_median);
}

/// Errors of the second timing against the first, frame by frame.
void print_repeat(const std::string& name, const Frames& first, const Frames& second) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < std::min(first.size(), second.size()); ++i)
    if (first[i].milliseconds >= kLeastFrame_ms && first[i].features.value == second[i].features.value)
      errors.push_back(std::abs(second[i].milliseconds / first[i].milliseconds - 1.0));
  if (errors.empty()) return;
  std::sort(errors.begin(), errors.end());
  const auto at = [&](double share) { return 100.0 * errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))]; };
  std::printf("| %s, timed again | %zu | %.1f %% | %.1f %% | | |\n", name.c_str(), errors.size(), at(0.5), at(0.9));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "usage: time_model TRAIN.csv NAME=TEST.csv ... [again NAME=SAME.csv ...]\n"), 2;
  constexpr double kCoverage = 0.99;
  const CalibrationSamples training = read_samples(argv[1]);
  const Frames& train = training.frames;
  const double reference_ms = training.machine.reference_ms;
  std::map<std::string, Frames> tests, repeats;
  Frames all;
  bool again = false;
  for (int i = 2; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::size_t equals = argument.find('=');
    if (argument == "again") {
      again = true;
    } else if (again) {
      repeats[argument.substr(0, equals)] = frames_of(argument.substr(equals + 1), reference_ms);
    } else {
      const Frames frames = frames_of(argument.substr(equals + 1), reference_ms);
      tests[argument.substr(0, equals)] = frames;
      all.insert(all.end(), frames.begin(), frames.end());
    }
  }
  std::printf("| frames >= 1 ms | n | median error | p90 | misses (allowed) | bound / measured |\n|---|---|---|---|---|---|\n");
  const FitSummary fit = fit_time_model(train, kCoverage);
  std::printf("| trained on, held out | %u | %.1f %% | %.1f %% | %.1f %% | %.2f |\n", fit.frames, 100 * fit.median_error,
              100 * fit.p90_error, 100 * (1.0 - fit.measured_coverage), fit.bound_over_measured_median);
  for (const auto& [name, frames] : tests) print(name, fit.model, long_frames(frames));
  print("all of these", fit.model, long_frames(all));
  const TimeModel told = fit_time_model(with_counted_pixels(train), kCoverage).model;
  print("all, told the passed pixels", told, with_counted_pixels(long_frames(all)));
  for (const auto& [name, frames] : repeats)
    if (tests.contains(name)) print_repeat(name, tests[name], frames);
  for (const double seconds : {5.0, 10.0, 20.0, 40.0, 60.0, 80.0})
    if (const Frames first = first_seconds(train, seconds); steady_frames(first).size() >= kLeastFrames)
      print("all, calibrated for " + std::to_string(static_cast<int>(seconds)) + " s (" + std::to_string(first.size()) + " frames)",
            fit_time_model(first, kCoverage).model, long_frames(all));
}
