// Routes that say how the service is: for load balancers, for Prometheus, for people who write clients.
#include <sys/resource.h>

#include <sstream>

#include "server/error_table.h"
#include "server/service/api.h"

namespace standin {
namespace {

using nlohmann::json;

// Of Prometheus' text format.
class MetricsText {
 public:
  void family(const char* name, const char* type, const char* help) {
    text_ << "# HELP " << name << " " << help << "\n# TYPE " << name << " " << type << "\n";
  }
  template <class Value>
  void sample(const std::string& name, Value value) {
    text_ << name << " " << value << "\n";
  }
  template <class Value>
  void single(const char* name, const char* type, const char* help, Value value) {
    family(name, type, help);
    sample(name, value);
  }
  [[nodiscard]] std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
};

double own_cpu_s() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& time) { return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec); };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

}  // namespace

HttpResponse Api::health(const Exchange&) {
  return json_response(200, {{"status", "ok"}});
}

// Ready: the store answers, and there is room.
HttpResponse Api::ready(const Exchange&) {
  const auto counts = jobs_.counts_by_state();
  if (hooks_.stored_bytes() >= config_.quota_bytes) throw Failure(ErrorWord::kDiskFull, "the data folder has reached its quota");
  return json_response(200, {{"status", "ready"}, {"queued", counts.at("queued")}, {"running", counts.at("running")}});
}

HttpResponse Api::metrics(const Exchange&) {
  MetricsText text;
  text.family("standin_jobs", "gauge", "Jobs by state.");
  for (const auto& [state, count] : jobs_.counts_by_state()) text.sample("standin_jobs{state=\"" + state + "\"}", count);
  {
    const std::scoped_lock lock(counting_);
    text.family("standin_http_answers_total", "counter", "Answers by HTTP status.");
    std::uint64_t all = 0;
    for (const auto& [status, count] : answers_) {
      text.sample("standin_http_answers_total{status=\"" + std::to_string(status) + "\"}", count);
      all += count;
    }
    text.family("standin_http_answer_seconds", "summary", "From a request's head to its answer's end.");
    text.sample("standin_http_answer_seconds_sum", answer_s_);
    text.sample("standin_http_answer_seconds_count", all);
  }
  text.single("standin_event_streams", "gauge", "Open event streams.", streams_.all());
  text.single("standin_uploads_under_way", "gauge", "Uploads under way.", uploads_.all());
  text.single("standin_blob_bytes", "gauge", "Bytes of uploads, inputs and artifacts.", hooks_.stored_bytes());
  text.single("standin_server_cpu_seconds_total", "counter", "Processor seconds of the server itself.", own_cpu_s());
  text.single("standin_worker_cpu_seconds_total", "counter", "Processor seconds of workers that have ended.", hooks_.worker_cpu_s());
  return {200, {{"Content-Type", "text/plain; version=0.0.4"}}, text.text()};
}

HttpResponse Api::get_openapi(const Exchange&) {
  return json_response(200, openapi());
}

}  // namespace standin
