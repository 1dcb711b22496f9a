#include "server/files/output_folder.h"

#include <fstream>

#include "render/base/error.h"
#include "render/base/staged_file.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

// Names the job whose result a folder holds; hidden, since users need not read it.
constexpr const char* kJobFile = ".standin-job";
// A result that is being replaced; between two renames it is the only one.
constexpr const char* kReplaced = ".old-";

bool holds_job(const fs::path& folder, const std::string& job) {
  return fs::is_regular_file(folder / kJobFile) && read_file(folder / kJobFile) == job;
}

// Brings back a result whose replacement was killed halfway, and removes what else killed processes left.
void clean_up_after_killed(const fs::path& folder) {
  std::error_code ignored;
  if (const auto replaced = abandoned(folder, kReplaced); !replaced.empty() && !fs::exists(folder))
    fs::rename(replaced.back(), folder, ignored);
  sweep_abandoned(folder, kReplaced);
  sweep_abandoned(folder);
}

}  // namespace

OutputFolder::OutputFolder(fs::path folder, std::string job) : folder_(std::move(folder)), staging_(staged_path(folder_)) {
  clean_up_after_killed(folder_);
  if (fs::exists(folder_) && !fs::is_directory(folder_))
    throw Failure(ErrorWord::kOutputOccupied, folder_.string() + " exists and is not a folder");
  if (fs::exists(folder_) && !fs::is_empty(folder_) && !holds_job(folder_, job))
    throw Failure(ErrorWord::kOutputOccupied, "output folder " + folder_.string() + " holds another job or other files; name an empty one");
  try {
    fs::create_directories(staging_);
    write(kJobFile, job);
  } catch (const fs::filesystem_error& error) {
    throw Failure(ErrorWord::kBadUsage, "output folder " + folder_.string() + " cannot be made: " + error.code().message());
  }
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!committed_) fs::remove_all(staging_, ignored);
}

void OutputFolder::write(const std::string& name, std::string_view bytes) const {
  const fs::path file = staging_ / name;
  std::ofstream stream(file, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) throw Failure(ErrorWord::kInternal, "cannot write " + file.string());
}

void OutputFolder::commit() {
  const fs::path old = staged_path(folder_, kReplaced);
  const bool replaces = fs::exists(folder_);
  if (replaces) fs::rename(folder_, old);
  fs::rename(staging_, folder_);
  committed_ = true;
  std::error_code ignored;
  if (replaces) fs::remove_all(old, ignored);
}

}  // namespace standin
