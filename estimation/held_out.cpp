#include "estimation/held_out.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "render/base/rng.h"

namespace standin {
namespace {

constexpr std::size_t kDealtFolds = 5;
constexpr std::uint64_t kDealingSeed = 1;
constexpr std::size_t kComparedFrames = 2000;
constexpr double kMaxGain = 0.05;
constexpr double kDropMargin = 0.002;
constexpr double kVague = 0.5;
// Errors that differ by less are equal: rounding, where a model is exact.
constexpr double kNoError = 1e-7;

/// Whether some term occurs in frames of this group only: a model fitted without them could not judge them.
bool alone_with_a_term(const std::vector<TimedFrame>& frames, std::uint32_t group) {
  for (std::size_t i = 0; i < kTermCount; ++i) {
    bool inside = false, outside = false;
    for (const TimedFrame& frame : frames)
      if (frame.features.value[i] > 0.0) (frame.group == group ? inside : outside) = true;
    if (inside && !outside) return true;
  }
  return false;
}

/// All frames, or some that represent them.
std::vector<TimedFrame> compared_frames(const std::vector<TimedFrame>& frames, const TermSet& terms) {
  if (frames.size() <= kComparedFrames) return frames;
  std::vector<TimedFrame> some;
  for (const std::size_t row : spread_rows(problem_of(frames, all_rows(frames.size()), terms), kComparedFrames))
    some.push_back(frames[row]);
  return some;
}

/// With stages of one kind only the maximum is the sum.
bool may_overlap(const TermSet& terms) {
  bool geometry = false, fill = false;
  for (std::size_t i = 0; i < kTermCount; ++i) {
    if (!terms[i]) continue;
    if (stage_of(static_cast<Term>(i)) == Stage::kGeometry) geometry = true;
    if (stage_of(static_cast<Term>(i)) == Stage::kFill) fill = true;
  }
  return geometry && fill;
}

struct VagueTerm {
  std::size_t term;
  double vagueness;  // relative standard error; infinity where the coefficient is 0
};

/// The vaguest first.
std::vector<VagueTerm> vague_terms(const FittedForm& fitted) {
  std::vector<VagueTerm> vague;
  for (std::size_t k = 0; k < fitted.terms.size(); ++k)
    if (fitted.fit.relative_standard_error[k] > kVague) vague.push_back({fitted.terms[k], fitted.fit.relative_standard_error[k]});
  std::stable_sort(vague.begin(), vague.end(), [](const VagueTerm& a, const VagueTerm& b) { return a.vagueness > b.vagueness; });
  return vague;
}

void drop_terms(const std::vector<TimedFrame>& frames, const std::vector<Rows>& folds, FormChoice& choice) {
  double error = choice.form.combination == Combination::kSum ? choice.sum_error : choice.max_error;
  for (const VagueTerm& vague : vague_terms(fit_form(frames, all_rows(frames.size()), choice.form))) {
    ModelForm without = choice.form;
    without.terms[vague.term] = false;
    if (std::none_of(without.terms.begin(), without.terms.end(), [](bool present) { return present; })) return;
    const double error_without = error_of(held_out_predictions(frames, folds, without));
    if (error_without > (1.0 + kDropMargin) * error + kNoError) continue;
    choice.form = without;
    error = error_without;
    choice.left_out.push_back(std::string(term_name(static_cast<Term>(vague.term))) +
                              ": costs nothing measurable beside the other terms; without it the held-out error is no higher");
  }
}

}  // namespace

std::vector<TimedFrame> judged_first(std::vector<TimedFrame> frames) {
  std::stable_partition(frames.begin(), frames.end(), [](const TimedFrame& frame) { return !frame.designed; });
  return frames;
}

std::size_t judged_count(const std::vector<TimedFrame>& frames) {
  const auto designed = std::find_if(frames.begin(), frames.end(), [](const TimedFrame& frame) { return frame.designed; });
  return designed == frames.begin() ? frames.size() : static_cast<std::size_t>(designed - frames.begin());
}

Rows all_rows(std::size_t frames) {
  return rows_without(frames, {});
}

Rows rows_without(std::size_t frames, const Rows& fold) {
  std::vector<bool> inside(frames, false);
  for (const std::size_t row : fold) inside[row] = true;
  Rows rows;
  for (std::size_t row = 0; row < frames; ++row)
    if (!inside[row]) rows.push_back(row);
  return rows;
}

FitProblem problem_of(const std::vector<TimedFrame>& frames, const Rows& rows, const TermSet& terms) {
  FitProblem problem;
  for (std::size_t i = 0; i < kTermCount; ++i)
    if (terms[i]) problem.stages.push_back(stage_of(static_cast<Term>(i)));
  problem.features.reserve(rows.size() * problem.terms());
  for (const std::size_t row : rows) {
    problem.milliseconds.push_back(frames[row].milliseconds);
    for (std::size_t i = 0; i < kTermCount; ++i)
      if (terms[i]) problem.features.push_back(frames[row].features.value[i]);
  }
  return problem;
}

FittedForm fit_form(const std::vector<TimedFrame>& frames, const Rows& rows, const ModelForm& form) {
  FittedForm fitted;
  fitted.fit = fit_robustly(problem_of(frames, rows, form.terms), {.combination = form.combination});
  fitted.model.combination = form.combination;
  for (std::size_t i = 0; i < kTermCount; ++i) {
    if (!form.terms[i]) continue;
    fitted.model.milliseconds_per_unit[i] = fitted.fit.milliseconds_per_unit[fitted.terms.size()];
    fitted.terms.push_back(i);
  }
  return fitted;
}

std::vector<Rows> folds_of(const std::vector<TimedFrame>& frames) {
  const std::size_t judged = judged_count(frames);
  std::set<std::uint32_t> groups;
  for (std::size_t row = 0; row < judged; ++row) groups.insert(frames[row].group);
  std::vector<Rows> folds;
  Rows dealt;
  for (const std::uint32_t group : groups) {
    Rows rows;
    for (std::size_t row = 0; row < judged; ++row)
      if (frames[row].group == group) rows.push_back(row);
    if (groups.size() < 2 || alone_with_a_term(frames, group))
      dealt.insert(dealt.end(), rows.begin(), rows.end());
    else
      folds.push_back(std::move(rows));
  }
  Rng rng(kDealingSeed);
  for (std::size_t i = dealt.size(); i > 1; --i) std::swap(dealt[i - 1], dealt[rng.below(i)]);
  for (std::size_t k = 0; k < kDealtFolds && k < dealt.size(); ++k) {
    Rows rows;
    for (std::size_t i = k; i < dealt.size(); i += kDealtFolds) rows.push_back(dealt[i]);
    folds.push_back(std::move(rows));
  }
  return folds;
}

std::vector<HeldOut> held_out_predictions(const std::vector<TimedFrame>& frames, const std::vector<Rows>& folds, const ModelForm& form) {
  std::vector<HeldOut> held_out(judged_count(frames));
  for (const Rows& fold : folds) {
    const TimeModel model = fit_form(frames, rows_without(frames.size(), fold), form).model;
    for (const std::size_t row : fold)
      held_out[row] = {model.predicted_ms(frames[row].features), frames[row].milliseconds, frames[row].group};
  }
  return held_out;
}

double error_of(const std::vector<HeldOut>& held_out) {
  double sum = 0.0;
  for (const HeldOut& frame : held_out)
    sum += std::min(1.0, std::abs(frame.predicted_ms - frame.measured_ms) / (frame.measured_ms + kSmallFrameMs));
  return sum / static_cast<double>(held_out.size());
}

FormChoice choose_form(const std::vector<TimedFrame>& frames, const TermSet& supported) {
  const std::vector<TimedFrame> compared = compared_frames(frames, supported);
  const std::vector<Rows> folds = folds_of(compared);
  FormChoice choice;
  choice.form.terms = supported;
  choice.sum_error = choice.max_error = error_of(held_out_predictions(compared, folds, choice.form));
  if (may_overlap(supported)) choice.max_error = error_of(held_out_predictions(compared, folds, {supported, Combination::kMax}));
  if (choice.max_error + kNoError < (1.0 - kMaxGain) * choice.sum_error) choice.form.combination = Combination::kMax;
  drop_terms(compared, folds, choice);
  return choice;
}

}  // namespace standin
