// A time model in words: what costs what on this machine, each term beside something that people can picture.
#pragma once

#include <string>
#include <vector>

#include "estimation/calibrate.h"

namespace standin {

/// Sentences, from the frame down to the quad. A cost that the frames leave uncertain by more than half is followed by "(+- so many %)";
/// what was left out is not mentioned.
[[nodiscard]] std::vector<std::string> explain(const FitSummary& fit);

}  // namespace standin
