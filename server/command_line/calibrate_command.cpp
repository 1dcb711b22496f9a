// calibrate: fit this machine's time model, or say how a fitted one does here.
#include "estimation/designed_scene.h"
#include "estimation/learning_curve.h"
#include "estimation/samples_file.h"
#include "render/base/error.h"
#include "render/device/fingerprint.h"
#include "render/scene/city.h"
#include "render/scene/load.h"
#include "server/command_line/calibration_output.h"
#include "server/command_line/commands.h"
#include "server/job/world.h"

namespace standin {
namespace {

// As CAD programs deliver theirs: no textures, and back sides that nobody draws.
Scene without_textures(Scene scene) {
  for (Material& material : scene.materials) {
    material.texture = -1;
    material.double_sided = false;
  }
  scene.textures.clear();
  return scene;
}

// Cities that differ in seed, size and triangles per object.
std::vector<TrainingScene> built_in_cities() {
  std::vector<TrainingScene> scenes;
  scenes.push_back({make_city({300, 500'000, 101})});
  scenes.push_back({make_city({900, 700'000, 102})});
  scenes.push_back({make_city({1500, 2'950'000, 103})});
  return scenes;
}

std::vector<TrainingScene> named_scenes(const CommandContext& context) {
  std::vector<TrainingScene> scenes;
  for (const auto& file : context.arguments.scenes) scenes.push_back({load_scene(file, load_options(context.spec))});
  return scenes;
}

DeviceKind device_of(const JobSpec& spec) {
  return spec.device == "egl" ? DeviceKind::kEgl : DeviceKind::kOsMesa;
}

CalibrationOptions options_of(const CommandContext& context) {
  return {.seconds = context.arguments.seconds, .seed = context.spec.seed, .count_passed_pixels = !context.arguments.samples.empty()};
}

std::string names_of(const std::vector<TrainingScene>& scenes) {
  std::string names;
  for (const TrainingScene& one : scenes) names += (names.empty() ? "" : ", ") + one.scene.name;
  return names;
}

CalibrationSamples time_samples(const std::vector<TrainingScene>& scenes, const CommandContext& context, const Target* target) {
  const JobSpec& spec = context.spec;
  const auto device = make_context(device_of(spec), spec.width, spec.height);
  TimingProtocol protocol{.warm_up = kCalibrationWarmUp, .repeats = kCalibrationRepeats};
  if (target != nullptr) {
    if (spec.device != target->machine.device || device->renderer() != target->machine.renderer)
      throw Failure(ErrorWord::kDeviceUnavailable, "target " + context.arguments.evaluate + " was measured on " + target->machine.device +
                                                       ", " + target->machine.renderer + "; this is " + spec.device + ", " +
                                                       device->renderer());
    protocol.reference_ms = target->machine.reference_ms;
    protocol.clock = clock_named(target->machine.clock);
  }
  const auto timer = make_frame_timer(*device, protocol);
  const double target_error = context.arguments.target_error;
  const auto enough = [&](const std::vector<TimedFrame>& frames) {
    if (!(target_error > 0.0) || !enough_frames(frames)) return false;
    const FitSummary fit = fit_time_model(frames, context.arguments.coverage);
    context.budget.found({{"median_error", fit.median_error}, {"frames", static_cast<double>(frames.size())}});
    return accurate_enough(fit, target_error);
  };
  CalibrationSamples samples;
  samples.frames = sample_frames(scenes, *device, *timer, camera_of(spec), options_of(context), enough, context.budget);
  samples.machine = {spec.device,      device->renderer(),    device->version(),
                     processor_name(), timer->reference_ms(), std::string(clock_name(timer->clock()))};
  return samples;
}

// What real scenes leave confounded, the designed one tells apart. Who names scenes asks about these; otherwise the bound is to hold for
// scenes without textures, too.
CalibrationSamples training_samples(const CommandContext& context) {
  std::vector<TrainingScene> scenes = named_scenes(context);
  const std::string names = names_of(scenes);
  if (scenes.empty()) {
    scenes = built_in_cities();
    scenes.push_back({without_textures(make_city({400, 600'000, 104}))});
  }
  scenes.push_back({make_designed_scene(), true});
  CalibrationSamples samples = time_samples(scenes, context, nullptr);
  samples.scenes = names;
  return samples;
}

int evaluate_target(const CommandContext& context) {
  const Target target = read_target(context.arguments.evaluate);
  const std::vector<TrainingScene> named = named_scenes(context);
  const CalibrationSamples samples = time_samples(named.empty() ? built_in_cities() : named, context, &target);
  if (!context.arguments.samples.empty()) write_samples(samples, context.arguments.samples);
  const Evaluation result = evaluate(target.model, samples.frames);
  print_evaluation(result, target.model.coverage, context.arguments.json);
  return result.misses <= most_misses(result.frames, target.model.coverage) ? 0 : 1;
}

Target make_target(const FitSummary& fit, const CalibrationSamples& samples, std::vector<LearningPoint> curve) {
  const Machine& machine = samples.machine;
  Target target;
  target.model = fit.model;
  target.machine = machine;
  target.id = machine.device + " on " + machine.processor + (samples.scenes.empty() ? "" : " for " + samples.scenes);
  target.samples = fit.frames;
  target.median_error = fit.median_error;
  target.p90_error = fit.p90_error;
  target.measured_coverage = fit.measured_coverage;
  target.left_out = fit.left_out;
  target.learning_curve = std::move(curve);
  return target;
}

}  // namespace

int calibrate_command(const CommandContext& context) {
  const CommandArguments& arguments = context.arguments;
  if (arguments.self_test) return print_self_test(arguments.json) == 0 ? 0 : 1;
  if (arguments.evaluate.empty() && arguments.output.empty())
    throw Failure(ErrorWord::kBadUsage, "calibrate needs -o FILE, --evaluate FILE or --self-test");
  if (!arguments.evaluate.empty() && (!arguments.output.empty() || arguments.explain))
    throw Failure(ErrorWord::kBadUsage, "calibrate --evaluate fits nothing: it takes no -o and no --explain");
  if (!arguments.refit.empty() && !arguments.scenes.empty())
    throw Failure(ErrorWord::kBadUsage, "calibrate --refit times nothing: it takes no SCENE");
  CalibrationSamples samples;
  if (!arguments.refit.empty()) {
    samples = read_samples(arguments.refit);
  } else {
    const TimingLock lock(context.budget);
    if (!arguments.evaluate.empty()) return evaluate_target(context);
    samples = training_samples(context);
  }
  if (!arguments.samples.empty()) write_samples(samples, arguments.samples);
  const FitSummary fit = fit_time_model(samples.frames, arguments.coverage);
  const std::vector<LearningPoint> curve = learning_curve(samples.frames, arguments.coverage);
  write_target(make_target(fit, samples, curve), arguments.output);
  print_fit(fit, curve, arguments.explain, arguments.json);
  return arguments.target_error > 0.0 && !accurate_enough(fit, arguments.target_error) ? 1 : 0;
}

}  // namespace standin
