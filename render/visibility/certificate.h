// What rays without a find prove: upper bounds on the share of rays that would see something outside a visible set.
//
// Clopper and Pearson (1934) bound a share from one sample of a size fixed beforehand: no miss in 46,050 rays, <= 1e-4 at 99 %. A visible
// set cannot keep to that: a miss is added to the set, and the test begins anew, at the price of one more chance to be wrong each time.
// MissCertificate bounds the share whenever one looks, with a test martingale (Robbins 1970, Waudby-Smith and Ramdas 2024). Call p_t the
// missed share of the set that ray t is compared with; it never grows. The product over all rays of (1 - c p_t) / (1 - p_t) for a ray that
// saw nothing new and c for a miss, c < 1, has expectation 1 for ever, so that it exceeds 100 at any time with a probability of 1 % at
// most (Ville 1939). The product falls with the p_t, so with the present p for all of them it is smaller still: every p that takes it to
// 100 is refuted, for the present set and all larger ones. No miss in 51,170 rays refutes 1e-4; a miss costs 25,600 rays more.
#pragma once

#include <cstdint>

namespace standin {

/// The share p at which `rays` independent rays miss at most `misses` times with a probability of 1 - confidence: Clopper and Pearson's
/// upper end, one-sided. Also valid where rays differ in their chance to miss and p is the mean (Hoeffding 1956), at confidences of 90 %
/// and above. 1 without rays.
[[nodiscard]] double clopper_pearson_upper(std::uint64_t misses, std::uint64_t rays, double confidence);

/// Over uniform, independent rays, each compared with a set that holds all misses before it and may have grown otherwise, too.
class MissCertificate {
 public:
  explicit MissCertificate(double confidence);

  void add(bool missed) { missed ? ++misses_ : ++rays_without_miss_; }
  /// Of the missed share of the present set. The chance that it was ever too low is at most 1 - confidence.
  [[nodiscard]] double upper_bound() const;
  [[nodiscard]] std::uint64_t rays() const { return misses_ + rays_without_miss_; }
  [[nodiscard]] std::uint64_t misses() const { return misses_; }

 private:
  double log_refuted_;  // logarithm of what the product must reach
  std::uint64_t misses_ = 0;
  std::uint64_t rays_without_miss_ = 0;
};

}  // namespace standin
