// TORCS writes AC3D files (.acc) with several textures per surface: the base and up to three lighting layers, often without a file. Assimp
// keeps the last one it reads, which is never the base.
#pragma once

#include <string>
#include <string_view>

namespace standin {

/// The file without the `texture ... tiled|skids|shad` lines.
[[nodiscard]] std::string with_base_textures_only(std::string_view ac3d);

}  // namespace standin
