#include "server/service/worker_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "render/base/error.h"
#include "server/service/work_folder.h"

namespace standin {
namespace {

constexpr std::size_t kMostLine = 64 * 1024;  // of a worker gone mad

class FileActions {
 public:
  FileActions() { posix_spawn_file_actions_init(&actions_); }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;
  posix_spawn_file_actions_t* get() { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

std::string inherited(const char* name, const char* otherwise) {
  const char* value = std::getenv(name);
  return std::string(name) + "=" + (value == nullptr ? otherwise : value);
}

}  // namespace

WorkerProcess::WorkerProcess(const std::filesystem::path& program, const std::filesystem::path& folder) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw Failure(ErrorWord::kInternal, std::string("a worker's pipe: ") + std::strerror(errno));
  FileActions actions;
  const std::string complaints = (folder / kComplaintsFile).string();
  posix_spawn_file_actions_adddup2(actions.get(), ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_addopen(actions.get(), STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(actions.get(), STDERR_FILENO, complaints.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  std::array<std::string, 4> words = {program.string(), "work", folder.string(), std::to_string(::getpid())};
  std::array<char*, 5> arguments = {words[0].data(), words[1].data(), words[2].data(), words[3].data(), nullptr};
  std::array<std::string, 3> variables = {inherited("PATH", "/usr/bin:/bin"), inherited("LANG", "C.UTF-8"),
                                          inherited("LD_LIBRARY_PATH", "")};
  std::array<char*, 4> environment = {variables[0].data(), variables[1].data(), variables[2].data(), nullptr};
  const int error = posix_spawn(&id_, program.c_str(), actions.get(), nullptr, arguments.data(), environment.data());
  ::close(ends[1]);
  progress_ = ends[0];
  if (error != 0) {
    ::close(progress_);
    throw Failure(ErrorWord::kInternal, "a worker cannot be started: " + std::string(std::strerror(error)));
  }
}

WorkerProcess::~WorkerProcess() {
  if (!ended_) {
    kill();
    ::waitpid(id_, &status_, 0);
  }
  ::close(progress_);
}

std::vector<std::string> WorkerProcess::lines(std::chrono::milliseconds wait) {
  pollfd waiting{progress_, POLLIN, 0};
  std::vector<std::string> complete;
  if (::poll(&waiting, 1, static_cast<int>(wait.count())) <= 0) return complete;
  std::array<char, 4096> piece{};
  const ssize_t got = ::read(progress_, piece.data(), piece.size());
  if (got <= 0) {  // it has closed its end, and is about to go
    ::poll(nullptr, 0, 10);
    return complete;
  }
  partial_.append(piece.data(), static_cast<std::size_t>(got));
  for (std::size_t end = 0; (end = partial_.find('\n')) != std::string::npos; partial_.erase(0, end + 1))
    complete.push_back(partial_.substr(0, end));
  if (partial_.size() > kMostLine) partial_.clear();
  return complete;
}

bool WorkerProcess::ended() {
  if (!ended_) ended_ = ::wait4(id_, &status_, WNOHANG, &usage_) == id_;
  return ended_;
}

void WorkerProcess::ask_to_stop() const {
  if (!ended_) ::kill(id_, SIGTERM);
}

void WorkerProcess::kill() const {
  if (!ended_) ::kill(id_, SIGKILL);
}

JobUse WorkerProcess::used() const {
  const auto seconds = [](const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); };
  return {seconds(usage_.ru_utime) + seconds(usage_.ru_stime), static_cast<std::uint64_t>(usage_.ru_maxrss) * 1024};
}

int WorkerProcess::signal() const {
  return WIFSIGNALED(status_) ? WTERMSIG(status_) : 0;
}

}  // namespace standin
