// What calibrate says: of a fit, of an evaluation, of the self-test; for people, or as JSON.
#pragma once

#include "estimation/calibrate.h"

namespace standin {

void print_fit(const FitSummary& fit, const std::vector<LearningPoint>& curve, bool with_explanation, bool as_json);
void print_evaluation(const Evaluation& evaluation, double coverage, bool as_json);
/// Runs it, too; how many cases failed.
[[nodiscard]] std::size_t print_self_test(bool as_json);

}  // namespace standin
