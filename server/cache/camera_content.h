// A camera's share of what a result depends on: all of its numbers.
#pragma once

#include "render/base/fingerprint.h"
#include "render/view/camera.h"

namespace standin {

inline void add_camera(const Camera& camera, Fingerprinter& to) {
  to.add(camera.fov_y_rad).add(camera.width).add(camera.height).add(camera.near_m);
}

}  // namespace standin
