// Measured steps run only where the device and its GL renderer are the target's; planning accepts any target.
#pragma once

#include "estimation/time_model.h"
#include "render/device/context.h"

namespace standin {

[[nodiscard]] DeviceKind device_kind(const Target& target);
/// Opens the target's kind of device and compares; false where it is missing or another.
[[nodiscard]] bool device_matches(const Target& target);

}  // namespace standin
