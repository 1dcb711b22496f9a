// What rays without a find prove: upper bounds on the share of rays that would see something outside a visible set.
//
// Clopper and Pearson (1934) bound a share from one sample of a size fixed beforehand: no miss in 46,050 rays, <= 1e-4 at 99 %. A visible
// set cannot keep to that: a miss is added to the set, and the test begins anew, at the price of one more chance to be wrong each time.
// MissCertificate bounds the share whenever one looks, with a test martingale (Robbins 1970, Waudby-Smith and Ramdas 2024). Call p_t the
// missed share of the set that ray t is compared with; it never grows. The product over all rays of (1 - c p_t) / (1 - p_t) for a ray that
// saw nothing new and c for a miss, c < 1, has expectation 1 for ever, so that it exceeds 100 at any time with a probability of 1 % at
// most (Ville 1939). The product falls with the p_t, so with the present p for all of them it is smaller still: every p that takes it to
// 100 is refuted, for the present set and all larger ones. No miss in 52,340 rays refutes 1e-4; a miss costs 25,600 rays more.
//
// Where many rays miss at first, that would never be made up for. So the product is one of several, begun at different times, each with a
// weight fixed beforehand (together 1 at most: their weighted sum has expectation 1, too): a new one begins at a miss after which it will
// refute the share asked for sooner than all before it. Without the others' weights 51,170 rays would do instead of 52,340.
#pragma once

#include <cstdint>
#include <vector>

namespace standin {

/// The share p at which `rays` independent rays miss at most `misses` times with a probability of 1 - confidence: Clopper and Pearson's
/// upper end, one-sided. Also valid where rays differ in their chance to miss and p is the mean (Hoeffding 1956), at confidences of 90 %
/// and above. 1 without rays.
[[nodiscard]] double clopper_pearson_upper(std::uint64_t misses, std::uint64_t rays, double confidence);

/// Over uniform, independent rays, each compared with a set that holds all misses before it and may have grown otherwise, too.
class MissCertificate {
 public:
  /// Begins anew so as to refute `share` soon; the bound holds whatever it is.
  MissCertificate(double confidence, double share);

  /// Returns whether it begins anew: many rays missed lately.
  bool add(bool missed) {
    ++rays_;
    return missed && add_miss();
  }
  /// Of the missed share of the present set. The chance that it was ever too low is at most 1 - confidence.
  [[nodiscard]] double upper_bound() const;
  [[nodiscard]] std::uint64_t rays() const { return rays_; }
  [[nodiscard]] std::uint64_t misses() const { return misses_; }

 private:
  struct Product {
    std::uint64_t rays_before = 0;
    std::uint64_t misses_before = 0;
    double log_needed = 0.0;  // without misses
  };
  bool add_miss();
  [[nodiscard]] double log_needed(const Product& product) const;
  [[nodiscard]] double rays_without_miss(const Product& product) const;

  double log_refuted_;  // logarithm of what the weighted sum must reach
  double log_growth_;   // of a product, by a ray without a miss, at the share asked for
  std::uint64_t rays_ = 0;
  std::uint64_t misses_ = 0;
  std::vector<Product> products_;
};

}  // namespace standin
