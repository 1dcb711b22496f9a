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
Repeat measure(const Draw& draw) {
  const double wall_ms = clock_ms(CLOCK_MONOTONIC);
  const double cpu_ms = clock_ms(CLOCK_THREAD_CPUTIME_ID);
  draw();
  return {.cpu_ms = clock_ms(CLOCK_THREAD_CPUTIME_ID) - cpu_ms, .wall_ms = clock_ms(CLOCK_MONOTONIC) - wall_ms};
}

// The host's present speed: the reference frame, timed anew whenever the last time is a quarter of a second old.
class HostSpeed {
 public:
  explicit HostSpeed(Context& context) : reference_(context) {
    reference_.draw();  // compiles
    refresh(kFirstDraws);
  }

  void refresh_if_stale() {
    if (clock_ms(CLOCK_MONOTONIC) - measured_at_ms_ > kStale_ms) refresh(kDraws);
  }
  /// Forgets all reference times but the latest.
  void begin_window() { window_ms_ = {window_ms_.back()}; }
  [[nodiscard]] double least_of_window_ms() const { return *std::min_element(window_ms_.begin(), window_ms_.end()); }

 private:
  static constexpr double kStale_ms = 250.0;
  static constexpr int kDraws = 3;        // 6 % of the time at 5 ms each
  static constexpr int kFirstDraws = 25;  // what a whole calibration is normalised to

  void refresh(int draws) {
    double least_ms = measure([&] { reference_.draw(); }).cpu_ms;
    for (int i = 1; i < draws; ++i) least_ms = std::min(least_ms, measure([&] { reference_.draw(); }).cpu_ms);
    window_ms_.push_back(least_ms);
    measured_at_ms_ = clock_ms(CLOCK_MONOTONIC);
  }

  ReferenceFrame reference_;
  std::vector<double> window_ms_;
  double measured_at_ms_ = 0.0;
};

class CpuFrameTimer final : public FrameTimer {
 public:
  CpuFrameTimer(Context& context, const TimingProtocol& protocol)
      : protocol_(protocol),
        host_(context),
        reference_ms_(protocol.reference_ms > 0.0 ? protocol.reference_ms : host_.least_of_window_ms()) {}

  [[nodiscard]] FrameSample time(Renderer& renderer, const View& view, const DrawList& list) override {
    for (int i = 0; i < protocol_.warm_up; ++i) renderer.draw(view, list);
    host_.refresh_if_stale();
    host_.begin_window();
    std::vector<Repeat> repeats;
    while (needs_another(repeats, protocol_.repeats)) {
      host_.refresh_if_stale();
      repeats.push_back(measure([&] { renderer.draw(view, list); }));
    }
    return summarise(repeats, reference_ms_ / host_.least_of_window_ms());
  }

  [[nodiscard]] double reference_ms() const override { return reference_ms_; }

 private:
  TimingProtocol protocol_;
  HostSpeed host_;
  double reference_ms_;
};

class FakeFrameTimer final : public FrameTimer {
 public:
  explicit FakeFrameTimer(std::function<double(const FrameCounts&)> milliseconds) : milliseconds_(std::move(milliseconds)) {}

  [[nodiscard]] FrameSample time(Renderer& renderer, const View& view, const DrawList& list) override {
    const double ms = milliseconds_(renderer.draw(view, list));
    return {.milliseconds = ms, .raw_milliseconds = ms, .spread = 0.0, .rejected = 0};
  }
  [[nodiscard]] double reference_ms() const override { return 1.0; }

 private:
  std::function<double(const FrameCounts&)> milliseconds_;
};

}  // namespace

std::unique_ptr<FrameTimer> make_cpu_frame_timer(Context& context, const TimingProtocol& protocol) {
  if (protocol.warm_up < 0 || protocol.repeats < 1 || !(protocol.reference_ms >= 0.0)) {
    throw Failure(ErrorWord::kBadUsage, "timing protocol of " + std::to_string(protocol.warm_up) + " warm-up draws, " +
                                            std::to_string(protocol.repeats) + " repeats and a reference of " +
                                            std::to_string(protocol.reference_ms) + " ms: need >= 0, >= 1 and >= 0");
  }
  return std::make_unique<CpuFrameTimer>(context, protocol);
}

std::unique_ptr<FrameTimer> make_fake_frame_timer(std::function<double(const FrameCounts&)> milliseconds) {
  return std::make_unique<FakeFrameTimer>(std::move(milliseconds));
}

}  // namespace standin
