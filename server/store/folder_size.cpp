#include "server/store/folder_size.h"

#include <algorithm>
#include <vector>

namespace standin {
namespace {

namespace fs = std::filesystem;

struct File {
  fs::file_time_type written;
  fs::path path;
  std::uint64_t bytes = 0;
};

std::vector<File> files_below(const fs::path& folder) {
  std::vector<File> files;
  std::error_code gone;
  for (auto entry = fs::recursive_directory_iterator(folder, gone); entry != fs::recursive_directory_iterator(); entry.increment(gone)) {
    if (gone) break;
    if (!entry->is_regular_file(gone)) continue;
    const auto written = entry->last_write_time(gone);
    const auto bytes = entry->file_size(gone);
    if (!gone) files.push_back({written, entry->path(), bytes});
  }
  return files;
}

}  // namespace

std::uint64_t folder_bytes(const fs::path& folder) {
  std::uint64_t sum = 0;
  for (const File& file : files_below(folder)) sum += file.bytes;
  return sum;
}

void keep_newest(const fs::path& folder, std::uint64_t most_bytes) {
  std::vector<File> files = files_below(folder);
  std::ranges::sort(files, [](const File& a, const File& b) { return a.written > b.written; });
  std::uint64_t sum = 0;
  std::error_code gone;
  for (const File& file : files)
    if ((sum += file.bytes) > most_bytes) fs::remove(file.path, gone);
}

}  // namespace standin
