// The stiff suite (estimation/self_test.h), each case by its name; and tests/bench/stiff.md holds the same cases.
#include "estimation/self_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>

namespace standin {
namespace {

class Stiff : public testing::TestWithParam<std::size_t> {};

TEST_P(Stiff, Case) {
  const SelfTestCase test_case = self_test_cases()[GetParam()];
  const SelfTestOutcome outcome = run_self_test(test_case);
  EXPECT_TRUE(outcome.passed) << test_case.name << "\nexpected: " << test_case.expected << "\ngot: " << outcome.got;
}

std::string test_name(const testing::TestParamInfo<std::size_t>& info) {
  std::string name = self_test_cases()[info.param].name;
  for (char& letter : name)
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0) letter = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Fit, Stiff, testing::Range<std::size_t>(0, self_test_cases().size()), test_name);

TEST(StiffTable, HoldsEveryCaseAsItIsStated) {
  std::stringstream table;
  table << std::ifstream(STANDIN_SOURCE_DIR "/tests/bench/stiff.md").rdbuf();
  const auto cases = self_test_cases();
  for (const SelfTestCase& test_case : cases)
    EXPECT_NE(table.str().find("| " + test_case.name + " | " + test_case.expected + " |"), std::string::npos) << test_case.name;
  std::size_t rows = 0;
  for (std::string line; std::getline(table, line);) rows += line.starts_with("| ") ? 1 : 0;
  EXPECT_EQ(rows, cases.size() + 1) << "one row a case, and the head";
}

}  // namespace
}  // namespace standin
