#include "server/store/job_store.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <stdexcept>

#include "render/base/error.h"
#include "render/base/sha256.h"

namespace standin {
namespace {

using nlohmann::json;

constexpr int kSchemaVersion = 1;
constexpr const char* kSchema = R"(
CREATE TABLE job (
  number INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT NOT NULL UNIQUE, owner TEXT NOT NULL, kind TEXT NOT NULL, label TEXT NOT NULL,
  request TEXT NOT NULL, state TEXT NOT NULL, stage TEXT NOT NULL DEFAULT '', fraction REAL NOT NULL DEFAULT 0,
  created_ms INTEGER NOT NULL, started_ms INTEGER, finished_ms INTEGER, attempts INTEGER NOT NULL DEFAULT 0,
  cancel_asked INTEGER NOT NULL DEFAULT 0, aim_met INTEGER, problem TEXT NOT NULL DEFAULT 'null', best_so_far TEXT NOT NULL DEFAULT 'null',
  cpu_s REAL, peak_rss_bytes INTEGER);
CREATE INDEX job_by_state ON job (state, number);
CREATE TABLE job_file (
  job TEXT NOT NULL REFERENCES job (id) ON DELETE CASCADE, purpose TEXT NOT NULL, role TEXT NOT NULL, name TEXT NOT NULL,
  bytes INTEGER NOT NULL, sha256 TEXT NOT NULL, PRIMARY KEY (job, purpose, role));
CREATE TABLE event (id INTEGER PRIMARY KEY AUTOINCREMENT, job TEXT NOT NULL REFERENCES job (id) ON DELETE CASCADE, data TEXT NOT NULL);
CREATE INDEX event_by_job ON event (job, id);
CREATE TABLE idempotency (
  owner TEXT NOT NULL, key TEXT NOT NULL, request_sha256 TEXT NOT NULL, job TEXT NOT NULL REFERENCES job (id) ON DELETE CASCADE,
  PRIMARY KEY (owner, key));
CREATE TABLE upload (
  id TEXT PRIMARY KEY, owner TEXT NOT NULL, name TEXT NOT NULL, bytes INTEGER NOT NULL, sha256 TEXT NOT NULL, created_ms INTEGER NOT NULL);
)";
constexpr const char* kJobColumns =
    "number, id, owner, kind, label, request, state, stage, fraction, created_ms, started_ms, finished_ms, attempts, cancel_asked, "
    "aim_met, "
    "problem, best_so_far, cpu_s, peak_rss_bytes";
constexpr std::array kStateNames = {"queued", "running", "succeeded", "failed", "cancelled"};

void create_or_check(Database& database, const std::filesystem::path& file) {
  Transaction transaction(database);
  std::int64_t version = 0;
  {
    Query query = database.query("PRAGMA user_version");
    if (query.step()) version = query.integer(0);
  }
  if (version == 0) {
    database.execute(kSchema);
    database.execute("PRAGMA user_version = " + std::to_string(kSchemaVersion));
  } else if (version != kSchemaVersion) {
    throw Failure(ErrorWord::kFileBroken, file.string() + " is of version " + std::to_string(version) +
                                              " of the job store, this program reads " + std::to_string(kSchemaVersion));
  }
  transaction.commit();
}

std::optional<std::int64_t> integer_or_none(const Query& row, int column) {
  return row.is_null(column) ? std::nullopt : std::optional(row.integer(column));
}

std::optional<std::int64_t> as_integer(std::optional<bool> value) {
  return value ? std::optional<std::int64_t>(*value ? 1 : 0) : std::nullopt;
}

StoredFile file_at(const Query& row, int first) {
  return {row.text(first), static_cast<std::uint64_t>(row.integer(first + 1)), row.text(first + 2)};
}

Upload upload_at(const Query& row) {
  return {row.text(0), row.text(1), file_at(row, 2), row.integer(5)};
}

json event_of(const Job& job) {
  json data = {{"state", state_name(job.state)}, {"stage", job.stage}, {"fraction", job.fraction}, {"best_so_far", job.best_so_far}};
  if (!job.problem.is_null()) data["error"] = job.problem;
  if (job.aim_met) data["aim_met"] = *job.aim_met;
  return data;
}

}  // namespace

std::string_view state_name(JobState state) {
  return kStateNames.at(static_cast<std::size_t>(state));
}

std::optional<JobState> state_named(std::string_view name) {
  for (std::size_t i = 0; i < kStateNames.size(); ++i)
    if (name == kStateNames[i]) return static_cast<JobState>(i);
  return std::nullopt;
}

std::int64_t now_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

std::string random_id() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw Failure(ErrorWord::kInternal, "the system gives no random numbers");
  static constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : bytes) (text += kDigits[byte >> 4]) += kDigits[byte & 15];
  return text;
}

JobStore::JobStore(const std::filesystem::path& file, QueueLimits limits) : database_(file), limits_(limits) {
  create_or_check(database_, file);
}

void JobStore::require_place_in_queue(const std::string& owner) {
  Query queued = database_.query("SELECT count(*), coalesce(sum(owner = ?), 0) FROM job WHERE state = 'queued'", owner);
  if (!queued.step()) return;
  const auto all = static_cast<std::size_t>(queued.integer(0)), mine = static_cast<std::size_t>(queued.integer(1));
  if (all >= limits_.all)
    throw Failure(ErrorWord::kQueueFull, std::to_string(all) + " jobs wait already, no more than " + std::to_string(limits_.all) + " may");
  if (mine >= limits_.of_one_owner)
    throw Failure(ErrorWord::kQueueFull,
                  std::to_string(mine) + " of your jobs wait already, no more than " + std::to_string(limits_.of_one_owner) + " may");
}

Submission JobStore::submit(const NewJob& job, const std::string& key) {
  const std::string request = job.request.dump();
  const std::string digest = sha256_hex(request);
  const std::string id = random_id();
  const std::scoped_lock lock(mutex_);
  Transaction transaction(database_);
  if (const auto known = earlier_locked(job.owner, key, digest)) return {*known, true};
  require_place_in_queue(job.owner);
  database_.run("INSERT INTO job (id, owner, kind, label, request, state, created_ms) VALUES (?, ?, ?, ?, ?, 'queued', ?)", id, job.owner,
                job.kind, job.label, request, now_ms());
  write_files(id, "input", job.inputs);
  if (!key.empty())
    database_.run("INSERT INTO idempotency (owner, key, request_sha256, job) VALUES (?, ?, ?, ?)", job.owner, key, digest, id);
  const Job made = find_locked(job.owner, id).value();
  add_event(made);
  transaction.commit();
  changed(id);
  return {made, false};
}

std::optional<Job> JobStore::earlier_locked(const std::string& owner, const std::string& key, const std::string& request_sha256) {
  if (key.empty()) return std::nullopt;
  Query known = database_.query("SELECT request_sha256, job FROM idempotency WHERE owner = ? AND key = ?", owner, key);
  if (!known.step()) return std::nullopt;
  if (known.text(0) != request_sha256)
    throw Failure(ErrorWord::kKeyReused, "Idempotency-Key " + key + " came before, with another body, and made job " + known.text(1));
  return find_locked(owner, known.text(1));
}

std::optional<Job> JobStore::earlier(const std::string& owner, const std::string& key, const json& request) {
  const std::scoped_lock lock(mutex_);
  return earlier_locked(owner, key, sha256_hex(request.dump()));
}

void JobStore::write_files(const std::string& id, const char* purpose, const std::map<std::string, StoredFile>& files) {
  for (const auto& [role, file] : files)
    database_.run("INSERT OR REPLACE INTO job_file (job, purpose, role, name, bytes, sha256) VALUES (?, ?, ?, ?, ?, ?)", id,
                  std::string_view(purpose), role, file.name, static_cast<std::int64_t>(file.bytes), file.sha256);
}

Job JobStore::job_at(Query& row) const {
  Job job;
  job.id = row.text(1);
  job.owner = row.text(2);
  job.kind = row.text(3);
  job.label = row.text(4);
  job.request = json::parse(row.text(5));
  job.state = state_named(row.text(6)).value();
  job.stage = row.text(7);
  job.fraction = row.real(8);
  job.created_ms = row.integer(9);
  job.started_ms = integer_or_none(row, 10);
  job.finished_ms = integer_or_none(row, 11);
  job.attempts = row.integer(12);
  job.cancel_asked = row.integer(13) != 0;
  if (!row.is_null(14)) job.aim_met = row.integer(14) != 0;
  job.problem = json::parse(row.text(15));
  job.best_so_far = json::parse(row.text(16));
  if (!row.is_null(17)) job.used = JobUse{row.real(17), static_cast<std::uint64_t>(row.integer(18))};
  return job;
}

std::optional<Job> JobStore::find_locked(const std::string& owner, const std::string& id) {
  Query row = database_.query(std::string("SELECT ") + kJobColumns + " FROM job WHERE id = ? AND (owner = ? OR ? = '')", id, owner, owner);
  if (!row.step()) return std::nullopt;
  return job_at(row);
}

std::optional<Job> JobStore::find(const std::string& owner, const std::string& id) {
  const std::scoped_lock lock(mutex_);
  return find_locked(owner, id);
}

JobPage JobStore::list(const std::string& owner, const JobFilter& filter) {
  const std::string state = filter.state ? std::string(state_name(*filter.state)) : "";
  const std::scoped_lock lock(mutex_);
  Query row = database_.query(
      std::string("SELECT ") + kJobColumns +
          " FROM job WHERE (owner = ? OR ? = '') AND (? = '' OR state = ?) AND (? = '' OR kind = ?) AND (? = 0 OR number < "
          "?) ORDER BY number DESC LIMIT ?",
      owner, owner, state, state, filter.kind, filter.kind, filter.before, filter.before, static_cast<std::int64_t>(filter.limit) + 1);
  JobPage page;
  std::int64_t last = 0;
  while (row.step()) {
    if (std::ssize(page.jobs) == filter.limit) {
      page.next = last;
      break;
    }
    last = row.integer(0);
    page.jobs.push_back(job_at(row));
  }
  return page;
}

std::map<std::string, StoredFile> JobStore::inputs_of(const std::string& id) {
  const std::scoped_lock lock(mutex_);
  Query row = database_.query("SELECT role, name, bytes, sha256 FROM job_file WHERE job = ? AND purpose = 'input'", id);
  std::map<std::string, StoredFile> files;
  while (row.step()) files[row.text(0)] = file_at(row, 1);
  return files;
}

std::vector<StoredFile> JobStore::artifacts_of(const std::string& id) {
  const std::scoped_lock lock(mutex_);
  Query row = database_.query("SELECT name, bytes, sha256 FROM job_file WHERE job = ? AND purpose = 'artifact' ORDER BY name", id);
  std::vector<StoredFile> files;
  while (row.step()) files.push_back(file_at(row, 0));
  return files;
}

std::vector<JobEvent> JobStore::events_of(const std::string& id, std::int64_t after) {
  const std::scoped_lock lock(mutex_);
  Query row = database_.query("SELECT id, data FROM event WHERE job = ? AND id > ? ORDER BY id", id, after);
  std::vector<JobEvent> events;
  while (row.step()) events.push_back({row.integer(0), json::parse(row.text(1))});
  return events;
}

void JobStore::add_event(const Job& job) {
  database_.run("INSERT INTO event (job, data) VALUES (?, ?)", job.id, event_of(job).dump());
}

void JobStore::changed(const std::string& id) const {
  if (listener_) listener_(id);
}

std::optional<Job> JobStore::start_next() {
  const std::scoped_lock lock(mutex_);
  Transaction transaction(database_);
  std::string id;
  {
    // By turns: who has least running, then who was served longest ago.
    Query row = database_.query(
        "SELECT id FROM job JOIN (SELECT owner, sum(state = 'running') AS running, max(coalesce(started_ms, 0)) AS served FROM job GROUP "
        "BY owner) USING (owner) WHERE state = 'queued' ORDER BY running, served, number LIMIT 1");
    if (!row.step()) return std::nullopt;
    id = row.text(0);
  }
  database_.run(
      "UPDATE job SET state = 'running', attempts = attempts + 1, stage = '', fraction = 0, best_so_far = 'null', started_ms = "
      "coalesce(started_ms, ?) WHERE id = ?",
      now_ms(), id);
  const Job job = find_locked("", id).value();
  add_event(job);
  transaction.commit();
  changed(id);
  return job;
}

void JobStore::report(const std::string& id, const std::string& stage, double fraction, const json& best_so_far) {
  const std::scoped_lock lock(mutex_);
  Transaction transaction(database_);
  database_.run("UPDATE job SET stage = ?, fraction = ?, best_so_far = ? WHERE id = ? AND state = 'running'", stage, fraction,
                best_so_far.dump(), id);
  if (database_.changes() == 0) return;
  add_event(find_locked("", id).value());
  transaction.commit();
  changed(id);
}

void JobStore::end_locked(const std::string& id, const JobEnd& end) {
  const auto cpu_s = end.used ? std::optional(end.used->cpu_s) : std::nullopt;
  const auto peak_rss_bytes = end.used ? std::optional(static_cast<std::int64_t>(end.used->peak_rss_bytes)) : std::nullopt;
  database_.run(
      "UPDATE job SET state = ?, aim_met = ?, problem = ?, finished_ms = ?, fraction = ?, cpu_s = ?, peak_rss_bytes = ?, best_so_far = "
      "'null' WHERE id = ?",
      state_name(end.state), as_integer(end.aim_met), end.problem.dump(), now_ms(), end.state == JobState::kSucceeded ? 1.0 : 0.0, cpu_s,
      peak_rss_bytes, id);
  if (database_.changes() == 0) return;  // it was removed
  std::map<std::string, StoredFile> artifacts;
  for (const StoredFile& file : end.artifacts) artifacts[file.name] = file;
  write_files(id, "artifact", artifacts);
  add_event(find_locked("", id).value());
}

void JobStore::finish(const std::string& id, const JobEnd& end) {
  const std::scoped_lock lock(mutex_);
  Transaction transaction(database_);
  end_locked(id, end);
  transaction.commit();
  changed(id);
}

void JobStore::requeue(const std::string& id, bool counted) {
  const std::scoped_lock lock(mutex_);
  Transaction transaction(database_);
  database_.run("UPDATE job SET state = 'queued', attempts = attempts - ?, best_so_far = 'null' WHERE id = ? AND state = 'running'",
                std::int64_t{counted ? 0 : 1}, id);
  if (database_.changes() == 0) return;
  add_event(find_locked("", id).value());
  transaction.commit();
  changed(id);
}

std::optional<Job> JobStore::ask_cancel(const std::string& owner, const std::string& id) {
  const std::scoped_lock lock(mutex_);
  Transaction transaction(database_);
  const std::optional<Job> job = find_locked(owner, id);
  if (!job || is_final(job->state)) return job;
  database_.run("UPDATE job SET cancel_asked = 1 WHERE id = ?", id);
  if (job->state == JobState::kQueued) end_locked(id, {.state = JobState::kCancelled, .aim_met = {}, .problem = {}, .artifacts = {}});
  std::optional<Job> now = find_locked(owner, id);
  transaction.commit();
  changed(id);
  return now;
}

bool JobStore::remove(const std::string& owner, const std::string& id) {
  const std::scoped_lock lock(mutex_);
  Transaction transaction(database_);
  const std::optional<Job> job = find_locked(owner, id);
  if (!job) return false;
  if (job->state == JobState::kRunning) throw Failure(ErrorWord::kNotFinished, "job " + id + " is running: cancel it before it is deleted");
  database_.run("DELETE FROM job WHERE id = ?", id);
  transaction.commit();
  changed(id);
  return true;
}

std::vector<Job> JobStore::in_state(JobState state) {
  const std::scoped_lock lock(mutex_);
  Query row = database_.query(std::string("SELECT ") + kJobColumns + " FROM job WHERE state = ? ORDER BY number", state_name(state));
  std::vector<Job> jobs;
  while (row.step()) jobs.push_back(job_at(row));
  return jobs;
}

std::map<std::string, std::int64_t> JobStore::counts_by_state() {
  std::map<std::string, std::int64_t> counts;
  for (const char* name : kStateNames) counts[name] = 0;
  const std::scoped_lock lock(mutex_);
  Query row = database_.query("SELECT state, count(*) FROM job GROUP BY state");
  while (row.step()) counts[row.text(0)] = row.integer(1);
  return counts;
}

JobPrediction JobStore::predict(const std::string& owner, const std::string& kind, std::uint64_t scene_bytes) {
  constexpr std::int64_t kLatest = 21;
  std::vector<double> seconds, rss_bytes;
  const std::scoped_lock lock(mutex_);
  Query row = database_.query(
      "SELECT finished_ms - started_ms, peak_rss_bytes, bytes FROM job JOIN job_file ON job_file.job = id AND purpose = 'input' AND role = "
      "'scene' WHERE owner = ? AND kind = ? AND state = 'succeeded' AND peak_rss_bytes IS NOT NULL AND bytes > 0 ORDER BY number DESC "
      "LIMIT ?",
      owner, kind, kLatest);
  while (row.step()) {
    const double share = static_cast<double>(scene_bytes) / static_cast<double>(row.integer(2));
    seconds.push_back(1e-3 * static_cast<double>(row.integer(0)) * share);
    rss_bytes.push_back(static_cast<double>(row.integer(1)) * share);
  }
  if (seconds.empty()) return {};
  const auto median = [](std::vector<double>& values) {
    const auto middle = values.begin() + std::ssize(values) / 2;
    std::ranges::nth_element(values, middle);
    return *middle;
  };
  return {median(seconds), median(rss_bytes), static_cast<int>(seconds.size())};
}

std::vector<Job> JobStore::finished_before(std::int64_t moment_ms) {
  const std::scoped_lock lock(mutex_);
  Query row = database_.query(std::string("SELECT ") + kJobColumns + " FROM job WHERE finished_ms < ? ORDER BY number", moment_ms);
  std::vector<Job> jobs;
  while (row.step()) jobs.push_back(job_at(row));
  return jobs;
}

Upload JobStore::add_upload(const std::string& owner, const StoredFile& file) {
  const Upload upload{random_id(), owner, file, now_ms()};
  const std::scoped_lock lock(mutex_);
  database_.run("INSERT INTO upload (id, owner, name, bytes, sha256, created_ms) VALUES (?, ?, ?, ?, ?, ?)", upload.id, owner, file.name,
                static_cast<std::int64_t>(file.bytes), file.sha256, upload.created_ms);
  return upload;
}

std::optional<Upload> JobStore::find_upload(const std::string& owner, const std::string& id) {
  const std::scoped_lock lock(mutex_);
  Query row = database_.query("SELECT id, owner, name, bytes, sha256, created_ms FROM upload WHERE id = ? AND owner = ?", id, owner);
  if (!row.step()) return std::nullopt;
  return upload_at(row);
}

std::vector<Upload> JobStore::uploads_of(const std::string& owner) {
  const std::scoped_lock lock(mutex_);
  Query row =
      database_.query("SELECT id, owner, name, bytes, sha256, created_ms FROM upload WHERE owner = ? ORDER BY created_ms DESC, id", owner);
  std::vector<Upload> uploads;
  while (row.step()) uploads.push_back(upload_at(row));
  return uploads;
}

bool JobStore::remove_upload(const std::string& owner, const std::string& id) {
  const std::scoped_lock lock(mutex_);
  database_.run("DELETE FROM upload WHERE id = ? AND owner = ?", id, owner);
  return database_.changes() > 0;
}

void JobStore::remove_uploads_before(std::int64_t moment_ms) {
  const std::scoped_lock lock(mutex_);
  database_.run("DELETE FROM upload WHERE created_ms < ? AND sha256 NOT IN (SELECT sha256 FROM job_file)", moment_ms);
}

std::uint64_t JobStore::bytes_of(const std::string& owner, const std::set<std::string>& but) {
  const std::scoped_lock lock(mutex_);
  Query row = database_.query(
      "SELECT sha256, bytes FROM upload WHERE owner = ? UNION "
      "SELECT job_file.sha256, job_file.bytes FROM job_file JOIN job ON job.id = job_file.job WHERE job.owner = ?",
      owner, owner);
  std::uint64_t bytes = 0;
  while (row.step())
    if (!but.contains(row.text(0))) bytes += static_cast<std::uint64_t>(row.integer(1));
  return bytes;
}

std::vector<std::string> JobStore::blobs_in_use() {
  const std::scoped_lock lock(mutex_);
  Query row = database_.query("SELECT sha256 FROM job_file UNION SELECT sha256 FROM upload");
  std::vector<std::string> names;
  while (row.step()) names.push_back(row.text(0));
  return names;
}

}  // namespace standin
