// A scene of several files (a glTF with its buffers and textures, an OBJ with its materials) comes as one ZIP archive.
//
// Archives are hostile until proven otherwise: no path leaves the folder, no link or device is made, and what comes out is counted as it
// comes, whatever the archive's headers say.
#pragma once

#include <cstdint>
#include <filesystem>

#include "render/base/work.h"

namespace standin {

struct BundleLimits {
  std::uint64_t bytes = std::uint64_t{4} << 30;  // of all files, unpacked
  std::uint64_t files = 20'000;
};

[[nodiscard]] bool is_bundle(const std::filesystem::path& file);
/// Unpacks into the folder, which it makes, and returns the one scene file that lies highest in it. Throws Failure(kFileBroken) where it is
/// no archive, or has no scene, or several at its highest level; Failure(kUriForbidden) naming an entry that leaves the folder or is no
/// file; Failure(kTooLarge).
[[nodiscard]] std::filesystem::path unpack_bundle(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                                  const BundleLimits& limits, const WorkBudget& budget);

}  // namespace standin
