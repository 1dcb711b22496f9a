// The fit's behaviour on stiff and extreme data, stated case by case: `calibrate --self-test` prints it on any machine, a test runs it.
//
// Each case makes its frames from known costs, fits them, and holds the outcome against what is expected: a usable model with its warnings,
// or an error that says what is missing.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace standin {

struct SelfTestOutcome {
  std::string got;
  bool passed = false;
};

struct SelfTestCase {
  std::string name;
  std::string expected;
  std::function<SelfTestOutcome()> run;  // may throw
};

[[nodiscard]] std::vector<SelfTestCase> self_test_cases();
/// An exception is an outcome, and a failed one.
[[nodiscard]] SelfTestOutcome run_self_test(const SelfTestCase& test_case);

}  // namespace standin
