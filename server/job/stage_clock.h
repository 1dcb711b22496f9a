// Seconds of each stage and what was left out: the bookkeeping behind metrics.json.
#pragma once

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "render/base/work.h"

namespace standin {

class StageClock {
 public:
  explicit StageClock(const WorkBudget& budget) : budget_(budget) {}

  /// Runs `stage`, adds its wall seconds to `name` and returns its result.
  template <class Stage>
  decltype(auto) run(const std::string& name, Stage&& stage) {
    budget_.check();
    budget_.report(name, 0.0);
    const Timer timer(*this, name);
    return std::forward<Stage>(stage)();
  }

  void leave_out(std::string stage, std::string reason) {
    left_out_.push_back({{"stage", std::move(stage)}, {"reason", std::move(reason)}});
  }
  /// A whole stage that is not run.
  void skip(const std::string& stage, std::string reason) {
    seconds_[stage] = 0.0;
    leave_out(stage, std::move(reason));
  }
  [[nodiscard]] const nlohmann::json& seconds() const { return seconds_; }
  /// Seconds that the stage had taken in all, after each of its runs.
  [[nodiscard]] std::vector<double> laps(const std::string& stage) const {
    const auto found = laps_.find(stage);
    return found != laps_.end() ? found->second : std::vector<double>();
  }
  [[nodiscard]] const nlohmann::json& left_out() const { return left_out_; }

 private:
  class Timer {
   public:
    Timer(StageClock& clock, const std::string& name) : clock_(clock), name_(name) {}
    ~Timer() {
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
      const double seconds = clock_.seconds_.value(name_, 0.0) + elapsed.count();
      clock_.seconds_[name_] = seconds;
      clock_.laps_[name_].push_back(seconds);
      clock_.budget_.report(name_, 1.0);
    }
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;

   private:
    StageClock& clock_;
    std::string name_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  };

  const WorkBudget& budget_;
  nlohmann::json seconds_ = nlohmann::json::object();
  std::map<std::string, std::vector<double>> laps_;
  nlohmann::json left_out_ = nlohmann::json::array();
};

}  // namespace standin
