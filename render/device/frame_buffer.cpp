#include "render/device/frame_buffer.h"

#include <algorithm>

#include "render/base/error.h"
#include "render/device/renderer.h"

namespace standin {

FrameBuffer::FrameBuffer(const Gl& gl, int width, int height) : gl_(gl), width_(width), height_(height) {
  gl_.CreateRenderbuffers(2, renderbuffers_);
  gl_.NamedRenderbufferStorage(renderbuffers_[0], GL_RGBA8, width, height);
  gl_.NamedRenderbufferStorage(renderbuffers_[1], GL_DEPTH_COMPONENT32F, width, height);
  gl_.CreateFramebuffers(1, &framebuffer_);
  gl_.NamedFramebufferRenderbuffer(framebuffer_, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, renderbuffers_[0]);
  gl_.NamedFramebufferRenderbuffer(framebuffer_, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, renderbuffers_[1]);
  if (gl_.CheckNamedFramebufferStatus(framebuffer_, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw Failure(ErrorWord::kDeviceUnavailable,
                  "the device gives no framebuffer of " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
  }
}

FrameBuffer::~FrameBuffer() {
  gl_.DeleteFramebuffers(1, &framebuffer_);
  gl_.DeleteRenderbuffers(2, renderbuffers_);
}

void FrameBuffer::begin() {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.Viewport(0, 0, width_, height_);
  gl_.ClearColor(kBackground.r, kBackground.g, kBackground.b, 0.0F);
  gl_.ClearDepth(0.0);  // reversed depth: 0 is infinitely far
  gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

Texture FrameBuffer::read() {
  Texture image{.name = "frame", .width = width_, .height = height_, .rgba = {}};
  const std::size_t row = std::size_t{4} * width_;
  image.rgba.resize(row * height_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.ReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  for (int y = 0; y < height_ / 2; ++y) {
    const auto top = image.rgba.begin() + static_cast<std::ptrdiff_t>(row * y);
    const auto bottom = image.rgba.begin() + static_cast<std::ptrdiff_t>(row * (height_ - 1 - y));
    std::swap_ranges(top, top + static_cast<std::ptrdiff_t>(row), bottom);
  }
  return image;
}

}  // namespace standin
