#include "render/device/textures.h"

#include <algorithm>
#include <bit>

#include "render/base/error.h"

namespace standin {
namespace {

void check_size(const Gl& gl, const Texture& texture) {
  GLint limit = 0;
  gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  if (texture.width >= 1 && texture.height >= 1 && texture.width <= limit && texture.height <= limit) return;
  throw Failure(ErrorWord::kDeviceUnavailable, "texture \"" + texture.name + "\" of " + std::to_string(texture.width) + " x " +
                                                   std::to_string(texture.height) + " texels: the device takes 1 to " +
                                                   std::to_string(limit) + " a side");
}

void set_filtering(const Gl& gl, GLuint name, Filtering filtering) {
  const bool trilinear = filtering == Filtering::kTrilinearRepeat;
  gl.TextureParameteri(name, GL_TEXTURE_MIN_FILTER, trilinear ? GL_LINEAR_MIPMAP_LINEAR : GL_NEAREST);
  gl.TextureParameteri(name, GL_TEXTURE_MAG_FILTER, trilinear ? GL_LINEAR : GL_NEAREST);
  const GLint wrap = trilinear ? GL_REPEAT : GL_CLAMP_TO_EDGE;
  gl.TextureParameteri(name, GL_TEXTURE_WRAP_S, wrap);
  gl.TextureParameteri(name, GL_TEXTURE_WRAP_T, wrap);
}

GLuint upload(const Gl& gl, const Texture& texture, Filtering filtering) {
  GLuint name = 0;
  gl.CreateTextures(GL_TEXTURE_2D, 1, &name);
  const auto longer_side = static_cast<unsigned>(std::max(texture.width, texture.height));
  const int levels = filtering == Filtering::kTrilinearRepeat ? static_cast<int>(std::bit_width(longer_side)) : 1;
  gl.TextureStorage2D(name, levels, GL_RGBA8, texture.width, texture.height);
  gl.TextureSubImage2D(name, 0, 0, 0, texture.width, texture.height, GL_RGBA, GL_UNSIGNED_BYTE, texture.rgba.data());
  if (levels > 1) gl.GenerateTextureMipmap(name);
  set_filtering(gl, name, filtering);
  return name;
}

}  // namespace

Textures::Textures(const Gl& gl, std::span<const Texture> textures, Filtering filtering) : gl_(gl) {
  for (const auto& texture : textures) check_size(gl, texture);
  for (const auto& texture : textures) names_.push_back(upload(gl, texture, filtering));
}

Textures::~Textures() {
  gl_.DeleteTextures(static_cast<GLsizei>(names_.size()), names_.data());
}

}  // namespace standin
