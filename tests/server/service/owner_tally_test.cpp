#include "server/service/owner_tally.h"

#include <gtest/gtest.h>

namespace standin {
namespace {

TEST(OwnerTally, CountsWhatIsHeldByOwner) {
  const OwnerTally tally;
  auto first = tally.hold("anna"), second = tally.hold("anna"), other = tally.hold("bert");
  EXPECT_EQ(tally.of("anna"), 2U);
  EXPECT_EQ(tally.all(), 3U);
  first.reset();
  other.reset();
  EXPECT_EQ(tally.of("anna"), 1U);
  EXPECT_EQ(tally.of("bert"), 0U);
  EXPECT_EQ(tally.all(), 1U);
}

TEST(OwnerTally, ASharesLeastIsOne) {
  EXPECT_EQ(share_of(8U, 0.5), 4U);
  EXPECT_EQ(share_of(7U, 0.5), 3U);
  EXPECT_EQ(share_of(2U, 0.001), 1U);
  EXPECT_EQ(share_of(200U, 1.0), 200U);
}

// An event stream belongs to the event loop, which may let it go last.
TEST(OwnerTally, WhatIsHeldMayOutliveIt) {
  auto tally = std::make_unique<OwnerTally>();
  const OwnerTally copy = *tally;  // of the same counts
  auto hold = tally->hold("anna");
  tally.reset();
  EXPECT_EQ(copy.of("anna"), 1U);
  hold.reset();
  EXPECT_EQ(copy.of("anna"), 0U);
}

}  // namespace
}  // namespace standin
