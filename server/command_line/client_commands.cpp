// submit, status, fetch, cancel: a job of a service, as if it ran here.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <thread>

#include "render/base/error.h"
#include "render/base/sha256.h"
#include "render/base/staged_file.h"
#include "server/client/http_client.h"
#include "server/command_line/commands.h"
#include "server/error_table.h"
#include "server/files/output_folder.h"
#include "server/service/job_request.h"

namespace standin {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::chrono::milliseconds kPoll{500};

HttpClient client_of(const CommandContext& context) {
  const char* token = std::getenv("STANDIN_TOKEN");
  return {context.arguments.client.server, token == nullptr ? "" : token};
}

// What a server says of itself is believed as far as it has the shape that it should.
template <class Read>
auto from_server(Read&& read) {
  try {
    return read();
  } catch (const json::exception& error) {
    throw Failure(ErrorWord::kServerUnreachable, std::string("the server's answer is not that of a Standin service: ") + error.what());
  }
}

json job_document(const HttpClient& client, const std::string& id, const WorkBudget& budget) {
  return body_or_failure(client.get("/v1/jobs/" + HttpClient::escaped(id), budget));
}

// The same bytes under the same name are sent once.
json uploaded(const HttpClient& client, const fs::path& file, const WorkBudget& budget) {
  const std::string sha256 = sha256_hex(read_file(file)), name = file.filename().string();
  for (const json& upload : body_or_failure(client.get("/v1/uploads", budget)).at("uploads"))
    if (upload.at("sha256") == sha256 && upload.at("name") == name) return {{"upload", upload.at("id")}};
  budget.report("upload", 0.0);
  return {{"upload", body_or_failure(client.post_file("/v1/uploads?name=" + HttpClient::escaped(name), file, budget)).at("id")}};
}

// As a body has them: numbers where the argument is one.
json arguments_of(const ClientArguments& client) {
  json object = json::object();
  for (const ArgumentField& field : argument_fields()) {
    const auto given = client.arguments.find(field.key);
    if (given == client.arguments.end()) continue;
    json value = given->second;
    if (field.schema.at("type") != "string") value = json::parse(given->second, nullptr, false);
    if (value.is_discarded()) throw Failure(ErrorWord::kBadUsage, field.key + " = " + given->second + ": a number is expected");
    object[field.key] = value;
  }
  return object;
}

json request_of(const CommandContext& context, const HttpClient& http) {
  const CommandArguments& arguments = context.arguments;
  const ClientArguments& client = arguments.client;
  json request = {{"kind", client.kind}, {"spec", changed_settings(context.spec)}, {"arguments", arguments_of(client)}};
  if (!client.label.empty()) request["label"] = client.label;
  if (!client.job.empty()) request["job"] = client.job;
  if (!client.scene_name.empty()) request["scene"] = {{"name", client.scene_name}};
  if (!client.target_name.empty()) request["target"] = {{"name", client.target_name}};
  if (!arguments.scenes.empty()) request["scene"] = uploaded(http, arguments.scenes.front(), context.budget);
  if (!arguments.target.empty()) request["target"] = uploaded(http, arguments.target, context.budget);
  if (!arguments.baseline.empty()) request["baseline"] = uploaded(http, arguments.baseline, context.budget);
  return request;
}

bool ended(const json& job) {
  return job.at("state") != "queued" && job.at("state") != "running";
}

json wait_for(const HttpClient& client, const std::string& id, const WorkBudget& budget) {
  std::string shown;
  for (;;) {
    json job = job_document(client, id, budget);
    if (ended(job)) return job;
    const std::string stage = job["state"] == "queued" ? "queued" : job["stage"].get<std::string>();
    budget.report(stage, stage == shown ? std::max(1e-9, job["fraction"].get<double>()) : 0.0);
    shown = stage;
    budget.check();
    std::this_thread::sleep_for(kPoll);
  }
}

// As the local command would have ended.
int exit_code_of(const json& job) {
  if (job.at("state") == "succeeded") return job.at("aim_met") == true ? 0 : 1;
  if (job.at("state") == "cancelled") throw Failure(ErrorWord::kCancelled, "job " + job.at("id").get<std::string>() + " was cancelled");
  const json& problem = job.at("error");
  throw Failure(word_named(problem.at("word").get<std::string>()), problem.at("detail").get<std::string>());
}

void fetch_into(const HttpClient& client, const json& job, const fs::path& folder, const WorkBudget& budget) {
  const std::string id = job.at("id");
  if (job.at("artifacts").empty())
    throw Failure(ErrorWord::kNotFinished, "job " + id + " is " + job.at("state").get<std::string>() + " and has no result");
  OutputFolder output(folder, "job " + id + " of a service");
  for (const json& artifact : job.at("artifacts")) {
    const std::string path = artifact.at("path");
    if (path.find('/') != std::string::npos || path.starts_with('.'))
      throw Failure(ErrorWord::kUriForbidden, "artifact " + path + " leaves the folder");
    const fs::path file = output.path_of(path);
    const Answer answer = client.download("/v1/jobs/" + HttpClient::escaped(id) + "/artifacts/" + HttpClient::escaped(path), file, budget);
    if (answer.status != 200) (void)body_or_failure(answer);
    if (sha256_hex(read_file(file)) != artifact.at("sha256"))
      throw Failure(ErrorWord::kFileBroken, "artifact " + path + " came with other bytes than its SHA-256 says");
  }
  output.commit();
}

void print_job(const json& job, bool as_json) {
  if (as_json) {
    std::cout << job.dump(2) << "\n";
    return;
  }
  std::printf("%s %s %s", job.at("id").get<std::string>().c_str(), job.at("kind").get<std::string>().c_str(),
              job.at("state").get<std::string>().c_str());
  if (job.at("state") == "running")
    std::printf(" %s %.0f %%", job.at("stage").get<std::string>().c_str(), 100.0 * job.at("fraction").get<double>());
  if (job.at("state") == "running" && job.at("best_so_far").is_object())
    for (const auto& [name, value] : job["best_so_far"].items()) std::printf(", %s %s", name.c_str(), value.dump().c_str());
  if (job.at("aim_met") == false) std::printf(", its aim could not be met");
  std::printf("\n");
}

int submit(const CommandContext& context) {
  const HttpClient client = client_of(context);
  json job = body_or_failure(client.post_json("/v1/jobs", request_of(context, client), {}, context.budget));
  const std::string id = job.at("id");
  const bool fetch = !context.arguments.output.empty();
  if (!context.arguments.json) std::printf("%s\n", id.c_str());
  std::fflush(stdout);
  if (context.arguments.client.wait || fetch) job = wait_for(client, id, context.budget);
  if (context.arguments.json) print_job(job, true);
  if (!ended(job)) return 0;
  const int exit_code = exit_code_of(job);
  if (fetch) fetch_into(client, job, context.arguments.output, context.budget);
  return exit_code;
}

int status(const CommandContext& context) {
  const HttpClient client = client_of(context);
  const std::string& id = context.arguments.client.job;
  const json job = context.arguments.client.wait ? wait_for(client, id, context.budget) : job_document(client, id, context.budget);
  print_job(job, context.arguments.json);
  return ended(job) ? exit_code_of(job) : 0;
}

int fetch(const CommandContext& context) {
  const HttpClient client = client_of(context);
  const json job = job_document(client, context.arguments.client.job, context.budget);
  fetch_into(client, job, context.arguments.output, context.budget);
  return exit_code_of(job);
}

int cancel(const CommandContext& context) {
  const HttpClient client = client_of(context);
  print_job(body_or_failure(client.post_json("/v1/jobs/" + HttpClient::escaped(context.arguments.client.job) + "/cancel", json::object(),
                                             {}, context.budget)),
            context.arguments.json);
  return 0;
}

}  // namespace

int submit_command(const CommandContext& context) {
  return from_server([&] { return submit(context); });
}

int status_command(const CommandContext& context) {
  return from_server([&] { return status(context); });
}

int fetch_command(const CommandContext& context) {
  return from_server([&] { return fetch(context); });
}

int cancel_command(const CommandContext& context) {
  return from_server([&] { return cancel(context); });
}

}  // namespace standin
