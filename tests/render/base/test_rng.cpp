#include <gtest/gtest.h>

#include <array>
#include <set>

#include "render/base/rng.h"

namespace standin {
namespace {

// SplitMix64 from state 1234567, a widely published vector; the state is seed * golden ^ (stream + 1) * odd, undone here for stream -1.
TEST(Rng, IsSplitMix64) {
  constexpr std::uint64_t kGoldenInverse = 0xF1DE83E19937733DULL;  // modulo 2^64
  static_assert(0x9E3779B97F4A7C15ULL * kGoldenInverse == 1);
  Rng rng(1234567ULL * kGoldenInverse, ~0ULL);
  for (const std::uint64_t expected : {6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL, 4593380528125082431ULL})
    EXPECT_EQ(rng.next(), expected);
}

TEST(Rng, StreamsAndSeedsDiffer) {
  std::set<std::uint64_t> first;
  for (std::uint64_t seed = 0; seed < 100; ++seed)
    for (std::uint64_t stream = 0; stream < 100; ++stream) first.insert(Rng(seed, stream).next());
  EXPECT_EQ(first.size(), 10'000U);
}

TEST(Rng, UniformFillsTheUnitIntervalEvenly) {
  Rng rng(3);
  std::array<int, 10> bins{};
  for (int i = 0; i < 100'000; ++i) {
    const double value = rng.uniform();
    ASSERT_GE(value, 0.0);
    ASSERT_LT(value, 1.0);
    ++bins.at(static_cast<std::size_t>(value * 10.0));
  }
  for (const int count : bins) EXPECT_NEAR(count, 10'000, 500);  // five standard deviations
}

TEST(Rng, BelowStaysBelowAndReachesAll) {
  Rng rng(4);
  std::array<int, 3> counts{};
  for (int i = 0; i < 3000; ++i) ++counts.at(rng.below(3));
  for (const int count : counts) EXPECT_GT(count, 850);
  EXPECT_EQ(rng.below(1), 0U);
}

}  // namespace
}  // namespace standin
