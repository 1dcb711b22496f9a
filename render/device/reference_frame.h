// The fixed frame that measures how fast the host is right now: its speed steps by up to 1.4x within a minute, and a picture that never
// changes shows by how much.
//
// Built in, so that it is the same on every machine and in every version that reads the same target files: a textured relief and a field of
// boxes, 2,800 triangles and 256 x 256 mostly trilinear pixels: the mix of a real frame in 3 ms, so that it can be drawn before every
// repeat.
#pragma once

#include "render/device/renderer.h"

namespace standin {

[[nodiscard]] Scene make_reference_scene();

class ReferenceFrame {
 public:
  /// The context must be current, stay current in this thread and outlive it.
  explicit ReferenceFrame(Context& context);
  FrameCounts draw() { return renderer_.draw(view_, everything_); }
  [[nodiscard]] Texture read_pixels() { return renderer_.read_pixels(); }

 private:
  Scene scene_;
  Renderer renderer_;
  View view_;
  DrawList everything_;
};

}  // namespace standin
