#include "server/job/target_device.h"

#include "render/base/error.h"

namespace standin {

DeviceKind device_kind(const Target& target) {
  return target.machine.device == "egl" ? DeviceKind::kEgl : DeviceKind::kOsMesa;
}

bool device_matches(const Target& target) {
  try {
    return make_context(device_kind(target), 16, 16)->renderer() == target.machine.renderer;
  } catch (const Failure& failure) {
    if (failure.word() != ErrorWord::kDeviceUnavailable) throw;
    return false;
  }
}

}  // namespace standin
