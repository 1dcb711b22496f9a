// The time model from timed frames: which terms the frames can support, whether stages overlap, what is left of the error on frames the fit
// has not seen, and the bound that follows from it.
#include "estimation/calibrate.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "estimation/conformal.h"
#include "estimation/evaluate.h"
#include "estimation/fit_warnings.h"
#include "estimation/held_out.h"
#include "render/base/error.h"

namespace standin {
namespace {

// A column counts as a combination of others where less than this share of its length is its own.
constexpr double kOwnShare = 1e-6;

using Column = std::vector<double>;

double dot(const Column& a, const Column& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// A term's values over all frames, in the fit's weights.
Column weighted_column(const std::vector<TimedFrame>& frames, std::size_t term) {
  Column column;
  for (const TimedFrame& frame : frames) column.push_back(frame.features.value[term] / (frame.milliseconds + kSmallFrameMs));
  return column;
}

/// Takes from `column` what the orthonormal `basis` explains; twice, against rounding.
void orthogonalise(Column& column, const std::vector<Column>& basis) {
  for (int pass = 0; pass < 2; ++pass)
    for (const Column& direction : basis) {
      const double share = dot(column, direction);
      for (std::size_t i = 0; i < column.size(); ++i) column[i] -= share * direction[i];
    }
}

/// Terms that some frame has and that are no combination of earlier terms (Gram-Schmidt); the others are named with the reason.
TermSet supported_terms(const std::vector<TimedFrame>& frames, std::vector<std::string>& left_out) {
  TermSet terms{};
  std::vector<Column> basis;
  for (std::size_t i = 0; i < kTermCount; ++i) {
    const std::string name(term_name(static_cast<Term>(i)));
    Column column = weighted_column(frames, i);
    const double length = std::sqrt(dot(column, column));
    if (!(length > 0.0)) {
      left_out.push_back(name + ": no timed frame has any");
      continue;
    }
    orthogonalise(column, basis);
    const double own_length = std::sqrt(dot(column, column));
    if (!(own_length > kOwnShare * length)) {
      left_out.push_back(name + ": the timed frames cannot tell it apart from the terms before it");
      continue;
    }
    for (double& value : column) value /= own_length;
    basis.push_back(std::move(column));
    terms[i] = true;
  }
  return terms;
}

/// Bounds on each fold's frames by the ratios of the other folds.
std::vector<double> held_out_bounds(const std::vector<HeldOut>& held_out, const std::vector<Rows>& folds, double coverage) {
  std::vector<double> bounds_ms(held_out.size());
  for (const Rows& fold : folds) {
    std::vector<HeldOut> others;
    for (const std::size_t row : rows_without(held_out.size(), fold)) others.push_back(held_out[row]);
    TimeModel model;
    model.bound_steps = conformal_steps(std::move(others), coverage);
    for (const std::size_t row : fold) bounds_ms[row] = model.bound_ms(held_out[row].predicted_ms);
  }
  return bounds_ms;
}

/// Terms that stay in the form at 0: some folds had a use for them.
void name_zero_terms(const FittedForm& fitted, std::vector<std::string>& left_out) {
  for (const std::size_t i : fitted.terms)
    if (!(fitted.model.milliseconds_per_unit[i] > 0.0))
      left_out.push_back(std::string(term_name(static_cast<Term>(i))) + ": costs nothing measurable beside the other terms");
}

std::vector<FittedTerm> fitted_terms(const FittedForm& fitted) {
  std::vector<FittedTerm> terms;
  for (std::size_t k = 0; k < fitted.terms.size(); ++k) {
    const double error = fitted.fit.relative_standard_error[k];
    terms.push_back({std::string(term_name(static_cast<Term>(fitted.terms[k]))), fitted.fit.milliseconds_per_unit[k],
                     std::isfinite(error) ? std::optional(error) : std::nullopt, fitted.fit.at_bound[k]});
  }
  return terms;
}

void check_input(const std::vector<TimedFrame>& frames, double coverage) {
  if (!(coverage > 0.0 && coverage < 1.0))
    throw Failure(ErrorWord::kBadUsage, "coverage is " + std::to_string(coverage) + "; it must lie between 0 and 1");
  check_frames(frames);
  if (enough_frames(frames)) return;
  const std::vector<TimedFrame> steady = steady_frames(frames);
  const std::size_t judged = steady.empty() ? 0 : judged_count(judged_first(steady)), unsteady = frames.size() - steady.size();
  throw Failure(ErrorWord::kBadUsage,
                "the time model needs at least " + std::to_string(kLeastFrames) + " timed frames, there are " + std::to_string(judged) +
                    (steady.size() > judged ? ", and " + std::to_string(steady.size() - judged) + " of the designed scene" : "") +
                    (unsteady > 0 ? ", and " + std::to_string(unsteady) + " whose repeats disagree by more than a fifth" : ""));
}

void fill_quality(const std::vector<HeldOut>& held_out, const std::vector<Rows>& folds, double coverage, FitSummary& summary) {
  const Evaluation quality = summarise(held_out, held_out_bounds(held_out, folds, coverage));
  summary.held_out_frames = quality.frames;
  summary.misses = quality.misses;
  summary.median_error = quality.median_error;
  summary.p90_error = quality.p90_error;
  summary.measured_coverage = quality.coverage;
  summary.bound_over_measured_median = quality.bound_over_measured_median;
}

}  // namespace

std::vector<TimedFrame> steady_frames(const std::vector<TimedFrame>& frames) {
  std::vector<TimedFrame> steady;
  for (const TimedFrame& frame : frames)
    if (frame.spread <= kMostSpread) steady.push_back(frame);
  return steady;
}

bool enough_frames(const std::vector<TimedFrame>& frames) {
  const std::vector<TimedFrame> steady = judged_first(steady_frames(frames));
  return !steady.empty() && judged_count(steady) >= kLeastFrames;
}

FitSummary fit_time_model(const std::vector<TimedFrame>& all_frames, double coverage) {
  check_input(all_frames, coverage);
  const std::vector<TimedFrame> steady = steady_frames(all_frames);
  const std::vector<TimedFrame> frames = judged_first(steady);
  FitSummary summary;
  summary.frames = static_cast<std::uint32_t>(steady.size());
  summary.unsteady_frames = static_cast<std::uint32_t>(all_frames.size() - steady.size());
  const FormChoice choice = choose_form(frames, supported_terms(frames, summary.left_out));
  const FittedForm fitted = fit_form(frames, all_rows(frames.size()), choice.form);
  const std::vector<Rows> folds = folds_of(frames);
  const std::vector<HeldOut> held_out = held_out_predictions(frames, folds, choice.form);
  summary.model = fitted.model;
  summary.model.bound_steps = conformal_steps(held_out, coverage);
  summary.model.coverage = coverage;
  fill_quality(held_out, folds, coverage, summary);
  summary.stopped = fitted.fit.stopped;
  summary.condition_number = fitted.fit.condition_number;
  summary.terms = fitted_terms(fitted);
  summary.relative_covariance = fitted.fit.relative_covariance;
  summary.sum_error = choice.sum_error;
  summary.max_error = choice.max_error;
  summary.left_out.insert(summary.left_out.end(), choice.left_out.begin(), choice.left_out.end());
  name_zero_terms(fitted, summary.left_out);
  summary.warnings = fit_warnings(steady, fitted);
  if (held_out.size() < least_frames_for(coverage))
    summary.warnings.push_back("the bound rests on " + std::to_string(held_out.size()) + " frames, too few for its coverage (" +
                               std::to_string(least_frames_for(coverage)) +
                               " are enough): it is the greatest ratio times 1.25; let it time more (--seconds)");
  return summary;
}

}  // namespace standin
