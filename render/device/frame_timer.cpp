#include "render/device/frame_timer.h"

#include <algorithm>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include "render/base/error.h"
#include "render/device/reference_frame.h"
#include "render/device/sample_statistics.h"

namespace standin {
namespace {

double clock_ms(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

template <typename Draw>
Duration measure(const Draw& draw) {
  const double wall_ms = clock_ms(CLOCK_MONOTONIC);
  const double cpu_ms = clock_ms(CLOCK_THREAD_CPUTIME_ID);
  draw();
  return {.cpu_ms = clock_ms(CLOCK_THREAD_CPUTIME_ID) - cpu_ms, .wall_ms = clock_ms(CLOCK_MONOTONIC) - wall_ms};
}

std::vector<Duration> first_durations(ReferenceFrame& reference) {
  constexpr int kDraws = 50;  // 0.15 s
  reference.draw();           // compiles
  std::vector<Duration> durations;
  for (int i = 0; i < kDraws; ++i) durations.push_back(measure([&] { reference.draw(); }));
  return durations;
}

class DeviceFrameTimer final : public FrameTimer {
 public:
  DeviceFrameTimer(Context& context, const TimingProtocol& protocol) : protocol_(protocol), reference_(context) {
    const std::vector<Duration> durations = first_durations(reference_);
    clock_ = protocol.clock.value_or(fitting_clock(durations));
    if (protocol_.reference_ms == 0.0) protocol_.reference_ms = least_ms(durations, clock_);
  }

  [[nodiscard]] FrameSample time(Renderer& renderer, const View& view, const DrawList& list) override {
    for (int i = 0; i < protocol_.warm_up; ++i) renderer.draw(view, list);
    std::vector<Repeat> repeats;
    while (needs_another(repeats, protocol_.repeats)) {
      const Duration reference = on_clock(measure([&] { reference_.draw(); }), clock_);
      repeats.push_back({.reference = reference, .frame = on_clock(measure([&] { renderer.draw(view, list); }), clock_)});
    }
    return summarise(repeats, protocol_.reference_ms);
  }

  [[nodiscard]] double reference_ms() const override { return protocol_.reference_ms; }
  [[nodiscard]] Clock clock() const override { return clock_; }

 private:
  TimingProtocol protocol_;
  ReferenceFrame reference_;
  Clock clock_ = Clock::kThreadCpu;
};

class FakeFrameTimer final : public FrameTimer {
 public:
  explicit FakeFrameTimer(std::function<double(const FrameCounts&)> milliseconds) : milliseconds_(std::move(milliseconds)) {}

  [[nodiscard]] FrameSample time(Renderer& renderer, const View& view, const DrawList& list) override {
    const double ms = milliseconds_(renderer.draw(view, list));
    return {.milliseconds = ms, .raw_milliseconds = ms, .spread = 0.0, .rejected = 0, .spent_milliseconds = ms};
  }
  [[nodiscard]] double reference_ms() const override { return 1.0; }
  [[nodiscard]] Clock clock() const override { return Clock::kThreadCpu; }

 private:
  std::function<double(const FrameCounts&)> milliseconds_;
};

}  // namespace

std::string_view clock_name(Clock clock) {
  return clock == Clock::kThreadCpu ? "thread_cpu" : "wall";
}

std::optional<Clock> clock_named(std::string_view name) {
  for (const Clock clock : {Clock::kThreadCpu, Clock::kWall})
    if (clock_name(clock) == name) return clock;
  return std::nullopt;
}

std::unique_ptr<FrameTimer> make_frame_timer(Context& context, const TimingProtocol& protocol) {
  if (protocol.warm_up < 0 || protocol.repeats < 1 || !(protocol.reference_ms >= 0.0)) {
    throw Failure(ErrorWord::kBadUsage, "timing protocol of " + std::to_string(protocol.warm_up) + " warm-up draws, " +
                                            std::to_string(protocol.repeats) + " repeats and a reference of " +
                                            std::to_string(protocol.reference_ms) + " ms: need >= 0, >= 1 and >= 0");
  }
  return std::make_unique<DeviceFrameTimer>(context, protocol);
}

std::unique_ptr<FrameTimer> make_fake_frame_timer(std::function<double(const FrameCounts&)> milliseconds) {
  return std::make_unique<FakeFrameTimer>(std::move(milliseconds));
}

}  // namespace standin
