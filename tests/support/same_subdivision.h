// Two subdivisions held against each other, field by field.
#pragma once

#include <gtest/gtest.h>

#include "placement/view_space/subdivision.h"

namespace standin::test {

inline void expect_same(const Subdivision& a, const Subdivision& b) {
  ASSERT_EQ(a.cells.size(), b.cells.size());
  for (std::size_t c = 0; c < a.cells.size(); ++c) {
    EXPECT_EQ(a.cells[c].key, b.cells[c].key);
    EXPECT_EQ(a.cells[c].worst_predicted_ms, b.cells[c].worst_predicted_ms);
    EXPECT_EQ(a.cells[c].worst_interval, b.cells[c].worst_interval);
  }
  EXPECT_EQ(a.intervals, b.intervals);
  ASSERT_EQ(a.cpvs.size(), b.cpvs.size());
  for (std::size_t p = 0; p < a.cpvs.size(); ++p) {
    EXPECT_EQ(a.cpvs[p].cell, b.cpvs[p].cell);
    EXPECT_EQ(a.cpvs[p].interval, b.cpvs[p].interval);
    EXPECT_EQ(a.cpvs[p].pixels_capped, b.cpvs[p].pixels_capped);
    EXPECT_EQ(a.cpvs[p].constant_ms, b.cpvs[p].constant_ms);
    EXPECT_EQ(a.cpvs[p].predicted_ms, b.cpvs[p].predicted_ms);
    EXPECT_EQ(a.cpvs[p].first_term, b.cpvs[p].first_term);
    EXPECT_EQ(a.cpvs[p].term_count, b.cpvs[p].term_count);
  }
  ASSERT_EQ(a.terms.size(), b.terms.size());
  for (std::size_t t = 0; t < a.terms.size(); ++t) {
    EXPECT_EQ(a.terms[t].object, b.terms[t].object);
    EXPECT_EQ(a.terms[t].predicted_ms, b.terms[t].predicted_ms);
  }
}

}  // namespace standin::test
