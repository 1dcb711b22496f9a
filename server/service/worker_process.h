// A worker as its server sees it: a child process that says how far it is and ends on request.
#pragma once

#include <sys/resource.h>
#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "server/store/job_record.h"

namespace standin {

class WorkerProcess {
 public:
  /// Starts `program work FOLDER`, with an environment of its own. The thread that calls this must outlive the worker, which is killed when
  /// it ends (confinement.h). Throws Failure(kInternal).
  WorkerProcess(const std::filesystem::path& program, const std::filesystem::path& folder);
  /// Kills it if it still runs.
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  /// Complete lines of its progress, waiting for some at most so long.
  std::vector<std::string> lines(std::chrono::milliseconds wait);
  /// True once it has ended; its wait status is there then.
  bool ended();
  void ask_to_stop() const;
  void kill() const;
  /// The signal that ended it; 0: none.
  [[nodiscard]] int signal() const;
  /// Of one that has ended.
  [[nodiscard]] JobUse used() const;

 private:
  pid_t id_ = -1;
  int progress_ = -1;
  std::string partial_;
  bool ended_ = false;
  int status_ = 0;
  rusage usage_{};
};

}  // namespace standin
