// Files that appear whole or not at all: they are written beside their place, under a name that holds the process id, and renamed.
//
// A process that is killed leaves what it staged behind. Whoever next writes to the same place sweeps it away, once that process is gone.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace standin {

/// Throws Failure(kFileMissing) naming the file where it cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& file);

/// Writes the pieces, one after the other. Throws Failure(kFileMissing) where the folder does not exist, Failure(kInternal) where it cannot
/// be written to; nothing is left behind then.
void write_file(const std::filesystem::path& file, std::span<const std::string_view> pieces);
void write_file(const std::filesystem::path& file, std::string_view bytes);

/// Writes the pieces to `staged` and renames it to `file`; says why not, and leaves nothing behind, where that cannot be. "": done.
[[nodiscard]] std::string why_not_written(const std::filesystem::path& staged, const std::filesystem::path& file,
                                          std::span<const std::string_view> pieces);

/// `path` + `suffix` + this process' id, e.g. "out.partial-4711".
[[nodiscard]] std::filesystem::path staged_path(const std::filesystem::path& path, std::string_view suffix = ".partial-");
/// Files or folders that processes which no longer run staged for `path`, sorted.
[[nodiscard]] std::vector<std::filesystem::path> abandoned(const std::filesystem::path& path, std::string_view suffix = ".partial-");
/// Removes them; what cannot be removed stays.
void sweep_abandoned(const std::filesystem::path& path, std::string_view suffix = ".partial-");

}  // namespace standin
