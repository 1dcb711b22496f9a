// How much a folder holds, and how it is kept from growing: the quota of a service's disk.
#pragma once

#include <cstdint>
#include <filesystem>

namespace standin {

/// Of all files below it. Files that come or go meanwhile may or may not count.
[[nodiscard]] std::uint64_t folder_bytes(const std::filesystem::path& folder);
/// Removes the files that were written longest ago, until the rest has at most so many bytes.
void keep_newest(const std::filesystem::path& folder, std::uint64_t most_bytes);

}  // namespace standin
