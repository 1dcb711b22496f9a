#include "render/visibility/certificate.h"

#include <algorithm>
#include <cmath>

namespace standin {
namespace {

// c: a smaller one asks for fewer rays where none misses, a larger one for fewer after a miss. At 0.1 a region with one miss costs least.
constexpr double kMissFactor = 0.1;

constexpr double kFirstWeight = 0.9;

// The others share the rest: 1 / (k (k + 1)) sums to 1.
double log_weight(std::size_t ordinal) {
  const auto k = static_cast<double>(ordinal);
  return ordinal == 0 ? std::log(kFirstWeight) : std::log(1.0 - kFirstWeight) - std::log(k * (k + 1.0));
}

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

MissCertificate::MissCertificate(double confidence, double share)
    : log_refuted_(-std::log1p(-confidence)), log_growth_(std::log1p(-kMissFactor * share) - std::log1p(-share)) {
  products_.push_back({0, 0, log_refuted_ - log_weight(0)});
}

bool MissCertificate::add_miss() {
  ++misses_;
  const Product& last = products_.back();
  const Product next{rays_, misses_, log_refuted_ - log_weight(products_.size())};
  const bool begins = log_needed(last) - log_growth_ * rays_without_miss(last) > next.log_needed;
  if (begins) products_.push_back(next);
  return begins;
}

double MissCertificate::log_needed(const Product& product) const {
  return product.log_needed - static_cast<double>(misses_ - product.misses_before) * std::log(kMissFactor);
}

double MissCertificate::rays_without_miss(const Product& product) const {
  return static_cast<double>((rays_ - misses_) - (product.rays_before - product.misses_before));
}

// (1 - c p) / (1 - p) = g, where weight g^rays c^misses = 1 / (1 - confidence).
double MissCertificate::upper_bound() const {
  double least = 1.0;
  for (const Product& product : products_) {
    const double rays = rays_without_miss(product);
    if (rays == 0.0) continue;
    const double growth = std::expm1(log_needed(product) / rays);  // g - 1
    if (std::isfinite(growth)) least = std::min(least, growth / (growth + (1.0 - kMissFactor)));
  }
  return least;
}

}  // namespace standin
