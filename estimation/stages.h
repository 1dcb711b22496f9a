// Stages of a device that draws (thesis 5.2.1 adds them all up): what moves and sets up geometry, what fills pixels, and what neither
// hides.
//
// Where one processor does all the work the stages' times add up. A device that works on them side by side is as slow as the slower one;
// which of the two a machine is, calibration finds out by comparing both models (calibrate.h), it is not assumed.
#pragma once

#include <cstddef>

namespace standin {

enum class Term : std::size_t;

enum class Stage { kShared, kGeometry, kFill };

enum class Combination {
  kSum,  // shared + geometry + fill
  kMax,  // shared + max(geometry, fill)
};

/// Pixels fill, the frame itself is shared, all else (draws, switches, triangles) is geometry.
[[nodiscard]] Stage stage_of(Term term);

}  // namespace standin
