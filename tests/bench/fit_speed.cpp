// How long the fit takes and what memory: rows x 16 terms, alone; then a whole calibration's fit (model comparison, elimination, folds).
// Results: fit.md.
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>

#include "estimation/calibrate.h"
#include "estimation/robust_fit.h"
#include "estimation/self_test_frames.h"

namespace {

using namespace standin;

constexpr std::size_t kTerms = 16;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// Terms over ten orders of magnitude, two of which cost nothing; 5 % noise, and a twentieth of the rows four times too slow.
FitProblem problem(std::size_t rows, Combination combination) {
  FitProblem problem;
  for (std::size_t j = 0; j < kTerms; ++j) problem.stages.push_back(j == 0 ? Stage::kShared : j % 2 == 1 ? Stage::kGeometry : Stage::kFill);
  for (std::size_t i = 0; i < rows; ++i) {
    Rng rng(1, i);
    const double size = std::pow(10.0, rng.uniform(-2.0, 0.0));
    double part[3] = {0.3, 0.0, 0.0};
    problem.features.push_back(1.0);
    for (std::size_t j = 1; j < kTerms; ++j) {
      const double scale = std::pow(10.0, static_cast<double>(j % 11) - 5.0), feature = size * scale * rng.uniform();
      problem.features.push_back(feature);
      part[static_cast<std::size_t>(problem.stages[j])] += j == 5 || j == 8 ? 0.0 : 2.0 * feature / scale;
    }
    const double ms = part[0] + (combination == Combination::kSum ? part[1] + part[2] : std::max(part[1], part[2]));
    problem.milliseconds.push_back(ms * std::exp(0.05 * self_test::normal(rng)) * (i % 20 == 7 ? 4.0 : 1.0));
  }
  return problem;
}

void time_fit(std::size_t rows, Combination combination) {
  const FitProblem input = problem(rows, combination);
  const auto start = std::chrono::steady_clock::now();
  const FitResult fit = fit_robustly(input, {combination});
  std::printf("| fit, %s | %zu | %zu | %.3f | %.0f | %s |\n", combination == Combination::kSum ? "sum" : "maximum", rows, kTerms,
              seconds_since(start), peak_mb(), fit.stopped.c_str());
}

void time_calibration(std::size_t rows) {
  std::vector<TimedFrame> frames = self_test::exact_frames(2, rows);
  Rng rng(3);
  for (TimedFrame& frame : frames) {
    frame.milliseconds *= std::exp(0.05 * self_test::normal(rng));
    frame.group = static_cast<std::uint32_t>(rng.below(3));
  }
  const auto start = std::chrono::steady_clock::now();
  const FitSummary fit = fit_time_model(frames, 0.99);
  std::printf("| whole calibration | %zu | %zu | %.3f | %.0f | %s |\n", rows, kTermCount, seconds_since(start), peak_mb(),
              fit.stopped.c_str());
}

}  // namespace

int main() {
  std::printf("| what | rows | terms | s | peak RSS so far, MB | stopped |\n|---|---|---|---|---|---|\n");
  for (const std::size_t rows : {1'000U, 10'000U, 100'000U})
    for (const auto combination : {standin::Combination::kSum, standin::Combination::kMax}) time_fit(rows, combination);
  for (const std::size_t rows : {500U, 10'000U, 100'000U}) time_calibration(rows);
}
