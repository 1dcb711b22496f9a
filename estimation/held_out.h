// Models judged by frames that they have not seen: the folds, and what each form of the time model leaves of the error on them.
#pragma once

#include <string>
#include <vector>

#include "estimation/calibrate.h"
#include "estimation/conformal.h"
#include "estimation/robust_fit.h"

namespace standin {

using Rows = std::vector<std::size_t>;  // indices of frames
/// Which terms take part; the others stay 0.
using TermSet = std::array<bool, kTermCount>;

/// What is decided before coefficients are fitted.
struct ModelForm {
  TermSet terms{};
  Combination combination = Combination::kSum;
};

struct FittedForm {
  TimeModel model;                 // without bound
  std::vector<std::size_t> terms;  // those of the form, in the order of `fit`
  FitResult fit;
};

/// Frames of the designed scene last. They are in every fit and never judged, unless there are no others.
[[nodiscard]] std::vector<TimedFrame> judged_first(std::vector<TimedFrame> frames);
[[nodiscard]] std::size_t judged_count(const std::vector<TimedFrame>& judged_first);

[[nodiscard]] Rows all_rows(std::size_t frames);
[[nodiscard]] Rows rows_without(std::size_t frames, const Rows& fold);
[[nodiscard]] FitProblem problem_of(const std::vector<TimedFrame>& frames, const Rows& rows, const TermSet& terms);
[[nodiscard]] FittedForm fit_form(const std::vector<TimedFrame>& frames, const Rows& rows, const ModelForm& form);

/// The judged rows of each fold: one scene after the other, so that the error is that on an unseen scene; the frames of a scene that no
/// other can stand in for are dealt to five folds at random. Here and below, frames are as judged_first() has them.
[[nodiscard]] std::vector<Rows> folds_of(const std::vector<TimedFrame>& frames);
/// Every judged frame predicted by a fit to all frames but those of its fold.
[[nodiscard]] std::vector<HeldOut> held_out_predictions(const std::vector<TimedFrame>& frames, const std::vector<Rows>& folds,
                                                        const ModelForm& form);
/// Mean relative error, each frame's at most 1.
[[nodiscard]] double error_of(const std::vector<HeldOut>& held_out);

struct FormChoice {
  ModelForm form;
  double sum_error = 0.0;  // held out, mean, with all terms of the start
  double max_error = 0.0;
  std::vector<std::string> left_out;  // terms dropped, with the reason
};
/// Stages overlap only where that lowers the held-out error by a twentieth: placement bounds a region by the sum of the stages, so a
/// maximum must earn what it costs there. Then terms that may be nothing (0, or a standard error above half of them) are dropped one by
/// one, the vaguest first, where the error without them is at most a fifth of a percent higher. Both are decided on at most 2,000 frames.
[[nodiscard]] FormChoice choose_form(const std::vector<TimedFrame>& frames, const TermSet& supported);

}  // namespace standin
