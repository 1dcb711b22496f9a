// What a fit of the time model found wrong with its frames, in sentences that a user can act on.
#pragma once

#include <string>
#include <vector>

#include "estimation/held_out.h"

namespace standin {

/// Few frames for the terms; terms that the frames hardly tell apart (condition number above a million); times in coarse steps; a lasting
/// change of the machine's speed (frames are taken in the order timed); more than a tenth of the frames far off the others.
[[nodiscard]] std::vector<std::string> fit_warnings(const std::vector<TimedFrame>& frames, const FittedForm& fitted);

}  // namespace standin
