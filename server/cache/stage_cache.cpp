#include "server/cache/stage_cache.h"

#include <signal.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

#include "render/base/staged_file.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "standin\n";
constexpr std::uint32_t kLayout = 1;
constexpr std::string_view kPartial = ".partial-";

std::string header_of(const Fingerprint& name, std::string_view payload) {
  ByteWriter header;
  header.raw(kMagic);
  header.value(kLayout);
  header.value(name);
  header.value(std::uint64_t{payload.size()});
  header.value(fingerprint_of(payload));
  return header.bytes();
}

std::size_t header_size() {
  static const std::size_t size = header_of({}, {}).size();
  return size;
}

// The next `size` bytes; fewer where the file ends.
std::string next_bytes(std::ifstream& stream, std::size_t size) {
  std::string bytes(size, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

// "": written.
std::string write_whole(const fs::path& staged, const fs::path& file, std::string_view header, std::string_view payload) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  return error ? error.message() : why_not_written(staged, file, std::array{header, payload});
}

// That the header says follow it; nothing where it is no header.
std::optional<std::uint64_t> payload_size(std::string_view header) {
  if (header.size() != header_size()) return std::nullopt;
  ByteReader bytes(header);
  (void)bytes.raw(kMagic.size() + sizeof kLayout + sizeof(Fingerprint));
  return bytes.value<std::uint64_t>();
}

bool is_entry_name(std::string_view name) {
  return name.size() == 64 && name.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

// Of a file HEX.partial-COUNT-PROCESS that is being written, or was when its process was killed; 0: no such file.
pid_t writer_of(std::string_view name) {
  if (name.size() <= 64 + kPartial.size() || !is_entry_name(name.substr(0, 64)) || !name.substr(64).starts_with(kPartial)) return 0;
  name.remove_prefix(name.rfind('-') + 1);
  pid_t process = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), process);
  return error == std::errc() && end == name.data() + name.size() ? process : 0;
}

bool is_running(pid_t process) {
  return ::kill(process, 0) == 0 || errno != ESRCH;
}

struct Entry {
  fs::path file;
  fs::path name;     // STAGE/HEX
  pid_t writer = 0;  // of an unfinished one
};

// What in the folder is ours, whichever process wrote it.
std::vector<Entry> entries_of(const fs::path& folder) {
  std::vector<Entry> entries;
  std::error_code error;
  for (const auto& stage : fs::directory_iterator(folder, error)) {
    if (!stage.is_directory(error)) continue;
    for (const auto& file : fs::directory_iterator(stage.path(), error)) {
      const std::string name = file.path().filename().string();
      const pid_t writer = writer_of(name);
      if (is_entry_name(name) || writer > 0) entries.push_back({file.path(), stage.path().filename() / name, writer});
    }
  }
  return entries;
}

// Throws where a file cannot be made in the folder, with the reason. Each probe has a name of its own, so that threads may open the folder
// at the same time.
void require_writable(const fs::path& folder) {
  static std::atomic<std::uint64_t> probes{0};
  const fs::path probe = folder / ("probe-" + std::to_string(probes++) + "-" + std::to_string(::getpid()));
  const std::string why = write_whole(staged_path(probe), probe, "", "");
  if (!why.empty()) throw Failure(ErrorWord::kBadUsage, "--cache " + folder.string() + " cannot be written to: " + why);
  std::error_code ignored;
  fs::remove(probe, ignored);
}

}  // namespace

StageCache::StageCache(fs::path folder, const Fingerprint& build) : folder_(std::move(folder)), build_(build) {
  require_writable(folder_);
}

Fingerprint StageCache::name_of(const CacheStage& stage, const Fingerprint& inputs) const {
  return Fingerprinter().add(build_).add(stage.name).add(stage.format).add(inputs).fingerprint();
}

fs::path StageCache::file_of(const CacheStage& stage, const Fingerprint& inputs) const {
  return folder_ / stage.name / name_of(stage, inputs).hex();
}

// A length that is not the file's is believed by nobody: no memory is asked for on a damaged entry's word.
std::optional<std::string> StageCache::read(const CacheStage& stage, const Fingerprint& name) const try {
  const fs::path file = folder_ / stage.name / name.hex();
  std::error_code error;
  const auto size = fs::file_size(file, error);  // an error for what is no file
  if (error) return std::nullopt;
  std::ifstream stream(file, std::ios::binary);
  const std::string header = next_bytes(stream, header_size());
  const auto claimed = payload_size(header);
  if (!claimed || size < header.size() || *claimed != size - header.size()) return std::nullopt;
  std::string payload = next_bytes(stream, *claimed);
  if (header != header_of(name, payload)) return std::nullopt;
  return payload;
} catch (const std::bad_alloc&) {
  return std::nullopt;  // no stage of ours wrote more than it could hold
} catch (const std::length_error&) {
  return std::nullopt;
}

void StageCache::keep(const CacheStage& stage, const Fingerprint& inputs, std::string_view payload) {
  const Fingerprint name = name_of(stage, inputs);
  const fs::path file = folder_ / stage.name / name.hex();
  const fs::path staged = staged_path(file, std::string(kPartial) + std::to_string(staged_++) + "-");
  const std::string why_not = write_whole(staged, file, header_of(name, payload), payload);
  note_kept(stage, name, header_size() + payload.size(), why_not);
}

void StageCache::note_hit(const CacheStage& stage, const Fingerprint& name, std::size_t bytes, bool counts) {
  const std::scoped_lock lock(mutex_);
  CacheCounts& of = figures_.stages[std::string(stage.name)];
  of.hits += counts ? 1 : 0;
  of.bytes_read += header_size() + bytes;
  used_.insert(fs::path(stage.name) / name.hex());
}

void StageCache::note_kept(const CacheStage& stage, const Fingerprint& name, std::size_t bytes, const std::string& why_not) {
  const std::scoped_lock lock(mutex_);
  CacheCounts& of = figures_.stages[std::string(stage.name)];
  ++of.misses;
  if (why_not.empty()) {
    of.bytes_written += bytes;
    used_.insert(fs::path(stage.name) / name.hex());
  } else if (figures_.write_failures++ == 0) {
    figures_.why_not_written = why_not;
  }
}

void StageCache::remove_unused() {
  const std::scoped_lock lock(mutex_);
  for (const Entry& entry : entries_of(folder_)) {
    if (used_.contains(entry.name) || (entry.writer > 0 && is_running(entry.writer))) continue;
    std::error_code error;
    if (fs::remove(entry.file, error)) ++figures_.removed_entries;
  }
}

CacheFigures StageCache::figures() const {
  const std::scoped_lock lock(mutex_);
  CacheFigures figures = figures_;
  for (const Entry& entry : entries_of(folder_)) {
    std::error_code error;
    const auto bytes = fs::file_size(entry.file, error);
    if (!error) figures.folder_bytes += bytes;
  }
  return figures;
}

}  // namespace standin
