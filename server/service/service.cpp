#include "server/service/service.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "render/base/error.h"
#include "server/store/folder_size.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kSettle{2};
constexpr int kTidyEach_s = 60;
constexpr int kMeasureEach_s = 5;

// One service for a data folder: two would do the same jobs.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder) : descriptor_(::open((folder / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
    if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      if (descriptor_ >= 0) ::close(descriptor_);
      throw Failure(ErrorWord::kOutputOccupied, folder.string() + " is the data folder of a service that runs, or cannot be written to");
    }
  }
  ~FolderLock() { ::close(descriptor_); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

bool is_loopback(const std::string& address) {
  return address.starts_with("127.");
}

class Service {
 public:
  explicit Service(ServiceConfig config)
      : config_(prepared(std::move(config))),
        lock_(config_.data),
        blobs_(config_.data / "blobs"),
        jobs_(config_.data / "jobs.sqlite", queue_limits(config_)),
        scenes_(config_.scenes, blobs_, config_.log),
        targets_(config_.targets, blobs_, config_.log),
        api_(config_.api, jobs_, blobs_, config_.tokens.empty() ? Tokens() : Tokens(config_.tokens), hooks()) {
    jobs_.on_change([this](const std::string& id) {
      if (HttpServer* one = server_) one->changed(id);
    });
    scenes_.refresh(std::chrono::seconds(0));
    targets_.refresh(std::chrono::seconds(0));
  }

  void run(const WorkBudget& budget, const std::function<void(std::uint16_t)>& started) {
    Scheduler scheduler(
        config_.scheduler, jobs_, blobs_, [this] { return in_use(); }, config_.log);
    HttpServer server(api_, config_.address, config_.port, config_.http);
    scheduler_ = &scheduler;
    server_ = &server;
    // It tells the server of what it puts back, and the server may wake it: it stops before either goes.
    const StopFirst stop_first{scheduler};
    started(server.port());
    for (int second = 0; !budget.stopped(); ++second) {
      server.tick();
      do_chores(scheduler, second);
      for (int i = 0; i < 10 && !budget.stopped(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }

 private:
  static QueueLimits queue_limits(const ServiceConfig& config) {
    return {config.most_queued, share_of<std::size_t>(config.most_queued, config.api.owner_share)};
  }

  struct StopFirst {
    Scheduler& scheduler;
    ~StopFirst() { scheduler.stop(); }
  };

  // What fails now may work later.
  void do_chores(Scheduler& scheduler, int second) {
    try {
      scenes_.refresh(kSettle);
      targets_.refresh(kSettle);
      if (second % kTidyEach_s == kTidyEach_s - 1) scheduler.tidy();
      if (second % kMeasureEach_s == 0) stored_bytes_ = folder_bytes(config_.data / "blobs") + folder_bytes(config_.data / "work");
    } catch (const std::exception& error) {
      config_.log(std::string("chores: ") + error.what());
    }
  }

  static ServiceConfig prepared(ServiceConfig config) {
    if (!is_loopback(config.address) && config.tokens.empty())
      throw Failure(ErrorWord::kBadUsage, "listening on " + config.address + " needs --tokens: without, anybody could use the service");
    fs::create_directories(config.data);
    config.data = fs::canonical(config.data);
    config.scheduler.data = config.data;
    config.api.presets = config.presets;
    config.api.loopback_only = is_loopback(config.address) && config.tokens.empty();
    if (config.tokens.empty() || !Tokens(config.tokens).of_several_owners()) config.api.owner_share = 1.0;
    return config;
  }

  ApiHooks hooks() {
    return {scenes_,
            targets_,
            [this] {
              if (Scheduler* one = scheduler_) one->wake();
            },
            [this] {
              Scheduler* one = scheduler_;
              return one == nullptr ? 0.0 : one->worker_cpu_s();
            },
            [this] { return stored_bytes_.load(); },
            config_.log};
  }

  std::vector<std::string> in_use() {
    std::vector<std::string> names = jobs_.blobs_in_use();
    for (const Catalogue* catalogue : {&scenes_, &targets_})
      for (const StoredFile& file : catalogue->files()) names.push_back(file.sha256);
    return names;
  }

  const ServiceConfig config_;
  std::atomic<Scheduler*> scheduler_{nullptr};
  std::atomic<HttpServer*> server_{nullptr};
  FolderLock lock_;
  BlobStore blobs_;
  JobStore jobs_;
  Catalogue scenes_;
  Catalogue targets_;
  Api api_;
  std::atomic<std::uint64_t> stored_bytes_{0};
};

}  // namespace

void serve(ServiceConfig config, const WorkBudget& budget, const std::function<void(std::uint16_t)>& started) {
  Service(std::move(config)).run(budget, started);
}

}  // namespace standin
