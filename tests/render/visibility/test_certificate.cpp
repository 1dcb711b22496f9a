#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "render/base/rng.h"
#include "render/visibility/certificate.h"

namespace standin {
namespace {

// P(at most `misses` of `rays`) as a sum of products, nothing in logarithms.
long double tail_by_hand(int misses, int rays, long double p) {
  long double sum = 0.0L;
  for (int k = 0; k <= misses; ++k) {
    long double term = 1.0L;
    for (int i = 0; i < k; ++i) term *= p * static_cast<long double>(rays - i) / static_cast<long double>(i + 1);
    for (int i = 0; i < rays - k; ++i) term *= 1.0L - p;
    sum += term;
  }
  return sum;
}

TEST(ClopperPearson, NoMissByHand) {
  EXPECT_NEAR(clopper_pearson_upper(0, 46'100, 0.99), 1.0 - std::pow(0.01, 1.0 / 46'100), 1e-12);
  EXPECT_LE(clopper_pearson_upper(0, 46'100, 0.99), 1e-4);
  EXPECT_LE(clopper_pearson_upper(0, 46'050, 0.99), 1e-4);
  EXPECT_GT(clopper_pearson_upper(0, 46'040, 0.99), 1e-4);
  EXPECT_NEAR(clopper_pearson_upper(0, 1, 0.95), 0.95, 1e-12);
}

TEST(ClopperPearson, IsWhereTheBinomialSumIsTheRestOfTheConfidence) {
  int cases = 0;
  for (const int rays : {10, 300, 5'000})
    for (const int misses : {0, 1, 2, 5, 9})
      for (const double confidence : {0.9, 0.99}) {
        const double bound = clopper_pearson_upper(static_cast<std::uint64_t>(misses), static_cast<std::uint64_t>(rays), confidence);
        EXPECT_NEAR(static_cast<double>(tail_by_hand(misses, rays, bound)), 1.0 - confidence, 1e-9) << misses << " of " << rays;
        ++cases;
      }
  EXPECT_EQ(cases, 30);
}

// Poisson's limits at 99 %: 4.605, 6.638, 8.406, 10.045 misses expected (tables of the chi-squared distribution).
TEST(ClopperPearson, TendsToTheTabledLimits) {
  const double tabled[] = {4.6052, 6.6384, 8.4059, 10.0451};
  for (std::uint64_t misses = 0; misses < 4; ++misses)
    EXPECT_NEAR(1e8 * clopper_pearson_upper(misses, 100'000'000, 0.99), tabled[misses], 1e-3);
}

TEST(ClopperPearson, SaysNothingWhereNothingIsKnown) {
  EXPECT_EQ(clopper_pearson_upper(0, 0, 0.99), 1.0);
  EXPECT_EQ(clopper_pearson_upper(7, 7, 0.99), 1.0);
}

MissCertificate after(std::uint64_t clean, std::uint64_t misses) {
  MissCertificate certificate(0.99, 1e-4);
  for (std::uint64_t i = 0; i < clean; ++i) certificate.add(false);
  for (std::uint64_t i = 0; i < misses; ++i) certificate.add(true);
  return certificate;
}

// The first product alone: misses come when it is too far on to begin another one.
TEST(MissCertificate, IsWhereTheWeightedProductReachesAHundred) {
  for (const std::uint64_t misses : {0U, 1U, 3U})
    for (const std::uint64_t clean : {60'000U, 200'000U}) {
      const double p = after(clean, misses).upper_bound();
      const double log_product =
          static_cast<double>(clean) * (std::log1p(-0.1 * p) - std::log1p(-p)) - 2.302585093 * static_cast<double>(misses);
      EXPECT_NEAR(log_product, std::log(100.0 / 0.9), 1e-5) << misses << " of " << clean;
    }
}

TEST(MissCertificate, CostsAnEighthMoreThanATestOfFixedSizeAndHalfAsMuchPerMiss) {
  EXPECT_LE(after(52'340, 0).upper_bound(), 1e-4);
  EXPECT_GT(after(52'300, 0).upper_bound(), 1e-4);
  EXPECT_LE(after(52'340 + 25'600, 1).upper_bound(), 1e-4);
  EXPECT_GT(after(52'300 + 25'500, 1).upper_bound(), 1e-4);
  EXPECT_EQ(MissCertificate(0.99, 1e-4).upper_bound(), 1.0);
  EXPECT_EQ(after(0, 5).upper_bound(), 1.0);
}

// A hundred misses before anything else would cost 2.6 million rays.
TEST(MissCertificate, ManyMissesAtFirstCostLittle) {
  MissCertificate certificate(0.99, 1e-4);
  for (int i = 0; i < 10'000; ++i) certificate.add(i % 100 == 0);
  while (certificate.rays() % 64 != 0 || certificate.upper_bound() > 1e-4) certificate.add(false);
  EXPECT_LT(certificate.rays(), 200'000U);
}

// Objects that a ray sees with the same chance each. Each one seen joins the set.
struct KnownWorld {
  std::size_t objects = 0;
  double share = 0.0;  // of all rays, each

  // Index of what a ray sees; `objects` or above: what was seen before.
  [[nodiscard]] std::size_t shoot(Rng& rng) const { return static_cast<std::size_t>(rng.uniform() / share); }
};

enum class Rule { kOurs, kBeginAnew };

// Whether the rule states `target` although more is missing. Begin anew: 228 rays in a row without a miss, as a test of fixed size would
// ask.
bool is_deceived(const KnownWorld& world, double target, Rule rule, std::uint64_t seed) {
  Rng rng(seed);
  std::vector<bool> seen(world.objects, false);
  std::size_t missing = world.objects;
  MissCertificate certificate(0.99, target);
  const auto clean_needed = static_cast<std::uint64_t>(std::ceil(std::log(0.01) / std::log1p(-target)));
  for (std::uint64_t clean = 0;;) {
    const std::size_t hit = world.shoot(rng);
    const bool missed = hit < seen.size() && !seen[hit];
    if (missed) seen[hit] = true, --missing;
    certificate.add(missed);
    clean = missed ? 0 : clean + 1;
    const bool stated = rule == Rule::kOurs ? certificate.rays() % 16 == 0 && certificate.upper_bound() <= target : clean >= clean_needed;
    if (stated) return static_cast<double>(missing) * world.share > target;
  }
}

double deceived_share(const KnownWorld& world, double target, Rule rule) {
  constexpr int kRuns = 2'000;
  int deceived = 0;
  for (int run = 0; run < kRuns; ++run) deceived += is_deceived(world, target, rule, 100 + static_cast<std::uint64_t>(run)) ? 1 : 0;
  return static_cast<double>(deceived) / kRuns;
}

// The worst for a test: all that is missing stays just above what is to be refuted, for as long as something is missing.
TEST(MissCertificate, IsRightInNinetyNineOfAHundredRunsWhateverIsMissing) {
  constexpr double kTarget = 0.02;
  const double allowed = 0.01 + 3.0 * std::sqrt(0.01 * 0.99 / 2'000);
  EXPECT_LE(deceived_share({1, 1.01 * kTarget}, kTarget, Rule::kOurs), allowed);
  EXPECT_LE(deceived_share({40, kTarget / 10.0}, kTarget, Rule::kOurs), allowed);
  EXPECT_LE(deceived_share({300, kTarget / 20.0}, kTarget, Rule::kOurs), allowed);
}

// What the martingale is for: a rule that begins the test of fixed size anew after each miss is wrong more often than it says.
TEST(MissCertificate, TestsBegunAnewAreDeceivedMoreOften) {
  constexpr double kTarget = 0.02;
  const KnownWorld world{300, kTarget / 20.0};
  const double anew = deceived_share(world, kTarget, Rule::kBeginAnew);
  std::printf("begun anew %.4f, ours %.4f\n", anew, deceived_share(world, kTarget, Rule::kOurs));
  EXPECT_GT(anew, 0.03);
}

}  // namespace
}  // namespace standin
