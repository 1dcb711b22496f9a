// The timed frames of a calibration as a file (CSV), so that a fit can be repeated anywhere, byte for byte, and looked at with any tool.
//
// Lines "# key: value" name the machine. Then a header row and a row per frame: its scene ("group") and whether that is the designed one,
// its milliseconds, how far its repeats spread, the seconds timed until then, the pixels that the device counted, and its features by name.
// Numbers are the shortest that read back as they were. Frames that the fit passes over are here as well.
#pragma once

#include <filesystem>
#include <vector>

#include "estimation/calibrate.h"

namespace standin {

struct CalibrationSamples {
  Machine machine;
  std::string scenes;  // names of those that were asked about, with commas between; empty: the built-in ones
  std::vector<TimedFrame> frames;
};

/// Whole or not at all.
void write_samples(const CalibrationSamples& samples, const std::filesystem::path& file);
/// Throws Failure(kFileMissing), or Failure(kFileBroken) naming the line and what is wrong with it: no header, another number of columns,
/// what is no finite number >= 0. Times that no fit can use are the fit's to refuse.
[[nodiscard]] CalibrationSamples read_samples(const std::filesystem::path& file);

}  // namespace standin
