#include "server/service/confinement.h"

#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>

#include "render/base/error.h"

namespace standin {
namespace {

// `grace`: from the soft limit, which sends a signal, to the hard one, which kills.
void limit(__rlimit_resource resource, std::uint64_t most, const char* what, std::uint64_t grace = 0) {
  if (most == 0) return;
  rlimit now{};
  getrlimit(resource, &now);
  const auto within = [&](rlim_t value) { return now.rlim_max == RLIM_INFINITY ? value : std::min(value, now.rlim_max); };
  const rlimit wanted{within(most), within(most + grace)};
  if (setrlimit(resource, &wanted) != 0)
    throw Failure(ErrorWord::kInternal, std::string("worker limit on ") + what + ": " + std::strerror(errno));
}

// An empty network namespace. Who may not make one may with a user namespace of his own.
bool leave_the_network() {
  return unshare(CLONE_NEWNET) == 0 || unshare(CLONE_NEWUSER | CLONE_NEWNET) == 0;
}

}  // namespace

nlohmann::json to_json(const WorkerLimits& limits) {
  return {{"data_bytes", limits.data_bytes},
          {"cpu_s", limits.cpu_s},
          {"open_files", limits.open_files},
          {"file_bytes", limits.file_bytes},
          {"niceness", limits.niceness}};
}

WorkerLimits worker_limits_from_json(const nlohmann::json& object) {
  return {object.at("data_bytes"), object.at("cpu_s"), object.at("open_files"), object.at("file_bytes"), object.at("niceness")};
}

void confine_this_process(const WorkerLimits& limits, pid_t parent) {
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) throw Failure(ErrorWord::kInternal, "a worker cannot be tied to its server");
  if (getppid() != parent) throw Failure(ErrorWord::kCancelled, "the server is gone");
  prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
  setpriority(PRIO_PROCESS, 0, limits.niceness);
  (void)leave_the_network();
  limit(RLIMIT_DATA, limits.data_bytes, "data");
  limit(RLIMIT_CPU, limits.cpu_s, "processor time", 5);
  limit(RLIMIT_NOFILE, limits.open_files, "open files");
  limit(RLIMIT_FSIZE, limits.file_bytes, "file size");
  limit(RLIMIT_CORE, 1, "core dumps");
}

}  // namespace standin
