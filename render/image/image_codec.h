// What the image plugin offers, as a table of functions.
//
// OpenImageIO resolves 260 shared libraries and costs 0.3 s at process start, so it is linked into a module of its own that image_io.cpp
// opens on first use. No exception crosses this border: each function returns "" or the sentence that says what is wrong.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "render/scene/scene.h"

namespace standin {

struct ImageCodec {
  std::string (*read)(const std::string& file, Texture& image);
  std::string (*decode)(const std::uint8_t* bytes, std::size_t size, Texture& image);
  std::string (*encode_png)(const Texture& image, std::string& png);
};

/// Name of the module's one exported function, of type `const ImageCodec* ()`.
inline constexpr char kImageCodecSymbol[] = "standin_image_codec";
inline constexpr char kImageModule[] = "libstandin_oiio.so";

}  // namespace standin
