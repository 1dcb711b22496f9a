// The routes of the service, in one table: what is served, what is documented, and what is tested are the same rows.
//
// Transport only: a handler reads a request, asks the store, and writes an answer. None blocks, none runs a job.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/http/server.h"
#include "server/service/catalogue.h"
#include "server/service/job_request.h"
#include "server/service/owner_tally.h"
#include "server/service/tokens.h"
#include "server/store/blob_store.h"
#include "server/store/job_store.h"

namespace standin {

struct ApiConfig {
  std::filesystem::path web;      // the page; empty: none
  std::filesystem::path presets;  // folder of configuration files; empty: none
  bool loopback_only = true;      // requests must name this machine as their host then
  std::uint64_t most_body_bytes = 64 * 1024;
  std::uint64_t most_upload_bytes = std::uint64_t{2} << 30;
  std::uint64_t quota_bytes = std::uint64_t{50} << 30;  // of all blobs
  unsigned most_streams = 200;
  unsigned most_uploads = 8;  // at a time
  double owner_share = 1.0;   // of streams, uploads and quota that one owner may take, in (0,1]
};

/// What the API asks of the rest of the service.
struct ApiHooks {
  const Catalogue& scenes;
  const Catalogue& targets;
  std::function<void()> queue_changed;
  std::function<double()> worker_cpu_s;
  std::function<std::uint64_t()> stored_bytes;  // of blobs and work folders, as of a moment ago
  std::function<void(const std::string&)> log;
};

class Api : public HttpApplication {
 public:
  enum class Body { kNone, kJson, kUpload };
  struct Exchange {
    const HttpRequest& request;
    std::map<std::string, std::string> path;  // what stands for {name} in the pattern
    nlohmann::json body;                      // of kJson
    BlobStore::Incoming* upload = nullptr;    // of kUpload
  };
  struct Route {
    std::string method;
    std::string pattern;  // "/v1/jobs/{id}"; {name...} takes the rest
    std::string summary;
    Body body = Body::kNone;
    bool open = false;  // to everybody, without a token
    std::vector<int> statuses;
    HttpResponse (Api::*handler)(const Exchange&);
    std::vector<std::string> query = {};
  };

  Api(ApiConfig config, JobStore& jobs, BlobStore& blobs, Tokens tokens, ApiHooks hooks);

  std::unique_ptr<BodySink> begin(HttpRequest& request) override;
  HttpResponse answer(const HttpRequest& request, BodySink& body) override;
  void unexpected(const std::string& what) override { hooks_.log(what); }
  void answered(const HttpRequest& request, int status, double seconds) override;

  [[nodiscard]] static const std::vector<Route>& routes();
  [[nodiscard]] static nlohmann::json openapi();

 private:
  struct Match {
    const Route* route = nullptr;
    std::map<std::string, std::string> path;
  };
  [[nodiscard]] static Match match(const HttpRequest& request);
  void require_own_host(const HttpRequest& request) const;

  HttpResponse submit(const Exchange& exchange);
  HttpResponse list_jobs(const Exchange& exchange);
  HttpResponse get_job(const Exchange& exchange);
  HttpResponse delete_job(const Exchange& exchange);
  HttpResponse cancel_job(const Exchange& exchange);
  HttpResponse job_events(const Exchange& exchange);
  HttpResponse list_artifacts(const Exchange& exchange);
  HttpResponse get_artifact(const Exchange& exchange);
  HttpResponse get_scene(const Exchange& exchange);
  HttpResponse upload(const Exchange& exchange);
  HttpResponse list_uploads(const Exchange& exchange);
  HttpResponse get_upload(const Exchange& exchange);
  HttpResponse get_upload_content(const Exchange& exchange);
  HttpResponse delete_upload(const Exchange& exchange);
  HttpResponse list_scenes(const Exchange& exchange);
  HttpResponse list_targets(const Exchange& exchange);
  HttpResponse get_schema(const Exchange& exchange);
  HttpResponse list_presets(const Exchange& exchange);
  HttpResponse health(const Exchange& exchange);
  HttpResponse ready(const Exchange& exchange);
  HttpResponse metrics(const Exchange& exchange);
  HttpResponse get_openapi(const Exchange& exchange);
  HttpResponse page(const Exchange& exchange);

  [[nodiscard]] HttpResponse accepted(const Job& job);
  void require_stream(const std::string& owner) const;
  void require_upload(const std::string& owner) const;
  void require_room(const std::string& owner);
  [[nodiscard]] Job job_of(const Exchange& exchange);
  [[nodiscard]] nlohmann::json document_of(const Job& job);
  [[nodiscard]] nlohmann::json dry_run(const JobRequest& request, const NewJob& job);
  [[nodiscard]] StoredFile resolve(const FileReference& file, const Catalogue* catalogue, const std::string& owner, const char* pointer);
  [[nodiscard]] StoredFile made_by_job(const std::string& owner, const std::string& id, JobKind kind, const std::string& name,
                                       const char* pointer);
  [[nodiscard]] std::map<std::string, StoredFile> inputs_of(const JobRequest& request, const std::string& owner);

  const ApiConfig config_;
  JobStore& jobs_;
  BlobStore& blobs_;
  const Tokens tokens_;
  const ApiHooks hooks_;
  const nlohmann::json presets_;
  std::map<std::string, std::filesystem::path> page_files_;  // by URL path
  const OwnerTally streams_, uploads_;
  std::mutex counting_;
  std::map<int, std::uint64_t> answers_;  // by status
  double answer_s_ = 0.0;
};

/// ISO 8601; null where there is none.
[[nodiscard]] nlohmann::json time_text(std::optional<std::int64_t> moment_ms);
/// What an artifact is, by its name.
[[nodiscard]] std::string media_type(const std::string& name);

}  // namespace standin
