// A scene for calibration alone (thesis 5.8.1 times frames of the scene at hand, which leave most terms confounded).
//
// In a city whatever has many triangles is also textured, and what is far has small triangles; a time model fitted there alone cannot tell
// what an untextured pixel costs, or a triangle that covers none. Here every kind of surface (plain, textured, masked, with its back sides
// drawn or culled) comes in every
// fineness, from two triangles to sixty thousand, at the same size, and there is a crowd of light draws. Objects stand far apart, in rows
// of one kind, so that clusters of a kind come before the camera at every distance.
#pragma once

#include "render/scene/scene.h"

namespace standin {

/// About 0.6 M triangles in 850 objects; always the same.
[[nodiscard]] Scene make_designed_scene();

}  // namespace standin
