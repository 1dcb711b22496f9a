// The service as a whole: store, scheduler, routes and event loop, put together and taken apart in the right order.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "render/base/work.h"
#include "server/http/server.h"
#include "server/service/api.h"
#include "server/service/scheduler.h"

namespace standin {

struct ServiceConfig {
  std::filesystem::path data = "standin-data";
  std::string address = "127.0.0.1";
  std::uint16_t port = 8080;     // 0: any that is free
  std::filesystem::path tokens;  // file; empty: none
  std::filesystem::path scenes;  // folders whose files may be named; empty: none
  std::filesystem::path targets;
  std::filesystem::path presets;  // folder of configuration files; empty: none
  std::uint64_t most_queued = 100;
  std::function<void(const std::string&)> log = [](const std::string&) {};  // from any thread
  SchedulerConfig scheduler;
  ApiConfig api;
  HttpLimits http;
};

/// Runs until it is stopped. `started` is told the port. Throws Failure(kBadUsage) where it would listen to others without tokens,
/// Failure(kOutputOccupied) where another service has the data folder.
void serve(ServiceConfig config, const WorkBudget& budget, const std::function<void(std::uint16_t)>& started);

}  // namespace standin
