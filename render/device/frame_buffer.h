// The pixels a Renderer draws into: RGBA8 colour and 32-bit float depth, off screen, row 0 at the bottom as OpenGL has it.
#pragma once

#include "render/device/gl_functions.h"
#include "render/scene/scene.h"

namespace standin {

class FrameBuffer {
 public:
  FrameBuffer(const Gl& gl, int width, int height);
  ~FrameBuffer();
  FrameBuffer(const FrameBuffer&) = delete;
  FrameBuffer& operator=(const FrameBuffer&) = delete;

  /// Binds it, sets the viewport and clears.
  void begin();
  /// Rows from the top.
  [[nodiscard]] Texture read();

 private:
  const Gl& gl_;
  int width_;
  int height_;
  GLuint renderbuffers_[2] = {0, 0};  // colour, depth
  GLuint framebuffer_ = 0;
};

}  // namespace standin
