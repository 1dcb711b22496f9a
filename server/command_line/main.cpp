// `standin`: parse, run, and turn failures into one line and an exit code. Nothing below this file exits or prints errors.
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <mutex>
#include <new>
#include <string>

#include "server/command_line/parser.h"
#include "server/error_table.h"

namespace {

std::atomic<bool> stop_requested{false};

void request_stop(int) {
  stop_requested.store(true);
}

// A bar on a terminal, a line per stage otherwise.
class ProgressPrinter {
 public:
  explicit ProgressPrinter(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) != 0) {}

  void operator()(std::string_view stage, double fraction) {
    if (quiet_) return;
    const std::scoped_lock lock(mutex_);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (terminal_)
      bar(stage, fraction, seconds);
    else if (fraction <= 0.0)
      std::fprintf(stderr, "[%7.1f s] %.*s\n", seconds, static_cast<int>(stage.size()), stage.data());
  }
  void finish() const {
    if (!quiet_ && terminal_) std::fputc('\n', stderr);
  }

 private:
  static void bar(std::string_view stage, double fraction, double seconds) {
    constexpr int kWidth = 30;
    const int filled = static_cast<int>(fraction * kWidth);
    std::fprintf(stderr, "\r\033[K[%7.1f s] %-12.*s [%s%s]", seconds, static_cast<int>(stage.size()), stage.data(),
                 std::string(static_cast<std::size_t>(filled), '#').c_str(),
                 std::string(static_cast<std::size_t>(kWidth - filled), ' ').c_str());
    std::fflush(stderr);
  }

  bool quiet_;
  bool terminal_;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

int complain(standin::ErrorWord word, const char* sentence) {
  const auto& row = standin::error_row(word);
  std::fprintf(stderr, "standin: %s [%.*s]\n", sentence, static_cast<int>(row.name.size()), row.name.data());
  return row.exit_code;
}

int run(int argc, char** argv) {
  auto parsed = standin::parse_command_line(argc, argv);
  if (!parsed.run) return parsed.exit_code;
  ProgressPrinter progress(parsed.quiet);
  parsed.context.budget = standin::WorkBudget(&stop_requested, [&](std::string_view stage, double fraction) { progress(stage, fraction); });
  const int exit_code = parsed.run(parsed.context);
  progress.finish();
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  try {
    return run(argc, argv);
  } catch (const standin::Failure& failure) {
    return complain(failure.word(), failure.what());
  } catch (const std::bad_alloc&) {
    return complain(standin::ErrorWord::kInternal, "out of memory");
  } catch (const std::exception& error) {
    return complain(standin::ErrorWord::kInternal, error.what());
  }
}
