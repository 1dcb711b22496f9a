#include "render/base/staged_file.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>

#include "render/base/error.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

bool is_running(pid_t process) {
  return ::kill(process, 0) == 0 || errno != ESRCH;
}

// The process id that `name` ends in after `stem`; 0 where it is no such name.
pid_t process_in(std::string_view name, std::string_view stem) {
  if (!name.starts_with(stem)) return 0;
  name.remove_prefix(stem.size());
  pid_t process = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), process);
  return error == std::errc() && end == name.data() + name.size() && process > 0 ? process : 0;
}

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

// A trailing slash names the folder itself.
fs::path without_slash(const fs::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

}  // namespace

std::string read_file(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || fs::is_directory(file)) throw Failure(ErrorWord::kFileMissing, file.string() + " cannot be read");
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Errors of a stream hide theirs in errno.
std::string why_not_written(const fs::path& staged, const fs::path& file, std::span<const std::string_view> pieces) {
  errno = 0;
  std::ofstream stream(staged, std::ios::binary | std::ios::trunc);
  for (const auto piece : pieces) stream.write(piece.data(), static_cast<std::streamsize>(piece.size()));
  stream.close();
  const int why = errno;
  std::error_code error;
  if (stream) fs::rename(staged, file, error);
  if (stream && !error) return "";
  std::error_code ignored;
  fs::remove(staged, ignored);
  return error ? error.message() : why != 0 ? std::strerror(why) : "no reason is known";
}

void write_file(const fs::path& file, std::span<const std::string_view> pieces) {
  if (!fs::is_directory(folder_of(file)))
    throw Failure(ErrorWord::kFileMissing, "cannot write " + file.string() + ": there is no folder " + folder_of(file).string());
  sweep_abandoned(file);
  if (const std::string why = why_not_written(staged_path(file), file, pieces); !why.empty())
    throw Failure(ErrorWord::kInternal, "cannot write " + file.string() + ": " + why);
}

void write_file(const fs::path& file, std::string_view bytes) {
  write_file(file, std::span(&bytes, 1));
}

fs::path staged_path(const fs::path& path, std::string_view suffix) {
  return without_slash(path).string() + std::string(suffix) + std::to_string(::getpid());
}

std::vector<fs::path> abandoned(const fs::path& path, std::string_view suffix) {
  const fs::path plain = without_slash(path);
  const std::string stem = plain.filename().string() + std::string(suffix);
  std::vector<fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_of(plain), error))
    if (const pid_t process = process_in(entry.path().filename().string(), stem); process != 0 && !is_running(process))
      found.push_back(entry.path());
  std::ranges::sort(found);
  return found;
}

void sweep_abandoned(const fs::path& path, std::string_view suffix) {
  std::error_code ignored;
  for (const auto& staged : abandoned(path, suffix)) fs::remove_all(staged, ignored);
}

}  // namespace standin
