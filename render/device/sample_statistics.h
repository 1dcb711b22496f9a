// From repeated measurements of one frame to one sample, apart from clocks so that it can be tested with made-up times.
#pragma once

#include <span>

#include "render/device/frame_timer.h"

namespace standin {

/// One draw by two clocks: CPU time of the thread, and wall time.
struct Duration {
  double cpu_ms = 0.0;
  double wall_ms = 0.0;
  /// The thread was off the processor for part of it.
  [[nodiscard]] bool contaminated() const { return wall_ms > 1.1 * cpu_ms; }
};

/// A frame and the reference frame drawn just before it.
struct Repeat {
  Duration reference;
  Duration frame;
  [[nodiscard]] bool contaminated() const { return reference.contaminated() || frame.contaminated(); }
};

/// What of it counts by this clock: by the wall clock, both are the wall time, and nothing tells that somebody else ran.
[[nodiscard]] inline Duration on_clock(const Duration& duration, Clock clock) {
  return clock == Clock::kThreadCpu ? duration : Duration{duration.wall_ms, duration.wall_ms};
}

/// Thread CPU time where the thread worked for at least half the wall time of one of these draws, wall time otherwise. `durations` must not
/// be empty.
[[nodiscard]] Clock fitting_clock(std::span<const Duration> durations);
[[nodiscard]] double least_ms(std::span<const Duration> durations, Clock clock);

/// Whether to draw once more: until `wanted` clean repeats, with at most twice as many draws.
[[nodiscard]] bool needs_another(std::span<const Repeat> repeats, int wanted);
/// Of the clean repeats; of all where none is clean (CPU times are still close then). `repeats` must not be empty.
[[nodiscard]] FrameSample summarise(std::span<const Repeat> repeats, double reference_ms);

}  // namespace standin
