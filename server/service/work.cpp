// The worker process: one job, done as the command line does it.
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <mutex>
#include <new>

#include "render/base/error.h"
#include "render/base/staged_file.h"
#include "render/device/timing_lock.h"
#include "server/error_table.h"
#include "server/http/message.h"
#include "server/service/bundle.h"
#include "server/service/work_folder.h"

namespace standin {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::atomic<bool> stop_requested{false};

void request_stop(int) {
  stop_requested.store(true);
}

// One line for each stage and each hundredth of it, and for each better result; and the worker waits here while another process measures
// times.
class ProgressLines {
 public:
  explicit ProgressLines(int descriptor) : descriptor_(descriptor) {}

  void operator()(std::string_view stage, double fraction) {
    const std::scoped_lock lock(mutex_);
    yield_to_timing(stop_);
    if (stage == stage_ && fraction < fraction_ + kStep && fraction >= fraction_) return;
    stage_ = stage;
    fraction_ = fraction;
    write();
  }

  void found(std::initializer_list<Finding> best) {
    const std::scoped_lock lock(mutex_);
    for (const Finding& one : best) best_[std::string(one.name)] = one.value;
    write();
  }

 private:
  static constexpr double kStep = 0.01;

  void write() {
    json line = {{"stage", stage_}, {"fraction", fraction_}};
    if (!best_.is_null()) line["best"] = best_;
    const std::string text = line.dump() + "\n";
    if (::write(descriptor_, text.data(), text.size()) < 0) stop_requested.store(true);  // nobody listens any more
  }

  const WorkBudget stop_{&stop_requested};
  int descriptor_;
  std::mutex mutex_;
  std::string stage_;
  double fraction_ = 0.0;
  json best_;
};

int run_command(JobKind kind, const CommandContext& context) {
  switch (kind) {
    case JobKind::kSurvey:
      return survey_command(context);
    case JobKind::kPlace:
      return place_command(context);
    case JobKind::kSweep:
      return sweep_command(context);
    case JobKind::kCalibrate:
      return calibrate_command(context);
    case JobKind::kVerify:
      return verify_command(context);
    case JobKind::kBake:
      return bake_command(context);
  }
  return 3;
}

CommandContext context_of(const WorkOrder& order, const fs::path& folder, const WorkBudget& budget) {
  CommandContext context;
  context.spec = order.spec;
  context.budget = budget;
  CommandArguments& arguments = context.arguments;
  apply_arguments(order.kind, order.arguments, arguments);
  fs::path scene = input_file(folder, "scene");
  if (is_bundle(scene)) scene = unpack_bundle(scene, folder / "unpacked", {}, budget);
  if (!scene.empty()) arguments.scenes = {scene.string()};
  arguments.target = input_file(folder, "target").string();
  arguments.baseline = input_file(folder, "baseline").string();
  arguments.output = (order.kind == JobKind::kCalibrate ? folder / "out/target.json" : folder / "out").string();
  if (order.kind == JobKind::kCalibrate) fs::create_directories(folder / "out");
  if (order.kind == JobKind::kVerify) arguments.folder = (folder / "inputs/placed").string();
  arguments.json = true;
  return context;
}

// Sentences name files by where they lie in the job's folder: where that is is nobody's business.
std::string without_folder(std::string sentence, const fs::path& folder) {
  const std::string prefix = folder.string() + "/";
  for (std::size_t i = 0; (i = sentence.find(prefix, i)) != std::string::npos;) sentence.erase(i, prefix.size());
  return sentence;
}

json ended_with(ErrorWord word, const std::string& sentence) {
  return {{"exit_code", error_row(word).exit_code}, {"problem", problem_of(word, sentence)}};
}

json outcome_of(const fs::path& folder, pid_t parent, int progress) {
  try {
    const WorkOrder order = work_order_from_json(json::parse(read_file(folder / kOrderFile)));
    confine_this_process(order.limits, parent);
    ProgressLines lines(progress);
    const WorkBudget budget(
        &stop_requested, [&](std::string_view stage, double fraction) { lines(stage, fraction); },
        [&](std::initializer_list<Finding> best) { lines.found(best); });
    const int exit_code = run_command(order.kind, context_of(order, folder, budget));
    if (order.kind == JobKind::kVerify) {
      fs::create_directories(folder / "out");
      fs::rename(folder / "inputs/placed/verify.json", folder / "out/verify.json");
    }
    return {{"exit_code", exit_code}};
  } catch (const Failure& failure) {
    return ended_with(failure.word(), without_folder(failure.what(), folder));
  } catch (const std::bad_alloc&) {
    return ended_with(ErrorWord::kInternal, "the job needs more memory than it may have");
  } catch (const std::exception& error) {
    return ended_with(ErrorWord::kInternal, without_folder(error.what(), folder));
  }
}

}  // namespace

int work(const fs::path& folder, pid_t parent) {
  std::signal(SIGTERM, request_stop);
  std::signal(SIGINT, SIG_IGN);  // a terminal's Ctrl-C is the server's to handle
  std::signal(SIGPIPE, SIG_IGN);
  const int progress = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  if (std::freopen((folder / kPrintedFile).c_str(), "w", stdout) == nullptr) return 3;
  const json outcome = outcome_of(folder, parent, progress);
  std::cout.flush();
  std::fflush(stdout);
  try {
    write_file(folder / kOutcomeFile, outcome.dump(-1, ' ', false, json::error_handler_t::replace));
  } catch (const std::exception&) {  // the server sees a worker that ended without a word
    return 3;
  }
  return outcome["exit_code"];
}

}  // namespace standin
