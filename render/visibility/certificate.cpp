#include "render/visibility/certificate.h"

#include <cmath>

namespace standin {
namespace {

// c: a smaller one asks for fewer rays where none misses, a larger one for fewer after a miss. At 0.1 a region with one miss costs least.
constexpr double kMissFactor = 0.1;

// P(at most `misses` of `rays`), by the ratio of successive terms, in logarithms: the first underflows for many rays.
double binomial_tail(std::uint64_t misses, std::uint64_t rays, double p) {
  const auto n = static_cast<double>(rays);
  double sum = 0.0;
  double log_term = n * std::log1p(-p);
  for (std::uint64_t k = 0; k <= misses; ++k) {
    sum += std::exp(log_term);
    const auto next = static_cast<double>(k + 1);
    log_term += std::log((n - next + 1.0) / next) + std::log(p) - std::log1p(-p);
  }
  return sum;
}

}  // namespace

double clopper_pearson_upper(std::uint64_t misses, std::uint64_t rays, double confidence) {
  if (misses >= rays) return 1.0;
  double low = static_cast<double>(misses) / static_cast<double>(rays);
  double high = 1.0;
  for (int i = 0; i < 200 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (binomial_tail(misses, rays, middle) > 1.0 - confidence ? low : high) = middle;
  }
  return high;
}

MissCertificate::MissCertificate(double confidence) : log_refuted_(-std::log1p(-confidence)) {}

// (1 - c p) / (1 - p) = g, where g^rays c^misses = 1 / (1 - confidence).
double MissCertificate::upper_bound() const {
  if (rays_without_miss_ == 0) return 1.0;
  const double needed = log_refuted_ - static_cast<double>(misses_) * std::log(kMissFactor);
  const double growth = std::expm1(needed / static_cast<double>(rays_without_miss_));  // g - 1
  return std::isfinite(growth) ? growth / (growth + (1.0 - kMissFactor)) : 1.0;
}

}  // namespace standin
