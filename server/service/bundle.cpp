#include "server/service/bundle.h"

#include <archive.h>
#include <archive_entry.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "render/base/error.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBlock = 64 * 1024;

struct CloseArchive {
  void operator()(archive* reader) const { archive_read_free(reader); }
};

std::string lower_case_ending(const fs::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending;
}

bool is_scene(const fs::path& file) {
  static const std::set<std::string> kEndings = {".gltf", ".glb", ".obj", ".ply", ".stl", ".ac", ".acc", ".dae", ".fbx", ".3ds"};
  return kEndings.contains(lower_case_ending(file));
}

class Unpacker {
 public:
  Unpacker(const fs::path& archive_file, const fs::path& folder, const BundleLimits& limits, const WorkBudget& budget)
      : name_(archive_file.filename().string()), folder_(folder), limits_(limits), budget_(budget), reader_(archive_read_new()) {
    archive_read_support_format_zip(reader_.get());
    if (archive_read_open_filename(reader_.get(), archive_file.c_str(), kBlock) != ARCHIVE_OK) broken();
  }

  std::vector<fs::path> run() {
    std::vector<fs::path> scenes;
    archive_entry* entry = nullptr;
    for (std::uint64_t count = 0;; ++count) {
      const int result = archive_read_next_header(reader_.get(), &entry);
      if (result == ARCHIVE_EOF) return scenes;
      if (result != ARCHIVE_OK) broken();
      if (count >= limits_.files) too_large(std::to_string(limits_.files) + " files");
      if (archive_entry_filetype(entry) == AE_IFDIR) continue;
      const fs::path path = path_of(entry);
      write(folder_ / path);
      if (is_scene(path)) scenes.push_back(path);
    }
  }

 private:
  [[noreturn]] void broken() const {
    const char* reason = archive_error_string(reader_.get());
    throw Failure(ErrorWord::kFileBroken,
                  name_ + " is no ZIP archive that can be read: " + (reason == nullptr ? "it ends too early" : reason));
  }
  [[noreturn]] void too_large(const std::string& limit) const {
    throw Failure(ErrorWord::kTooLarge, name_ + " holds more than " + limit + ", unpacked");
  }

  [[nodiscard]] fs::path path_of(archive_entry* entry) const {
    const char* text = archive_entry_pathname_utf8(entry);
    const fs::path path = fs::path(text == nullptr ? "" : text).lexically_normal();
    const bool leaves = path.empty() || path.is_absolute() || *path.begin() == ".." || path.string().find('\\') != std::string::npos;
    if (leaves || archive_entry_filetype(entry) != AE_IFREG)
      throw Failure(ErrorWord::kUriForbidden, name_ + " holds \"" + path.string() + "\", which is no file of its own folder");
    return path;
  }

  void write(const fs::path& file) {
    std::error_code error;
    fs::create_directories(file.parent_path(), error);
    std::ofstream stream(file, std::ios::binary);
    if (error || !stream)
      throw Failure(ErrorWord::kFileBroken, name_ + " holds \"" + file.filename().string() + "\", which cannot be made a file");
    std::array<char, kBlock> block{};
    for (;;) {
      budget_.check();
      const la_ssize_t got = archive_read_data(reader_.get(), block.data(), block.size());
      if (got < 0) broken();
      if (got == 0) break;
      if ((bytes_ += static_cast<std::uint64_t>(got)) > limits_.bytes) too_large(std::to_string(limits_.bytes) + " bytes");
      stream.write(block.data(), got);
    }
    stream.close();
    if (!stream) throw Failure(ErrorWord::kDiskFull, file.filename().string() + " cannot be written");
  }

  std::string name_;
  fs::path folder_;
  BundleLimits limits_;
  const WorkBudget& budget_;
  std::unique_ptr<archive, CloseArchive> reader_;
  std::uint64_t bytes_ = 0;
};

}  // namespace

bool is_bundle(const fs::path& file) {
  return lower_case_ending(file) == ".zip";
}

fs::path unpack_bundle(const fs::path& archive_file, const fs::path& folder, const BundleLimits& limits, const WorkBudget& budget) {
  std::vector<fs::path> scenes = Unpacker(archive_file, folder, limits, budget).run();
  const auto depth = [](const fs::path& path) { return std::distance(path.begin(), path.end()); };
  std::ranges::sort(scenes, [&](const fs::path& a, const fs::path& b) { return std::pair(depth(a), a) < std::pair(depth(b), b); });
  const std::string name = archive_file.filename().string();
  if (scenes.empty()) throw Failure(ErrorWord::kFileBroken, name + " holds no scene (glTF, GLB, OBJ, PLY, STL, AC3D ...)");
  if (scenes.size() > 1 && depth(scenes[1]) == depth(scenes[0]))
    throw Failure(ErrorWord::kFileBroken,
                  name + " holds several scenes, " + scenes[0].string() + " and " + scenes[1].string() + ": one is expected");
  return folder / scenes.front();
}

}  // namespace standin
