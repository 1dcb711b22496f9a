// How long a frame takes: the timing protocol.
//
// Thread CPU time up to glFinish, after warm-up draws; wall time where the device works outside the calling thread (a GPU, or llvmpipe with
// threads of its own), whose CPU time would say little. The host's speed steps by up to 1.4x within a minute and its caches are shared, so
// each repeat draws a fixed reference frame just before the frame, and
//
//   milliseconds = reference_ms * median over the repeats of (frame / reference)
//
// where reference_ms is that of the calibration; a calibration itself uses the least reference time of its own start. On a machine with
// other work this varies by 3.7 % from sample to sample, least frame over least reference by 9 %, the least frame alone by 15 % (measured,
// 9 repeats). Repeats whose wall time exceeds 1.1x their CPU time are contaminated (somebody else ran) and repeated, with at most twice as
// many draws as asked for. Tests use the fake timer: deterministic, a function of the counts.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "render/device/renderer.h"
#include "render/device/timing_lock.h"

namespace standin {

struct FrameSample {
  double milliseconds = 0.0;        // median of the repeats, each normalised by its reference frame
  double raw_milliseconds = 0.0;    // minimum of the repeats, as measured
  double spread = 0.0;              // interquartile range of the normalised repeats over their median
  int rejected = 0;                 // contaminated repeats
  double spent_milliseconds = 0.0;  // by all repeats and their reference frames
};

enum class Clock { kThreadCpu, kWall };
/// "thread_cpu", "wall": what target files say.
[[nodiscard]] std::string_view clock_name(Clock clock);
[[nodiscard]] std::optional<Clock> clock_named(std::string_view name);

class FrameTimer {
 public:
  virtual ~FrameTimer() = default;
  [[nodiscard]] virtual FrameSample time(Renderer& renderer, const View& view, const DrawList& list) = 0;
  /// Milliseconds of the reference frame that samples are normalised to; what a target file stores.
  [[nodiscard]] virtual double reference_ms() const = 0;
  [[nodiscard]] virtual Clock clock() const = 0;
};

struct TimingProtocol {
  int warm_up = 1;            // the first draw of a new state compiles shader variants: 10-300 ms
  int repeats = 9;            // >= 1
  double reference_ms = 0.0;  // of the calibration; 0: this is the calibration, normalise to the reference time of its start
  std::optional<Clock> clock = std::nullopt;  // of the calibration; none: this is the calibration, find out (sample_statistics.h)
};

/// The context must be current, stay current in this thread and outlive the timer. Throws Failure(kBadUsage) for a protocol out of range.
[[nodiscard]] std::unique_ptr<FrameTimer> make_frame_timer(Context& context, const TimingProtocol& protocol);
/// milliseconds = f(counts of the frame); draws the frame once. reference_ms() is 1.
[[nodiscard]] std::unique_ptr<FrameTimer> make_fake_frame_timer(std::function<double(const FrameCounts&)> milliseconds);

}  // namespace standin
