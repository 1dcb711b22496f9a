// Routes of jobs: submit, watch, cancel, remove.
#include <array>
#include <charconv>
#include <ctime>

#include "render/base/error.h"
#include "server/service/api.h"

namespace standin {
namespace {

using nlohmann::json;

constexpr int kMostPerPage = 200;
constexpr std::size_t kMostKeyBytes = 200;

}  // namespace

json time_text(std::optional<std::int64_t> moment_ms) {
  if (!moment_ms) return nullptr;
  const std::time_t seconds = *moment_ms / 1000;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 40> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  std::array<char, 8> fraction{};
  std::snprintf(fraction.data(), fraction.size(), ".%03dZ", static_cast<int>(*moment_ms % 1000));
  return std::string(text.data()) + fraction.data();
}

namespace {

std::int64_t integer_of(const HttpRequest& request, const std::string& key, std::int64_t otherwise, std::int64_t least, std::int64_t most) {
  const auto given = request.query.find(key);
  if (given == request.query.end()) return otherwise;
  const std::string& text = given->second;
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < least || value > most)
    throw Failure(ErrorWord::kBadRequest, "query " + key + "=" + text + ": an integer from " + std::to_string(least) + " to " +
                                              std::to_string(most) + " is expected");
  return value;
}

// Server-sent events of one job, from where the client left off to its end.
class JobEvents : public TextStream {
 public:
  JobEvents(JobStore& jobs, std::string id, std::int64_t after, std::unique_ptr<OwnerTally::Hold> open)
      : jobs_(jobs), id_(std::move(id)), after_(after), open_(std::move(open)) {}

  std::optional<std::string> next() override {
    if (ended_) return std::nullopt;
    const bool was_over = over();  // asked first: the last event is in the store by then
    std::string text;
    for (const JobEvent& event : jobs_.events_of(id_, after_)) {
      after_ = event.id;
      const auto state = state_named(event.data.at("state").get<std::string>());
      ended_ = state && is_final(*state);
      const bool progress = event.data.at("state") == "running" && event.data.at("stage") != "";
      text += "id: " + std::to_string(event.id) + "\nevent: " + (progress ? "progress" : "state") + "\ndata: " + event.data.dump() + "\n\n";
    }
    if (text.empty() && was_over) return std::nullopt;
    return text;
  }
  [[nodiscard]] const std::string& subject() const override { return id_; }
  [[nodiscard]] std::string heartbeat() const override { return ": still here\n\n"; }

 private:
  // Its last event was sent before, or it was removed.
  bool over() {
    const auto job = jobs_.find("", id_);
    return !job || is_final(job->state);
  }

  JobStore& jobs_;
  std::string id_;
  std::int64_t after_;
  std::unique_ptr<OwnerTally::Hold> open_;
  bool ended_ = false;
};

json artifact_json(const std::string& job, const StoredFile& file) {
  return {{"path", file.name},
          {"bytes", file.bytes},
          {"sha256", file.sha256},
          {"type", media_type(file.name)},
          {"href", "/v1/jobs/" + job + "/artifacts/" + file.name}};
}

json artifacts_json(const std::string& job, const std::vector<StoredFile>& files) {
  json list = json::array();
  for (const StoredFile& file : files) list.push_back(artifact_json(job, file));
  return list;
}

}  // namespace

Job Api::job_of(const Exchange& exchange) {
  const std::string& id = exchange.path.at("id");
  if (auto job = jobs_.find(exchange.request.owner, id)) return *job;
  throw Failure(ErrorWord::kNotFound, "no job " + id);
}

json Api::document_of(const Job& job) {
  json document = {{"id", job.id},
                   {"kind", job.kind},
                   {"label", job.label},
                   {"state", state_name(job.state)},
                   {"aim_met", job.aim_met ? json(*job.aim_met) : json(nullptr)},
                   {"stage", job.stage},
                   {"fraction", job.fraction},
                   {"created", time_text(job.created_ms)},
                   {"started", time_text(job.started_ms)},
                   {"finished", time_text(job.finished_ms)},
                   {"attempts", job.attempts},
                   {"cancel_asked", job.cancel_asked},
                   {"best_so_far", job.best_so_far},
                   {"used", job.used ? json{{"cpu_s", job.used->cpu_s}, {"peak_rss_bytes", job.used->peak_rss_bytes}} : json(nullptr)},
                   {"error", job.problem},
                   {"request", job.request},
                   {"scene", nullptr},
                   {"artifacts", artifacts_json(job.id, jobs_.artifacts_of(job.id))}};
  const auto inputs = jobs_.inputs_of(job.id);
  if (const auto scene = inputs.find("scene"); scene != inputs.end())
    document["scene"] = {{"name", scene->second.name}, {"bytes", scene->second.bytes}, {"href", "/v1/jobs/" + job.id + "/scene"}};
  return document;
}

StoredFile Api::made_by_job(const std::string& owner, const std::string& id, JobKind kind, const std::string& name, const char* pointer) {
  const auto job = jobs_.find(owner, id);
  if (!job || job->kind != kind_name(kind))
    throw InvalidBody(std::vector<FieldProblem>{{pointer, "no " + std::string(kind_name(kind)) + " job " + id}});
  for (StoredFile& file : jobs_.artifacts_of(id))
    if (file.name == name) return file;
  throw InvalidBody(
      std::vector<FieldProblem>{{pointer, "job " + id + " is " + std::string(state_name(job->state)) + " and has no " + name}});
}

StoredFile Api::resolve(const FileReference& file, const Catalogue* catalogue, const std::string& owner, const char* pointer) {
  using Source = FileReference::Source;
  if (file.source == Source::kUpload) {
    if (const auto upload = jobs_.find_upload(owner, file.value)) return upload->file;
    throw InvalidBody(std::vector<FieldProblem>{{pointer, "no upload " + file.value}});
  }
  if (file.source == Source::kJob) {
    const bool sweep = catalogue == nullptr;
    return made_by_job(owner, file.value, sweep ? JobKind::kSweep : JobKind::kCalibrate, sweep ? "sweep.json" : "target.json", pointer);
  }
  if (const auto named = catalogue->find(file.value)) return *named;
  throw InvalidBody(std::vector<FieldProblem>{{pointer, "no file " + file.value + " is offered"}});
}

std::map<std::string, StoredFile> Api::inputs_of(const JobRequest& request, const std::string& owner) {
  std::map<std::string, StoredFile> inputs;
  const auto add = [&](const char* role, const FileReference& file, const Catalogue* catalogue, const char* pointer) {
    if (file.source != FileReference::Source::kNone) inputs[role] = resolve(file, catalogue, owner, pointer);
  };
  add("scene", request.scene, &hooks_.scenes, "/scene");
  add("target", request.target, &hooks_.targets, "/target");
  add("baseline", request.baseline, nullptr, "/baseline");
  if (request.kind != JobKind::kVerify) return inputs;
  (void)made_by_job(owner, request.placed_job, JobKind::kPlace, "placement.json", "/job");
  inputs = jobs_.inputs_of(request.placed_job);
  for (const StoredFile& file : jobs_.artifacts_of(request.placed_job)) inputs["placed:" + file.name] = file;
  return inputs;
}

json Api::dry_run(const JobRequest& request, const NewJob& job) {
  json document = {{"valid", true}, {"kind", job.kind}, {"spec", to_json(request.spec, false)}, {"predicted", nullptr}};
  const auto scene = job.inputs.find("scene");
  if (scene == job.inputs.end()) return document;
  const JobPrediction predicted = jobs_.predict(job.owner, job.kind, scene->second.bytes);
  if (predicted.jobs > 0)
    document["predicted"] = {{"seconds", predicted.seconds}, {"peak_rss_bytes", predicted.peak_rss_bytes}, {"from_jobs", predicted.jobs}};
  return document;
}

HttpResponse Api::submit(const Exchange& exchange) {
  const JobRequest request = parse_job_request(exchange.body);
  const std::string& owner = exchange.request.owner;
  const std::string key = exchange.request.header("idempotency-key");
  if (key.size() > kMostKeyBytes)
    throw Failure(ErrorWord::kBadRequest, "an Idempotency-Key of more than " + std::to_string(kMostKeyBytes) + " bytes");
  if (const auto earlier = jobs_.earlier(owner, key, exchange.body)) return accepted(*earlier);
  const NewJob job{owner, std::string(kind_name(request.kind)), request.label, exchange.body, inputs_of(request, owner)};
  if (request.dry_run) return json_response(200, dry_run(request, job));
  require_room(owner);
  const Submission made = jobs_.submit(job, key);
  if (!made.replayed) hooks_.queue_changed();
  return accepted(made.job);
}

HttpResponse Api::accepted(const Job& job) {
  HttpResponse response = json_response(202, document_of(job));
  response.headers.emplace_back("Location", "/v1/jobs/" + job.id);
  response.headers.emplace_back("Retry-After", "1");
  return response;
}

HttpResponse Api::list_jobs(const Exchange& exchange) {
  JobFilter filter;
  const auto& query = exchange.request.query;
  if (const auto state = query.find("state"); state != query.end()) {
    filter.state = state_named(state->second);
    if (!filter.state)
      throw Failure(ErrorWord::kBadRequest,
                    "query state=" + state->second + ": queued, running, succeeded, failed or cancelled is expected");
  }
  if (const auto kind = query.find("kind"); kind != query.end()) filter.kind = kind->second;
  filter.limit = static_cast<int>(integer_of(exchange.request, "limit", filter.limit, 1, kMostPerPage));
  filter.before = integer_of(exchange.request, "after", 0, 0, INT64_MAX);
  const JobPage page = jobs_.list(exchange.request.owner, filter);
  json documents = json::array();
  for (const Job& job : page.jobs) {
    documents.push_back(document_of(job));
    documents.back().erase("request");
  }
  return json_response(200, {{"jobs", documents}, {"next", page.next ? json(std::to_string(*page.next)) : json(nullptr)}});
}

HttpResponse Api::get_job(const Exchange& exchange) {
  const Job job = job_of(exchange);
  HttpResponse response = json_response(200, document_of(job));
  if (!is_final(job.state)) response.headers.emplace_back("Retry-After", "1");
  return response;
}

HttpResponse Api::delete_job(const Exchange& exchange) {
  const Job job = job_of(exchange);
  jobs_.remove(exchange.request.owner, job.id);
  hooks_.queue_changed();
  return {204, {}, std::string()};
}

HttpResponse Api::cancel_job(const Exchange& exchange) {
  const Job job = job_of(exchange);
  const auto now = jobs_.ask_cancel(exchange.request.owner, job.id);
  hooks_.queue_changed();
  return json_response(202, document_of(now.value_or(job)));
}

HttpResponse Api::job_events(const Exchange& exchange) {
  const Job job = job_of(exchange);
  if (exchange.request.method == "HEAD") return {200, {{"Content-Type", "text/event-stream"}}, std::string()};
  require_stream(exchange.request.owner);
  std::int64_t after = 0;
  const std::string last = exchange.request.header("last-event-id");
  std::from_chars(last.data(), last.data() + last.size(), after);
  return {200,
          {{"Content-Type", "text/event-stream"}, {"Cache-Control", "no-cache"}, {"X-Accel-Buffering", "no"}},
          std::shared_ptr<TextStream>(std::make_shared<JobEvents>(jobs_, job.id, after, streams_.hold(exchange.request.owner)))};
}

HttpResponse Api::list_artifacts(const Exchange& exchange) {
  const Job job = job_of(exchange);
  return json_response(200, {{"artifacts", artifacts_json(job.id, jobs_.artifacts_of(job.id))}});
}

HttpResponse Api::get_artifact(const Exchange& exchange) {
  const Job job = job_of(exchange);
  const std::string& path = exchange.path.at("path");
  for (const StoredFile& file : jobs_.artifacts_of(job.id))
    if (file.name == path) {
      HttpResponse response = file_response(exchange.request, blobs_.path_of(file.sha256), file.bytes, file.sha256, media_type(file.name));
      // A report is a page made from a stranger's scene: it may run its own script, and reach nothing.
      if (path.ends_with(".html"))
        response.headers.emplace_back(
            "Content-Security-Policy",
            "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:");
      return response;
    }
  if (!is_final(job.state))
    throw Failure(ErrorWord::kNotFinished, "job " + job.id + " is " + std::string(state_name(job.state)) + ": it has no artifacts yet");
  throw Failure(ErrorWord::kNotFound, "job " + job.id + " has no artifact " + path);
}

HttpResponse Api::get_scene(const Exchange& exchange) {
  const Job job = job_of(exchange);
  const auto inputs = jobs_.inputs_of(job.id);
  const auto scene = inputs.find("scene");
  if (scene == inputs.end()) throw Failure(ErrorWord::kNotFound, "job " + job.id + " has no scene");
  const StoredFile& file = scene->second;
  // Never what its name says: a client gave that, and a page among scenes would be this server's.
  return file_response(exchange.request, blobs_.path_of(file.sha256), file.bytes, file.sha256, "application/octet-stream");
}

}  // namespace standin
