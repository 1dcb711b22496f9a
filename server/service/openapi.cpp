// The table of routes, and the OpenAPI document made of it.
#include <set>
#include <sstream>

#include "server/http/message.h"
#include "server/service/api.h"

namespace standin {
namespace {

using nlohmann::json;

json parameters_of(const Api::Route& route) {
  json parameters = json::array();
  std::istringstream parts(route.pattern);
  for (std::string part; std::getline(parts, part, '/');) {
    if (!part.starts_with('{')) continue;
    const std::string name = part.substr(1, part.find_first_of(".}") - 1);
    parameters.push_back({{"name", name}, {"in", "path"}, {"required", true}, {"schema", {{"type", "string"}}}});
  }
  for (const auto& name : route.query)
    parameters.push_back({{"name", name}, {"in", "query"}, {"required", name == "name"}, {"schema", {{"type", "string"}}}});
  return parameters;
}

json body_of(const Api::Route& route) {
  if (route.body == Api::Body::kJson)
    return {{"required", true}, {"content", {{"application/json", {{"schema", {{"$ref", "#/components/schemas/JobRequest"}}}}}}}};
  const json bytes = {{"schema", {{"type", "string"}, {"format", "binary"}}}};
  return {{"required", true},
          {"content",
           {{"application/octet-stream", bytes}, {"model/gltf-binary", bytes}, {"application/json", bytes}, {"application/zip", bytes}}}};
}

json responses_of(const Api::Route& route) {
  json responses = json::object();
  for (const int status : route.statuses) {
    json& response = responses[std::to_string(status)];
    response["description"] = status < 400 ? "as asked" : "a problem";
    if (status >= 400) response["content"]["application/problem+json"]["schema"]["$ref"] = "#/components/schemas/Problem";
  }
  return responses;
}

std::string without_dots(std::string pattern) {
  if (const std::size_t dots = pattern.find("..."); dots != std::string::npos) pattern.erase(dots, 3);
  return pattern;
}

json problem_schema() {
  const json text = {{"type", "string"}}, number = {{"type", "integer"}};
  return {{"type", "object"},
          {"required", {"type", "title", "status", "word", "detail"}},
          {"properties",
           {{"type", text},
            {"title", text},
            {"status", number},
            {"word", {{"type", "string"}, {"description", "stable; programs rely on it"}}},
            {"exit_code", number},
            {"detail", text},
            {"errors", {{"type", "array"}, {"items", {{"type", "object"}, {"properties", {{"pointer", text}, {"detail", text}}}}}}}}}};
}

}  // namespace

const std::vector<Api::Route>& Api::routes() {
  static const std::vector<Route> table = {
      {"POST",
       "/v1/jobs",
       "submit a job; header Idempotency-Key; dry_run only validates",
       Body::kJson,
       false,
       {200, 202, 400, 413, 415, 422, 429, 507},
       &Api::submit},
      {"GET", "/v1/jobs", "jobs, newest first", Body::kNone, false, {200, 400}, &Api::list_jobs, {"state", "kind", "limit", "after"}},
      {"GET", "/v1/jobs/{id}", "one job", Body::kNone, false, {200, 404}, &Api::get_job},
      {"DELETE",
       "/v1/jobs/{id}",
       "remove a job that does not run, and its artifacts",
       Body::kNone,
       false,
       {204, 404, 409},
       &Api::delete_job},
      {"POST", "/v1/jobs/{id}/cancel", "cancel it", Body::kNone, false, {202, 404}, &Api::cancel_job},
      {"GET",
       "/v1/jobs/{id}/events",
       "server-sent events until it ends; header Last-Event-ID goes on after that event",
       Body::kNone,
       false,
       {200, 404, 503},
       &Api::job_events},
      {"GET", "/v1/jobs/{id}/artifacts", "what it made", Body::kNone, false, {200, 404}, &Api::list_artifacts},
      {"GET",
       "/v1/jobs/{id}/artifacts/{path...}",
       "one artifact; Range, If-Range, If-None-Match",
       Body::kNone,
       false,
       {200, 206, 304, 404, 409, 416},
       &Api::get_artifact},
      {"GET", "/v1/jobs/{id}/scene", "the scene it was given", Body::kNone, false, {200, 206, 304, 404, 416}, &Api::get_scene},
      {"POST",
       "/v1/uploads",
       "a scene or target file, as it is",
       Body::kUpload,
       false,
       {201, 400, 413, 415, 503, 507},
       &Api::upload,
       {"name"}},
      {"GET", "/v1/uploads", "uploads, newest first", Body::kNone, false, {200}, &Api::list_uploads},
      {"GET", "/v1/uploads/{id}", "one upload", Body::kNone, false, {200, 404}, &Api::get_upload},
      {"GET", "/v1/uploads/{id}/content", "its bytes", Body::kNone, false, {200, 206, 304, 404, 416}, &Api::get_upload_content},
      {"DELETE", "/v1/uploads/{id}", "remove it; jobs keep what they were given", Body::kNone, false, {204, 404}, &Api::delete_upload},
      {"GET", "/v1/scenes", "scenes that may be named", Body::kNone, false, {200}, &Api::list_scenes},
      {"GET", "/v1/targets", "target files that may be named", Body::kNone, false, {200}, &Api::list_targets},
      {"GET", "/v1/schema", "JSON Schema of a job's settings", Body::kNone, true, {200}, &Api::get_schema},
      {"GET", "/v1/presets", "settings that the service offers by name", Body::kNone, true, {200}, &Api::list_presets},
      {"GET", "/healthz", "the process lives", Body::kNone, true, {200}, &Api::health},
      {"GET", "/readyz", "the store answers and has room", Body::kNone, true, {200, 507}, &Api::ready},
      {"GET", "/metrics", "for Prometheus", Body::kNone, false, {200}, &Api::metrics},
      {"GET", "/openapi.json", "this document", Body::kNone, true, {200}, &Api::get_openapi},
      {"GET", "/", "the page", Body::kNone, true, {200, 404}, &Api::page},
      {"GET", "/{path...}", "the page's files", Body::kNone, true, {200, 404}, &Api::page},
  };
  return table;
}

json Api::openapi() {
  json document = {
      {"openapi", "3.1.0"},
      {"info",
       {{"title", "Standin"}, {"version", "1"}, {"description", "Impostor placement jobs. Errors are RFC 9457 problem documents."}}},
      {"paths", json::object()}};
  for (const Route& route : routes()) {
    std::string method = route.method;
    for (char& c : method) c = static_cast<char>(std::tolower(c));
    json operation = {{"summary", route.summary}, {"parameters", parameters_of(route)}, {"responses", responses_of(route)}};
    if (route.body != Body::kNone) operation["requestBody"] = body_of(route);
    if (route.open) operation["security"] = json::array();
    document["paths"][without_dots(route.pattern)][method] = operation;
  }
  document["components"]["schemas"] = {{"JobRequest", job_request_schema()}, {"Problem", problem_schema()}};
  document["components"]["securitySchemes"]["token"] = {{"type", "http"}, {"scheme", "bearer"}};
  document["security"] = json::array({{{"token", json::array()}}});
  return document;
}

}  // namespace standin
