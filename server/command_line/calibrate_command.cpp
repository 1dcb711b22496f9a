// calibrate: fit this machine's time model, or say how a fitted one does here.
#include <cstdio>
#include <iostream>

#include "estimation/samples_file.h"
#include "estimation/self_test.h"
#include "render/base/error.h"
#include "render/device/fingerprint.h"
#include "render/scene/city.h"
#include "render/scene/load.h"
#include "server/command_line/commands.h"
#include "server/job/world.h"

namespace standin {
namespace {

using nlohmann::json;

// The built-in training set: cities that differ in seed, size and triangles per object.
std::vector<Scene> training_scenes(const CommandContext& context) {
  std::vector<Scene> scenes;
  for (const auto& file : context.arguments.scenes) scenes.push_back(load_scene(file, load_options(context.spec)));
  if (!scenes.empty()) return scenes;
  scenes.push_back(make_city({300, 500'000, 101}));
  scenes.push_back(make_city({900, 700'000, 102}));
  scenes.push_back(make_city({1500, 2'950'000, 103}));
  return scenes;
}

DeviceKind device_of(const JobSpec& spec) {
  return spec.device == "egl" ? DeviceKind::kEgl : DeviceKind::kOsMesa;
}

std::vector<TimedFrame> timed_frames(const std::vector<Scene>& scenes, const CommandContext& context, Context& device, FrameTimer& timer) {
  CalibrationOptions options;
  options.seconds = context.arguments.seconds / static_cast<double>(scenes.size());
  options.seed = context.spec.seed;
  std::vector<TimedFrame> frames;
  for (std::uint32_t group = 0; group < scenes.size(); ++group) {
    context.budget.report("calibrate", static_cast<double>(group) / static_cast<double>(scenes.size()));
    const auto some = sample_frames(scenes[group], group, device, timer, camera_of(context.spec), options, context.budget);
    frames.insert(frames.end(), some.begin(), some.end());
  }
  return frames;
}

CalibrationSamples time_samples(const CommandContext& context) {
  const JobSpec& spec = context.spec;
  const auto device = make_context(device_of(spec), spec.width, spec.height);
  const auto timer = make_cpu_frame_timer(*device, {.repeats = kCalibrationRepeats});
  CalibrationSamples samples;
  samples.frames = timed_frames(training_scenes(context), context, *device, *timer);
  samples.machine = {spec.device, device->renderer(), device->version(), processor_name(), timer->reference_ms()};
  return samples;
}

Target make_target(const FitSummary& fit, const Machine& machine) {
  Target target;
  target.model = fit.model;
  target.machine = machine;
  target.id = machine.device + " on " + machine.processor;
  target.samples = fit.frames;
  target.median_error = fit.median_error;
  target.p90_error = fit.p90_error;
  target.measured_coverage = fit.measured_coverage;
  target.left_out = fit.left_out;
  return target;
}

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

json fit_json(const FitSummary& fit) {
  json terms = json::object();
  for (std::size_t i = 0; i < kTermCount; ++i) terms[std::string(term_name(static_cast<Term>(i)))] = fit.model.milliseconds_per_unit[i];
  return {{"stopped", fit.stopped},
          {"frames", fit.frames},
          {"median_error", fit.median_error},
          {"p90_error", fit.p90_error},
          {"coverage", fit.measured_coverage},
          {"bound_over_measured_median", fit.bound_over_measured_median},
          {"milliseconds_per_unit", terms},
          {"pixel_cap_ms", null_if_infinite(fit.model.pixel_cap_ms)},
          {"combination", fit.model.combination == Combination::kSum ? "sum" : "max"},
          {"sum_error", fit.sum_error},
          {"max_error", fit.max_error},
          {"condition_number", null_if_infinite(fit.condition_number)},
          {"terms", terms_json(fit.terms)},
          {"relative_covariance", covariance_json(fit)},
          {"left_out", fit.left_out},
          {"warnings", fit.warnings}};
}

void print_fit(const FitSummary& fit) {
  std::printf(
      "%u frames; held out: median error %.1f %%, p90 %.1f %%, the bound covers %.2f %% and is %.2fx the measured time at the median\n",
      fit.frames, 100 * fit.median_error, 100 * fit.p90_error, 100 * fit.measured_coverage, fit.bound_over_measured_median);
  if (fit.model.combination == Combination::kMax)
    std::printf("geometry and fill overlap: the error is %.1f %% where they add up, %.1f %% where the longer one counts\n",
                100 * fit.sum_error, 100 * fit.max_error);
  for (const auto& reason : fit.left_out) std::printf("  left out: %s\n", reason.c_str());
  for (const auto& warning : fit.warnings) std::printf("  warning: %s\n", warning.c_str());
}

// Each term in units of another, for people.
void explain(const TimeModel& model) {
  const auto microseconds = [&](Term term) { return 1e3 * model.milliseconds_per_unit[static_cast<std::size_t>(term)]; };
  std::printf("an empty frame costs %.0f us\na draw call %.2f us\na texture switch %.2f us", microseconds(Term::kFrame),
              microseconds(Term::kDraws), microseconds(Term::kTextureSwitches));
  const double pixel = microseconds(Term::kTexturedPixels);
  if (pixel > 0) std::printf(", as much as %.0f textured pixels", microseconds(Term::kTextureSwitches) / pixel);
  std::printf("\na thousand triangles %.0f us, %.0f us more on screen and %.0f us more where they cover pixels\n",
              1e3 * microseconds(Term::kTriangles), 1e3 * microseconds(Term::kOnScreenTriangles),
              1e3 * microseconds(Term::kCoveringTriangles));
  std::printf("a million pixels: plain %.1f ms, textured %.1f ms, masked %.1f ms, of impostors %.1f ms\n",
              1e3 * microseconds(Term::kPlainPixels), 1e3 * pixel, 1e3 * microseconds(Term::kMaskedPixels),
              1e3 * microseconds(Term::kImpostorPixels));
}

int evaluate_target(const CommandContext& context) {
  const Target target = read_target(context.arguments.evaluate);
  const auto device = make_context(device_of(context.spec), context.spec.width, context.spec.height);
  if (context.spec.device != target.machine.device || device->renderer() != target.machine.renderer)
    throw Failure(ErrorWord::kDeviceUnavailable, "target " + context.arguments.evaluate + " was measured on " + target.machine.device +
                                                     ", " + target.machine.renderer + "; this is " + context.spec.device + ", " +
                                                     device->renderer());
  const auto timer = make_cpu_frame_timer(*device, {.repeats = kCalibrationRepeats, .reference_ms = target.machine.reference_ms});
  const Evaluation result = evaluate(target.model, timed_frames(training_scenes(context), context, *device, *timer));
  const json object = {{"frames", result.frames},       {"median_error", result.median_error},
                       {"p90_error", result.p90_error}, {"coverage", result.coverage},
                       {"misses", result.misses},       {"bound_over_measured_median", result.bound_over_measured_median}};
  std::cout << object.dump(2) << "\n";
  return result.coverage >= target.model.coverage ? 0 : 1;
}

// A table for people (Markdown), or JSON.
int self_test(bool as_json) {
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
  return failed == 0 ? 0 : 1;
}

}  // namespace

int calibrate_command(const CommandContext& context) {
  const CommandArguments& arguments = context.arguments;
  if (arguments.self_test) return self_test(arguments.json);
  if (arguments.evaluate.empty() && arguments.output.empty())
    throw Failure(ErrorWord::kBadUsage, "calibrate needs -o FILE, --evaluate FILE or --self-test");
  CalibrationSamples samples;
  if (!arguments.refit.empty()) {
    samples = read_samples(arguments.refit);
  } else {
    const TimingLock lock(context.budget);
    if (!arguments.evaluate.empty()) return evaluate_target(context);
    samples = time_samples(context);
  }
  if (!arguments.samples.empty()) write_samples(samples, arguments.samples);
  const FitSummary fit = fit_time_model(samples.frames, CalibrationOptions{}.coverage);
  write_target(make_target(fit, samples.machine), arguments.output);
  if (arguments.json)
    std::cout << fit_json(fit).dump(2) << "\n";
  else
    print_fit(fit);
  if (arguments.explain) explain(fit.model);
  return 0;
}

}  // namespace standin
