// impostors.glb: what ships. glTF 2.0, y up, metres, one node "imp_<id>" per impostor at its reference viewpoint, unlit, alphaMode MASK,
// one material per atlas page, pages embedded as PNG, nearest filtering. Byte for byte the same for the same set.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "render/impostor/impostor.h"

namespace standin {

[[nodiscard]] std::string encode_impostor_glb(const ImpostorSet& set);

}  // namespace standin
