#include "server/service/scheduler.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <utility>

#include "render/base/error.h"
#include "render/base/sha256.h"
#include "render/base/staged_file.h"
#include "server/http/message.h"
#include "server/service/worker_process.h"
#include "server/store/folder_size.h"

namespace standin {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kLook{100};
constexpr std::chrono::seconds kPause{2};     // after a failure of the server's own
constexpr std::chrono::seconds kSpared{300};  // younger blobs may be on their way into the store
constexpr double kGrace_s = 1.2;              // from asking a worker to stop to killing it
constexpr double kReportEach_s = 0.5;         // within a stage

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void link_input(const fs::path& folder, const std::string& role, const StoredFile& file, const BlobStore& blobs) {
  const fs::path place = folder / "inputs" / role.substr(0, role.find(':'));
  fs::create_directories(place);
  fs::create_hard_link(blobs.path_of(file.sha256), place / harmless_name(file.name, "file"));
}

json read_outcome(const fs::path& folder) {
  if (!fs::exists(folder / kOutcomeFile)) return nullptr;
  return json::parse(read_file(folder / kOutcomeFile), nullptr, false);
}

// A worker that was stopped says so, too, but not how its job ends.
bool tells_the_end(const json& outcome) {
  return outcome.is_object() &&
         (outcome.value("exit_code", 3) <= 1 || (outcome.contains("problem") && outcome["problem"].value("word", "") != "cancelled"));
}

JobEnd failed(ErrorWord word, const std::string& sentence) {
  return {.state = JobState::kFailed, .aim_met = {}, .problem = problem_of(word, sentence), .artifacts = {}};
}

}  // namespace

// One worker for one job.
class Scheduler::Attempt {
 public:
  Attempt(Scheduler& scheduler, const Job& job) : scheduler_(scheduler), job_(job), folder_(scheduler.folder_of(job.id)) {}

  void run() {
    if (tells_the_end(read_outcome(folder_))) return conclude();  // an earlier one ended, and its server before it could say so
    try {
      prepare();
    } catch (const InvalidBody& invalid) {  // accepted by an earlier version, or under other limits
      return end(failed(invalid.word(), invalid.what()));
    }
    watch();
    conclude();
  }

 private:
  enum class Why { kNone, kCancelled, kDeadline, kStopping };

  void prepare() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    for (const auto& [role, file] : scheduler_.jobs_.inputs_of(job_.id)) link_input(folder_, role, file, scheduler_.blobs_);
    const JobRequest request = parse_job_request(job_.request);
    WorkOrder order{request.kind, request.spec, request.arguments, scheduler_.config_.limits};
    order.spec.max_triangles = scheduler_.config_.most_triangles;
    order.spec.max_texels = scheduler_.config_.most_texels;
    if (request.kind == JobKind::kSurvey || request.kind == JobKind::kPlace || request.kind == JobKind::kSweep)
      order.spec.cache = scheduler_.cache_of(job_.owner).string();
    write_file(folder_ / kOrderFile, to_json(order).dump());
  }

  void watch() {
    WorkerProcess worker(scheduler_.config_.program, folder_);
    const auto start = Clock::now();
    auto asked = start;
    while (!worker.ended()) {
      for (const std::string& line : worker.lines(kLook)) report(line);
      if (why_ == Why::kNone) {
        why_ = reason_to_stop(start);
        if (why_ == Why::kNone) continue;
        asked = Clock::now();
        worker.ask_to_stop();
      } else if (seconds_since(asked) > kGrace_s) {
        worker.kill();
      }
    }
    signal_ = worker.signal();
    used_ = worker.used();
  }

  [[nodiscard]] Why reason_to_stop(Clock::time_point start) const {
    if (scheduler_.stopping_) return Why::kStopping;
    const auto job = scheduler_.jobs_.find("", job_.id);
    if (!job || job->cancel_asked) return Why::kCancelled;
    const double deadline_s = scheduler_.config_.deadline_s;
    return deadline_s > 0.0 && seconds_since(start) > deadline_s ? Why::kDeadline : Why::kNone;
  }

  void report(const std::string& line) {
    const json progress = json::parse(line, nullptr, false);
    if (!progress.is_object() || !progress.contains("stage") || !progress.contains("fraction")) return;
    const json best = progress.value("best", json());
    if (progress["stage"] == stage_ && best == best_ && seconds_since(reported_) < kReportEach_s) return;
    stage_ = progress["stage"];
    best_ = best;
    reported_ = Clock::now();
    scheduler_.jobs_.report(job_.id, stage_, progress["fraction"], best_);
  }

  void conclude() {
    const json outcome = read_outcome(folder_);
    if (outcome.is_object() && outcome.value("exit_code", 3) <= 1) return succeed(outcome["exit_code"] == 0);
    if (why_ == Why::kStopping) return scheduler_.jobs_.requeue(job_.id, false);
    if (why_ == Why::kCancelled) return end({.state = JobState::kCancelled, .aim_met = {}, .problem = {}, .artifacts = {}});
    if (why_ == Why::kDeadline)
      return end(failed(ErrorWord::kDeadlinePassed,
                        "the job took longer than " + std::to_string(static_cast<long>(scheduler_.config_.deadline_s)) + " s"));
    if (tells_the_end(outcome)) return end({.state = JobState::kFailed, .aim_met = {}, .problem = outcome["problem"], .artifacts = {}});
    lost();
  }

  // Whoever kills a worker says nothing of its job; what crashes would crash again.
  void lost() {
    const std::uint64_t cpu_s = scheduler_.config_.limits.cpu_s;
    const bool out_of_time = signal_ == SIGXCPU || (cpu_s > 0 && used_ && used_->cpu_s >= static_cast<double>(cpu_s));
    const bool killed = !out_of_time && (signal_ == SIGKILL || signal_ == SIGTERM || signal_ == 0);
    if (killed && job_.attempts < scheduler_.config_.most_attempts) {
      fs::remove_all(folder_);
      return scheduler_.jobs_.requeue(job_.id, true);
    }
    const std::string how = out_of_time    ? "used all the processor time that a job may have"
                            : signal_ == 0 ? "ended without a word"
                                           : "was ended by signal " + std::to_string(signal_) + " (" + strsignal(signal_) + ")";
    end(failed(ErrorWord::kWorkerLost, "the worker " + how + ", at attempt " + std::to_string(job_.attempts) + ", in stage " +
                                           (stage_.empty() ? "start" : stage_)));
  }

  void succeed(bool aim_met) {
    const std::scoped_lock lock(scheduler_.collecting_);
    JobEnd end{.state = JobState::kSucceeded, .aim_met = aim_met, .problem = {}, .artifacts = {}, .used = used_};
    if (fs::is_directory(folder_ / "out"))
      for (const auto& entry : fs::directory_iterator(folder_ / "out"))
        if (entry.is_regular_file() && !entry.path().filename().string().starts_with('.'))
          end.artifacts.push_back(scheduler_.blobs_.adopt(entry.path(), entry.path().filename().string()));
    if (fs::exists(folder_ / kPrintedFile) && fs::file_size(folder_ / kPrintedFile) > 0)
      end.artifacts.push_back(scheduler_.blobs_.adopt(folder_ / kPrintedFile, "result.json"));
    scheduler_.jobs_.finish(job_.id, end);
    fs::remove_all(folder_);
  }

  // Whoever sees its end finds the disk released.
  void end(JobEnd end) {
    end.used = used_;
    fs::remove_all(folder_);
    scheduler_.jobs_.finish(job_.id, end);
  }

  Scheduler& scheduler_;
  const Job job_;
  const fs::path folder_;
  Why why_ = Why::kNone;
  int signal_ = 0;
  std::optional<JobUse> used_;
  std::string stage_;
  json best_;
  Clock::time_point reported_;
};

Scheduler::Scheduler(SchedulerConfig config, JobStore& jobs, BlobStore& blobs, std::function<std::vector<std::string>()> blobs_in_use,
                     std::function<void(const std::string&)> log)
    : config_(std::move(config)), jobs_(jobs), blobs_(blobs), blobs_in_use_(std::move(blobs_in_use)), log_(std::move(log)) {
  fs::create_directories(config_.data / "work");
  recover();
  tidy();
  for (int i = 0; i < config_.workers; ++i) threads_.emplace_back([this] { loop(); });
}

void Scheduler::stop() {
  stopping_ = true;
  wake();
  for (auto& thread : threads_)
    if (thread.joinable()) thread.join();
}

void Scheduler::wake() {
  const std::scoped_lock lock(mutex_);
  ++changes_;
  changed_.notify_all();
}

fs::path Scheduler::cache_of(const std::string& owner) const {
  return config_.data / "cache" / sha256_hex(owner).substr(0, 16);
}

void Scheduler::recover() {
  for (const Job& job : jobs_.in_state(JobState::kRunning)) jobs_.requeue(job.id, false);
}

// A store that cannot be written to (a full disk, a backup that holds it) is waited for: the thread, and the job, outlive it.
void Scheduler::loop() {
  std::string stranded;  // running by the store, and done by nobody
  while (!stopping_) {
    try {
      if (!stranded.empty()) jobs_.requeue(std::exchange(stranded, ""), false);
      const std::uint64_t seen = changes();
      if (const auto job = jobs_.start_next()) {
        stranded = job->id;
        run(*job);
        stranded.clear();
      } else {
        wait_for_change(seen);
      }
    } catch (const std::exception& error) {
      log_(std::string("scheduler: ") + error.what());
      std::this_thread::sleep_for(kPause);
    }
  }
}

std::uint64_t Scheduler::changes() {
  const std::scoped_lock lock(mutex_);
  return changes_;
}

void Scheduler::wait_for_change(std::uint64_t seen) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::seconds(5), [&] { return changes_ != seen || stopping_; });
}

// What fails here is the server's: its disk, its descriptors. Clients are not told of its insides.
void Scheduler::run(const Job& job) {
  if (job.cancel_asked) {
    fs::remove_all(folder_of(job.id));
    return jobs_.finish(job.id, {.state = JobState::kCancelled, .aim_met = {}, .problem = {}, .artifacts = {}});
  }
  try {
    Attempt(*this, job).run();
  } catch (const std::exception& error) {
    log_("job " + job.id + ", attempt " + std::to_string(job.attempts) + ": " + error.what());
    if (job.attempts >= config_.most_attempts)
      return jobs_.finish(job.id, failed(ErrorWord::kInternal, "the server could not run the job; its log says why"));
    std::this_thread::sleep_for(kPause);
    jobs_.requeue(job.id, true);
  }
}

void Scheduler::tidy() {
  const std::int64_t moment_ms = now_ms() - static_cast<std::int64_t>(1e3 * config_.keep_s);
  if (config_.keep_s > 0.0)
    for (const Job& job : jobs_.finished_before(moment_ms)) jobs_.remove("", job.id);
  const std::scoped_lock lock(collecting_);
  blobs_.keep_only(blobs_in_use_(), kSpared);
  // After the blobs: a job that is being submitted may have found its upload a moment ago, and refers to its blob by the next time.
  if (config_.keep_s > 0.0) jobs_.remove_uploads_before(moment_ms);
  for (const auto& entry : fs::directory_iterator(config_.data / "work")) {
    const auto job = jobs_.find("", entry.path().filename().string());
    if (!job || is_final(job->state)) fs::remove_all(entry.path());
  }
  if (fs::exists(config_.data / "cache")) keep_newest(config_.data / "cache", config_.most_cache_bytes);
}

double Scheduler::worker_cpu_s() const {
  rusage used{};
  getrusage(RUSAGE_CHILDREN, &used);
  const auto seconds = [](const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

}  // namespace standin
