#include "server/store/blob_store.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "render/base/error.h"
#include "server/store/job_store.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kFlushed = 8 << 20;  // so that the last flush of a large blob does not keep its thread waiting

[[noreturn]] void unwritable(const fs::path& file) {
  const bool full = errno == ENOSPC || errno == EDQUOT;
  throw Failure(full ? ErrorWord::kDiskFull : ErrorWord::kInternal,
                file.filename().string() + " cannot be stored: " + std::strerror(errno));
}

void flush(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const bool flushed = descriptor >= 0 && ::fsync(descriptor) == 0;
  if (descriptor >= 0) ::close(descriptor);
  if (!flushed) unwritable(file);
}

template <class Take>
void for_each_piece(const fs::path& file, Take&& take) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw Failure(ErrorWord::kFileMissing, file.string() + " cannot be read");
  std::vector<char> piece(1 << 20);
  while (stream.read(piece.data(), std::ssize(piece)), stream.gcount() > 0)
    take(std::string_view(piece.data(), static_cast<std::size_t>(stream.gcount())));
}

}  // namespace

BlobStore::BlobStore(fs::path folder) : folder_(std::move(folder)) {
  fs::create_directories(folder_);
  fs::remove_all(folder_ / "incoming");
  fs::create_directories(folder_ / "incoming");
}

fs::path BlobStore::path_of(const std::string& sha256) const {
  return folder_ / sha256.substr(0, 2) / sha256;
}

bool BlobStore::holds(const std::string& sha256) const {
  return fs::exists(path_of(sha256));
}

// Once a job says that it has it, it survives the machine: its bytes and its name are flushed first.
void BlobStore::place(const fs::path& from, const std::string& sha256) const {
  const fs::path to = path_of(sha256);
  fs::create_directories(to.parent_path());
  flush(from);
  if (::link(from.c_str(), to.c_str()) != 0) {
    if (errno != EEXIST) unwritable(to);
    fs::last_write_time(to, fs::file_time_type::clock::now());
    if (fs::file_size(to) == fs::file_size(from)) return;
    fs::remove(to);  // cut by a crash of the machine
    if (::link(from.c_str(), to.c_str()) != 0) unwritable(to);
  }
  fs::last_write_time(to, fs::file_time_type::clock::now());
  flush(to.parent_path());
}

StoredFile BlobStore::adopt(const fs::path& file, const std::string& name) {
  Fingerprinter sum;
  for_each_piece(file, [&](std::string_view piece) { sum.add_bytes(piece.data(), piece.size()); });
  const std::string sha256 = sum.fingerprint().hex();
  place(file, sha256);
  return {name, fs::file_size(file), sha256};
}

StoredFile BlobStore::copy(const fs::path& file, const std::string& name) {
  Incoming incoming(*this);
  for_each_piece(file, [&](std::string_view piece) { incoming.write(piece); });
  return incoming.finish(name);
}

void BlobStore::keep_only(const std::vector<std::string>& in_use, std::chrono::seconds spared) const {
  const auto now = fs::file_time_type::clock::now();
  const std::set<std::string> kept(in_use.begin(), in_use.end());
  for (const auto& shelf : fs::directory_iterator(folder_)) {
    if (shelf.path().filename() == "incoming") continue;
    for (const auto& blob : fs::directory_iterator(shelf.path()))
      if (!kept.contains(blob.path().filename().string()) && now - blob.last_write_time() >= spared) fs::remove(blob.path());
  }
}

BlobStore::Incoming::Incoming(BlobStore& store) : store_(store), file_(store.folder_ / "incoming" / random_id()) {
  descriptor_ = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor_ < 0) unwritable(file_);
}

BlobStore::Incoming::~Incoming() {
  ::close(descriptor_);
  ::unlink(file_.c_str());
}

void BlobStore::Incoming::write(std::string_view piece) {
  sum_.add_bytes(piece.data(), piece.size());
  bytes_ += piece.size();
  unflushed_ += piece.size();
  while (!piece.empty()) {
    const ssize_t written = ::write(descriptor_, piece.data(), piece.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) unwritable(file_);
    piece.remove_prefix(static_cast<std::size_t>(written));
  }
  if (unflushed_ < kFlushed) return;
  unflushed_ = 0;
  if (::fdatasync(descriptor_) != 0) unwritable(file_);
}

StoredFile BlobStore::Incoming::finish(const std::string& name) {
  const std::string sha256 = sum_.fingerprint().hex();
  store_.place(file_, sha256);
  return {name, bytes_, sha256};
}

}  // namespace standin
