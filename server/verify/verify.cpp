// Look every view up, estimate it, draw it with and without impostors, time it, and have rays judge the impostors themselves.
#include "server/verify/verify.h"

#include <algorithm>
#include <numeric>

#include "render/device/renderer.h"
#include "server/verify/frame_estimate.h"
#include "server/verify/frame_pictures.h"
#include "server/verify/impostor_judge.h"
#include "server/verify/shipped_impostors.h"
#include "server/verify/view_sampling.h"

namespace standin {
namespace {

DrawList draw_list(const Placement& placement, const Lookup& lookup, const Scene& scene) {
  ViewContent content = content_of(placement, lookup, static_cast<std::uint32_t>(scene.objects.size()));
  return {std::move(content.objects), std::move(content.impostors), std::move(content.levels)};
}

/// A quarter of them at most are the survey's: where it saw the slowest frames, frames must be as slow as it said.
std::vector<VerifiedView> choose_views(const VerifyInput& input, const VerifyOptions& options) {
  const auto surveyed = std::min(static_cast<std::uint32_t>(input.surveyed_views.size()), options.views / 4);
  std::vector<VerifiedView> views = sample_views(input.placement, input.view_space, options.views - surveyed, options.seed);
  for (std::uint32_t i = 0; i < surveyed; ++i) {
    views.emplace_back();
    views.back().view = input.surveyed_views[i];
    views.back().origin = ViewOrigin::kSurveyed;
  }
  return views;
}

/// Fills in the views' look-ups and says what each draws.
std::vector<FramePair> look_up(const VerifyInput& input, const WorkBudget& budget, std::vector<VerifiedView>& views) {
  const PlacementIndex index(input.placement);
  std::vector<FramePair> frames;
  for (auto& view : views) {
    budget.check();
    const Lookup lookup = index.find(view.view.position, view.view.direction);
    view.cell = lookup.cell;
    view.cpv = lookup.cpv;
    DrawList before = draw_list(input.placement, {lookup.cell, std::nullopt}, input.scene);
    DrawList original{before.objects, {}};
    frames.push_back({std::move(original), std::move(before), draw_list(input.placement, lookup, input.scene)});
  }
  return frames;
}

void estimate(const VerifyInput& input, const ImpostorSet& shipped, const std::vector<FramePair>& frames, const WorkBudget& budget,
              std::vector<VerifiedView>& views) {
  const FrameEstimator estimator(input.scene, input.camera, input.target.model, shipped);
  for (std::size_t i = 0; i < views.size(); ++i) {
    budget.check();
    views[i].estimated_before_ms = estimator.predicted_ms(views[i].view, frames[i].before);
    views[i].estimated_after_ms = estimator.predicted_ms(views[i].view, frames[i].after);
  }
}

/// The slow frames to time, highest estimates first.
std::vector<bool> timed_before(const std::vector<VerifiedView>& views, std::uint32_t count) {
  std::vector<std::uint32_t> order(views.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return views[a].estimated_before_ms > views[b].estimated_before_ms; });
  order.resize(std::min<std::size_t>(order.size(), count));
  std::vector<bool> timed(views.size(), false);
  for (const auto view : order) timed[view] = true;
  return timed;
}

void time_frames(Renderer& renderer, FrameTimer& timer, std::uint32_t before_count, const std::vector<FramePair>& frames,
                 const WorkBudget& budget, std::vector<VerifiedView>& views) {
  const std::vector<bool> before = timed_before(views, before_count);
  for (std::size_t i = 0; i < views.size(); ++i) {
    budget.check();
    budget.report("verify: timing", static_cast<double>(i) / static_cast<double>(views.size()));
    views[i].measured_after_ms = timer.time(renderer, views[i].view, frames[i].after).milliseconds;
    if (before[i]) views[i].measured_before_ms = timer.time(renderer, views[i].view, frames[i].before).milliseconds;
  }
}

/// The error of those views whose `shown` frames are not the originals, and its mean.
struct Compared {
  std::vector<std::size_t> views;
  std::vector<PictureError> errors;
  PictureError mean;
};

template <class Wanted>
Compared compare_pictures(Renderer& renderer, const std::vector<FramePair>& frames, DrawList FramePair::*shown, const Wanted& wanted,
                          const std::vector<VerifiedView>& views, int threads, const WorkBudget& budget) {
  Compared compared;
  for (std::size_t i = 0; i < views.size(); ++i)
    if (wanted(frames[i].*shown)) compared.views.push_back(i);
  const std::size_t count = compared.views.size();
  compared.errors.resize(count);
  const auto draw = [&](std::size_t k) {
    budget.report("verify: pictures", static_cast<double>(k) / static_cast<double>(count));
    return draw_pair(renderer, views[compared.views[k]].view, frames[compared.views[k]], shown);
  };
  compare_pairs(count, threads, budget, draw, [&](std::size_t k, const PicturePair& pictures) { compared.errors[k] = error_of(pictures); });
  for (const PictureError& error : compared.errors) {
    compared.mean.mean_error += error.mean_error / static_cast<double>(count);
    compared.mean.mean_flip += error.mean_flip / static_cast<double>(count);
  }
  return compared;
}

bool shows_levels(const DrawList& list) {
  return std::ranges::any_of(list.levels, [](std::uint8_t level) { return level > 0; });
}

/// Of impostors only views that draw one are drawn; of levels of detail, without impostors, those that show one.
void compare_pictures(Renderer& renderer, const std::vector<FramePair>& frames, int threads, const WorkBudget& budget,
                      VerifyResult& result) {
  const auto shows_impostors = [](const DrawList& list) { return !list.impostors.empty(); };
  const Compared impostors = compare_pictures(renderer, frames, &FramePair::after, shows_impostors, result.views, threads, budget);
  for (std::size_t k = 0; k < impostors.views.size(); ++k) {
    result.views[impostors.views[k]].mean_error = impostors.errors[k].mean_error;
    result.views[impostors.views[k]].mean_flip = impostors.errors[k].mean_flip;
  }
  if (impostors.views.empty()) result.left_out.emplace_back("image comparison: no sampled view draws an impostor");
  result.mean_error = impostors.mean.mean_error;
  result.mean_flip = impostors.mean.mean_flip;
  const Compared levels = compare_pictures(renderer, frames, &FramePair::before, shows_levels, result.views, threads, budget);
  if (levels.views.empty()) return;
  result.lods_mean_error = levels.mean.mean_error;
  result.lods_mean_flip = levels.mean.mean_flip;
}

void count_over_budget(double budget_ms, VerifyResult& result) {
  for (const auto& view : result.views) {
    if (view.estimated_after_ms > budget_ms) ++result.over_budget_estimated;
    if (!view.measured_after_ms) continue;
    if (*view.measured_after_ms > budget_ms) ++result.over_budget_measured;
    result.worst_over_budget = std::max(result.worst_over_budget, *view.measured_after_ms / budget_ms);
  }
}

std::optional<double> measured_coverage(const TimeModel& model, const std::vector<VerifiedView>& views) {
  std::uint32_t timed = 0;
  std::uint32_t kept = 0;
  const auto count = [&](double estimated_ms, const std::optional<double>& measured_ms) {
    if (!measured_ms) return;
    ++timed;
    if (*measured_ms <= model.bound_ms(estimated_ms)) ++kept;
  };
  for (const auto& view : views) {
    count(view.estimated_before_ms, view.measured_before_ms);
    count(view.estimated_after_ms, view.measured_after_ms);
  }
  return timed > 0 ? std::optional(static_cast<double>(kept) / timed) : std::nullopt;
}

void note_untimed(bool timed, const VerifyOptions& options, VerifyResult& result) {
  if (!timed)
    result.left_out.emplace_back(
        "frame times: not measured, since the target file belongs to another device or renderer than this machine's");
  else if (options.measured_before < result.views.size())
    result.left_out.push_back("frame times before: measured for " + std::to_string(options.measured_before) +
                              " views, those with the highest estimates, to save time");
}

void compare_with_survey(double surveyed_worst_ms, VerifyResult& result) {
  double worst_ms = 0.0;
  for (const auto& view : result.views) worst_ms = std::max(worst_ms, view.measured_before_ms.value_or(0.0));
  if (worst_ms > 0.0 && surveyed_worst_ms > 0.0) result.worst_before_over_surveyed = worst_ms / surveyed_worst_ms;
}

}  // namespace

VerifyResult verify_placement(const VerifyInput& input, Context& context, const StartTiming& start_timing, const VerifyOptions& options,
                              const WorkBudget& budget) {
  const GlbQuads glb = read_glb_quads(input.impostor_glb);
  const ImpostorSet shipped = shipped_impostors(glb, input.placement);
  VerifyResult result;
  result.views = choose_views(input, options);
  const std::vector<FramePair> frames = look_up(input, budget, result.views);
  estimate(input, shipped, frames, budget, result.views);

  Renderer renderer(context, input.scene, input.camera);
  renderer.upload(shipped);
  compare_pictures(renderer, frames, options.threads, budget, result);
  if (start_timing) {
    const TimingSession session = start_timing(context);
    time_frames(renderer, *session.timer, options.measured_before, frames, budget, result.views);
  }
  note_untimed(static_cast<bool>(start_timing), options, result);
  count_over_budget(input.budget_ms, result);
  result.measured_coverage = measured_coverage(input.target.model, result.views);
  compare_with_survey(input.surveyed_worst_ms, result);
  for (const auto view : worst_views(result.views, options.pictures))
    result.pictures.push_back(take_pictures(renderer, view, result.views[view].view, frames[view]));
  judge_impostors(input, glb, options, budget, result);
  return result;
}

VerifyResult verify_placement(const VerifyInput& input, DeviceKind device, bool measure, const VerifyOptions& options,
                              const WorkBudget& budget) {
  const auto context = make_context(device, input.camera.width, input.camera.height);
  StartTiming start_timing;
  if (measure)
    start_timing = [&](Context& timed) {
      TimingProtocol protocol;
      protocol.reference_ms = input.target.machine.reference_ms;
      protocol.clock = clock_named(input.target.machine.clock);
      auto lock = std::make_unique<TimingLock>(budget);
      return TimingSession{std::move(lock), make_frame_timer(timed, protocol)};
    };
  return verify_placement(input, *context, start_timing, options, budget);
}

}  // namespace standin
