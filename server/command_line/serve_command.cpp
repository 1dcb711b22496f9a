// serve: the HTTP service; work: one job of it, in a process of its own.
#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <charconv>
#include <cstdio>
#include <filesystem>

#include "render/base/error.h"
#include "server/command_line/commands.h"
#include "server/service/service.h"
#include "server/service/work_folder.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

fs::path this_program() {
  return fs::read_symlink("/proc/self/exe");
}

std::uint64_t amount_of(double count, double unit) {
  return static_cast<std::uint64_t>(count * unit);
}

void listen_at(const std::string& text, ServiceConfig& config) {
  const std::size_t colon = text.rfind(':');
  unsigned port = 0;
  const char* end = text.data() + text.size();
  const bool readable =
      colon != std::string::npos && std::from_chars(text.data() + colon + 1, end, port).ptr == end && colon + 1 < text.size();
  if (!readable || port > 65535) throw Failure(ErrorWord::kBadUsage, "--listen " + text + ": ADDRESS:PORT is expected");
  config.address = text.substr(0, colon);
  config.port = static_cast<std::uint16_t>(port);
}

ServiceConfig config_of(const ServiceArguments& arguments) {
  constexpr double kMillion = 1e6, kGb = 1e9;
  ServiceConfig config;
  listen_at(arguments.listen, config);
  config.data = arguments.data;
  config.tokens = arguments.tokens;
  config.scenes = arguments.scenes;
  config.targets = arguments.targets;
  config.presets = arguments.presets;
  config.log = [](const std::string& line) { std::fprintf(stderr, "standin: %s\n", line.c_str()); };
  config.most_queued = arguments.queue;
  config.scheduler.program = this_program();
  config.scheduler.workers = static_cast<int>(arguments.workers);
  config.scheduler.most_attempts = static_cast<int>(arguments.attempts);
  config.scheduler.deadline_s = 60.0 * arguments.deadline_minutes;
  config.scheduler.keep_s = 24.0 * 3600.0 * arguments.keep_days;
  config.scheduler.most_cache_bytes = amount_of(arguments.cache_gb, kGb);
  config.scheduler.most_triangles = amount_of(arguments.scene_mtriangles, kMillion);
  config.scheduler.most_texels = amount_of(arguments.scene_mtexels, kMillion);
  config.scheduler.limits.data_bytes = amount_of(arguments.worker_memory_gb, kGb);
  config.scheduler.limits.cpu_s = amount_of(arguments.worker_cpu_hours, 3600.0);
  config.api.web = arguments.web.empty() ? this_program().parent_path() / "web" : fs::path(arguments.web);
  config.api.most_upload_bytes = amount_of(arguments.upload_mb, kMillion);
  config.api.quota_bytes = amount_of(arguments.quota_gb, kGb);
  config.api.most_streams = arguments.streams;
  config.api.owner_share = arguments.owner_share;
  config.http.connections = arguments.connections;
  return config;
}

// Downloads and clients take a descriptor each; workers are to inherit none, and nobody else is to read the data.
void prepare_this_process() {
  ::umask(077);
  ::close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;
  setrlimit(RLIMIT_NOFILE, &files);
}

}  // namespace

int serve_command(const CommandContext& context) {
  prepare_this_process();
  ServiceConfig config = config_of(context.arguments.service);
  const std::string address = config.address;
  serve(std::move(config), context.budget, [&](std::uint16_t port) {
    std::printf("http://%s:%u\n", address.c_str(), static_cast<unsigned>(port));
    std::fflush(stdout);
  });
  return 0;
}

int work_command(const CommandContext& context) {
  return work(context.arguments.work_folder, static_cast<pid_t>(context.arguments.work_parent));
}

}  // namespace standin
