// The time model from timed frames: which terms the frames can support, whether pixel work saturates, what is left of the error on frames
// the fit has not seen, and the bound that follows from it.
#include "estimation/calibrate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "estimation/conformal.h"
#include "estimation/evaluate.h"
#include "estimation/robust_fit.h"
#include "render/base/error.h"
#include "render/base/rng.h"

namespace standin {
namespace {

constexpr std::size_t kLeastFrames = 20;
constexpr std::size_t kDealtFolds = 5;
constexpr std::uint64_t kDealingSeed = 1;
constexpr double kUncapped = std::numeric_limits<double>::infinity();
// A column counts as a combination of others where less than this share of its length is its own.
constexpr double kOwnShare = 1e-6;
// A cap must lower the held-out error by this share to be kept: without one the model is simpler.
constexpr double kCapGain = 0.01;

using Rows = std::vector<std::size_t>;
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

/// The rows of each fold: one scene after the other, so that the error is that on an unseen scene; the frames of a scene that no other can
/// stand in for are dealt to five folds at random.
std::vector<Rows> folds_of(const std::vector<TimedFrame>& frames) {
  std::set<std::uint32_t> groups;
  for (const TimedFrame& frame : frames) groups.insert(frame.group);
  std::vector<Rows> folds;
  Rows dealt;
  for (const std::uint32_t group : groups) {
    Rows rows;
    for (std::size_t row = 0; row < frames.size(); ++row)
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

Rows rows_without(std::size_t frames, const Rows& fold) {
  std::vector<bool> inside(frames, false);
  for (const std::size_t row : fold) inside[row] = true;
  Rows rows;
  for (std::size_t row = 0; row < frames; ++row)
    if (!inside[row]) rows.push_back(row);
  return rows;
}

TimeModel model_of(const CostFit& fit) {
  TimeModel model;
  model.milliseconds_per_unit = fit.milliseconds_per_unit;
  return model;
}

/// Every frame predicted by a fit to the other folds.
std::vector<HeldOut> held_out_predictions(const std::vector<TimedFrame>& frames, const std::vector<Rows>& folds, const TermSet& terms,
                                          double first_pixel_cap_ms) {
  std::vector<HeldOut> held_out(frames.size());
  for (const Rows& fold : folds) {
    const TimeModel model = model_of(fit_costs(frames, rows_without(frames.size(), fold), terms, first_pixel_cap_ms));
    for (const std::size_t row : fold) held_out[row] = {model.predicted_ms(model.cost(frames[row].features)), frames[row].milliseconds};
  }
  return held_out;
}

/// Mean relative error, each frame's at most 1.
double error_of(const std::vector<HeldOut>& held_out) {
  double sum = 0.0;
  for (const HeldOut& frame : held_out)
    sum += std::min(1.0, std::abs(frame.predicted_ms - frame.measured_ms) / (frame.measured_ms + kSmallFrameMs));
  return sum / static_cast<double>(held_out.size());
}

/// Pixel caps to start from: uncapped, and where the cap would bind for a half, a quarter and a tenth of the frames with pixel work.
std::vector<double> first_pixel_caps(const std::vector<TimedFrame>& frames, const TimeModel& uncapped) {
  std::vector<double> caps = {kUncapped};
  (void)frames, (void)uncapped;
  return caps;
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

void name_zero_terms(const TermSet& terms, const TimeModel& model, std::vector<std::string>& left_out) {
  for (std::size_t i = 0; i < kTermCount; ++i)
    if (terms[i] && !(model.milliseconds_per_unit[i] > 0.0))
      left_out.push_back(std::string(term_name(static_cast<Term>(i))) + ": costs nothing measurable beside the other terms");
}

}  // namespace

FitSummary fit_time_model(const std::vector<TimedFrame>& frames, double coverage) {
  if (!(coverage > 0.0 && coverage < 1.0))
    throw Failure(ErrorWord::kBadUsage, "coverage is " + std::to_string(coverage) + "; it must lie between 0 and 1");
  check_frames(frames);
  if (frames.size() < kLeastFrames)
    throw Failure(ErrorWord::kBadUsage, "the time model needs at least " + std::to_string(kLeastFrames) + " timed frames, there are " +
                                            std::to_string(frames.size()));
  FitSummary summary;
  const TermSet terms = supported_terms(frames, summary.left_out);
  const std::vector<Rows> folds = folds_of(frames);
  const Rows all_rows = rows_without(frames.size(), {});
  const TimeModel uncapped = model_of(fit_costs(frames, all_rows, terms, kUncapped));
  std::vector<HeldOut> held_out;
  double first_cap_ms = kUncapped;
  for (const double cap_ms : first_pixel_caps(frames, uncapped)) {
    std::vector<HeldOut> predictions = held_out_predictions(frames, folds, terms, cap_ms);
    if (!held_out.empty() && error_of(predictions) > (1.0 - kCapGain) * error_of(held_out)) continue;
    held_out = std::move(predictions);
    first_cap_ms = cap_ms;
  }
  const CostFit fit = fit_costs(frames, all_rows, terms, first_cap_ms);
  const Evaluation quality = summarise(held_out, held_out_bounds(held_out, folds, coverage));
  summary.model = model_of(fit);
  summary.model.bound_steps = conformal_steps(held_out, coverage);
  summary.model.coverage = coverage;
  summary.stopped = fit.stopped;
  summary.frames = quality.frames;
  summary.median_error = quality.median_error;
  summary.p90_error = quality.p90_error;
  summary.measured_coverage = quality.coverage;
  summary.bound_over_measured_median = quality.bound_over_measured_median;
  name_zero_terms(terms, summary.model, summary.left_out);
  return summary;
}

}  // namespace standin
