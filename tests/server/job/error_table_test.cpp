#include "server/error_table.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace standin {
namespace {

TEST(ErrorTable, EveryWordHasOneRowAndAName) {
  std::set<std::string_view> names;
  for (int i = 0; i <= static_cast<int>(ErrorWord::kInternal); ++i) {
    const ErrorRow& row = error_row(static_cast<ErrorWord>(i));
    EXPECT_EQ(static_cast<int>(row.word), i);
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(row.exit_code == 2 || row.exit_code == 3) << row.name;
    EXPECT_GE(row.http_status, 400);
  }
}

}  // namespace
}  // namespace standin
