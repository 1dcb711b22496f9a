#include "server/service/catalogue.h"

#include "render/base/error.h"

namespace standin {

namespace fs = std::filesystem;

void Catalogue::refresh(std::chrono::seconds settle) {
  if (folder_.empty()) return;
  std::map<std::string, Entry> found;
  std::error_code gone;
  for (const auto& entry : fs::directory_iterator(folder_, gone)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with('.') || entry.is_symlink(gone) || !entry.is_regular_file(gone)) continue;
    const auto written = entry.last_write_time(gone);
    const auto bytes = entry.file_size(gone);
    if (gone) continue;
    const auto known = entries_.find(name);
    if (known != entries_.end() && known->second.written == written && known->second.file.bytes == bytes)
      found[name] = known->second;
    else if (fs::file_time_type::clock::now() - written >= settle)
      take(entry.path(), {written, {name, bytes, ""}}, found);
  }
  const std::scoped_lock lock(mutex_);
  entries_ = std::move(found);
}

// A file that cannot be read is not offered.
void Catalogue::take(const fs::path& file, Entry entry, std::map<std::string, Entry>& found) {
  try {
    entry.file = blobs_.copy(file, entry.file.name);
    found[entry.file.name] = entry;
  } catch (const Failure& failure) {
    log_(std::string("not offered: ") + failure.what());
  }
}

std::optional<StoredFile> Catalogue::find(const std::string& name) const {
  const std::scoped_lock lock(mutex_);
  const auto found = entries_.find(name);
  return found == entries_.end() ? std::nullopt : std::optional(found->second.file);
}

std::vector<StoredFile> Catalogue::files() const {
  const std::scoped_lock lock(mutex_);
  std::vector<StoredFile> files;
  for (const auto& [name, entry] : entries_) files.push_back(entry.file);
  return files;
}

}  // namespace standin
