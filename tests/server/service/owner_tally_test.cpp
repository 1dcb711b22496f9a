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

// An event stream belongs to the event loop, which may let it go last.
TEST(OwnerTally, WhatIsHeldMayOutliveIt) {
  std::unique_ptr<OwnerTally::Hold> hold;
  {
    const OwnerTally tally;
    hold = tally.hold("anna");
  }
  hold.reset();
}

}  // namespace
}  // namespace standin
