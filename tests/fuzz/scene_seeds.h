// Small scenes that between them use all that our glTF reader reads.
#pragma once

#include <map>
#include <string>

namespace standin::fuzz {

/// GLBs, and one glTF with data URIs, by name.
[[nodiscard]] std::map<std::string, std::string> scene_seeds();
/// In other formats, by their ending.
[[nodiscard]] std::map<std::string, std::string> other_scene_seeds();

}  // namespace standin::fuzz
