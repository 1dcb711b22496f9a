// Images in and out, through OpenImageIO (nothing else includes it).
//
// Pixels are RGBA8, rows from the top, straight alpha, sRGB-encoded colour as stored; grey and RGB inputs are widened, alpha 255 where a
// file has none.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "render/scene/scene.h"

namespace standin {

/// Throws Failure(kFileMissing, kFileBroken).
[[nodiscard]] Texture read_image(const std::filesystem::path& file);
/// `bytes`: a whole PNG, JPEG ... file in memory; `name` is for messages.
[[nodiscard]] Texture decode_image(std::span<const std::uint8_t> bytes, const std::string& name);
/// Deterministic PNG (no time stamp, compression level 1).
[[nodiscard]] std::string encode_png(const Texture& image);

}  // namespace standin
