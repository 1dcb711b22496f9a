#include "render/scene/file_access.h"

#include <array>
#include <fstream>

#include "render/base/error.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decoded(const std::string& uri) {
  std::string plain;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const int high = uri[i] == '%' && i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
    const int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
    if (low < 0) {
      plain += uri[i];
      continue;
    }
    plain += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return plain;
}

// Why `path` may not be followed, or "".
std::string objection(const std::string& path) {
  if (path.empty()) return "is empty";
  if (path.find('\0') != std::string::npos) return "holds a zero byte";
  if (path.front() == '/') return "is absolute";
  if (path.find(':') != std::string::npos) return "has a scheme or a drive";
  for (const auto& step : fs::path(path)) {
    if (step == "..") return "holds a '..'";
  }
  return "";
}

std::string shown(const std::string& path) {
  constexpr std::size_t kMost = 200;
  return path.size() > kMost ? path.substr(0, kMost) + " ..." : path;
}

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  if (c == '/' || c == '_') return 63;
  return -1;
}

}  // namespace

std::vector<std::uint8_t> read_bytes(const fs::path& file) {
  std::error_code failed;
  if (!fs::is_regular_file(file, failed)) throw Failure(ErrorWord::kFileMissing, file.string() + " is not a file");
  std::ifstream in(file, std::ios::binary);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(fs::file_size(file, failed)));
  if (failed || !in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()))) {
    throw Failure(ErrorWord::kFileMissing, file.string() + " cannot be read");
  }
  return bytes;
}

SceneFolder::SceneFolder(const fs::path& scene_file) : folder_(fs::weakly_canonical(fs::absolute(scene_file).parent_path())) {}

fs::path SceneFolder::resolve_uri(const std::string& uri) const {
  return resolve_path(percent_decoded(uri));
}

fs::path SceneFolder::resolve_path(const std::string& path) const {
  std::string slashed = path;
  for (char& c : slashed) {
    if (c == '\\') c = '/';
  }
  std::string wrong = objection(slashed);
  if (wrong.empty()) {
    std::error_code unknown;  // a name that is too long, links in a circle
    fs::path target = fs::weakly_canonical(folder_ / slashed, unknown);
    const fs::path inside = target.lexically_relative(folder_);
    if (!unknown && !inside.empty() && *inside.begin() != "..") return target;
    wrong = unknown ? "names no file: " + unknown.message() : "leads out of " + folder_.string();
  }
  throw Failure(ErrorWord::kUriForbidden,
                "the reference '" + shown(path) + "' " + wrong + "; a scene may only name files in its own folder");
}

bool is_data_uri(const std::string& uri) {
  return uri.starts_with("data:");
}

std::vector<std::uint8_t> decode_data_uri(const std::string& uri, const std::string& place) {
  static constexpr std::string_view kMark = ";base64,";
  const std::size_t mark = uri.find(kMark);
  if (mark == std::string::npos) throw Failure(ErrorWord::kFileBroken, place + " has a data URI that is not base64");
  std::vector<std::uint8_t> bytes;
  bytes.reserve((uri.size() - mark) / 4 * 3);
  std::uint32_t bits = 0;
  int held = 0;
  for (std::size_t i = mark + kMark.size(); i < uri.size() && uri[i] != '='; ++i) {
    const int digit = base64_digit(uri[i]);
    if (digit < 0) throw Failure(ErrorWord::kFileBroken, place + " has a data URI with the character '" + uri[i] + "', which is no base64");
    bits = bits << 6U | static_cast<std::uint32_t>(digit);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> static_cast<unsigned>(held)));
  }
  return bytes;
}

}  // namespace standin
