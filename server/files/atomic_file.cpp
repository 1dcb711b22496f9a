#include "server/files/atomic_file.h"

#include <openssl/evp.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "render/base/error.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

// Names the job whose result a folder holds; hidden, since users need not read it.
constexpr const char* kJobFile = ".standin-job";

void write_plain(const fs::path& file, std::string_view bytes) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) throw Failure(ErrorWord::kInternal, "cannot write " + file.string());
}

std::string unique_suffix() {
  return ".partial-" + std::to_string(::getpid());
}

bool holds_job(const fs::path& folder, const std::string& job) {
  std::ifstream stream(folder / kJobFile, std::ios::binary);
  return stream && std::string(std::istreambuf_iterator<char>(stream), {}) == job;
}

}  // namespace

std::string read_file(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || fs::is_directory(file)) throw Failure(ErrorWord::kFileMissing, file.string() + " cannot be read");
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write_file(const fs::path& file, std::string_view bytes) {
  const fs::path staged = file.string() + unique_suffix();
  try {
    write_plain(staged, bytes);
    fs::rename(staged, file);
  } catch (const fs::filesystem_error& error) {
    std::error_code ignored;
    fs::remove(staged, ignored);
    throw Failure(ErrorWord::kInternal, "cannot write " + file.string() + ": " + error.code().message());
  }
}

std::string sha256_hex(std::string_view bytes) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int length = 0;
  EVP_Digest(bytes.data(), bytes.size(), digest, &length, EVP_sha256(), nullptr);
  static constexpr char kHex[] = "0123456789abcdef";
  std::string text;
  for (unsigned int i = 0; i < length; ++i) text += {kHex[digest[i] >> 4], kHex[digest[i] & 15]};
  return text;
}

OutputFolder::OutputFolder(fs::path folder, std::string job) : folder_(std::move(folder)), staging_(folder_.string() + unique_suffix()) {
  if (fs::exists(folder_) && !fs::is_directory(folder_))
    throw Failure(ErrorWord::kOutputOccupied, folder_.string() + " exists and is not a folder");
  if (fs::exists(folder_) && !fs::is_empty(folder_) && !holds_job(folder_, job))
    throw Failure(ErrorWord::kOutputOccupied, "output folder " + folder_.string() + " holds another job or other files; name an empty one");
  try {
    fs::create_directories(staging_);
    write_plain(staging_ / kJobFile, job);
  } catch (const fs::filesystem_error& error) {
    throw Failure(ErrorWord::kBadUsage, "output folder " + folder_.string() + " cannot be made: " + error.code().message());
  }
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!committed_) fs::remove_all(staging_, ignored);
}

void OutputFolder::write(const std::string& name, std::string_view bytes) const {
  write_plain(staging_ / name, bytes);
}

void OutputFolder::commit() {
  const fs::path old = folder_.string() + ".old-" + std::to_string(::getpid());
  const bool replaces = fs::exists(folder_);
  if (replaces) fs::rename(folder_, old);
  fs::rename(staging_, folder_);
  committed_ = true;
  std::error_code ignored;
  if (replaces) fs::remove_all(old, ignored);
}

}  // namespace standin
