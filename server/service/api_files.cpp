// Routes of files: uploads, what the configured folders offer, and the page.
#include <fstream>

#include "render/base/error.h"
#include "server/service/api.h"
#include "server/service/work_folder.h"
#include "server/store/folder_size.h"

namespace standin {
namespace {

using nlohmann::json;

json upload_json(const Upload& upload) {
  return {{"id", upload.id},
          {"name", upload.file.name},
          {"bytes", upload.file.bytes},
          {"sha256", upload.file.sha256},
          {"created", time_text(upload.created_ms)}};
}

json files_json(const std::vector<StoredFile>& files) {
  json list = json::array();
  for (const StoredFile& file : files) list.push_back({{"name", file.name}, {"bytes", file.bytes}, {"sha256", file.sha256}});
  return list;
}

Upload upload_of(JobStore& jobs, const std::string& owner, const std::string& id) {
  if (auto upload = jobs.find_upload(owner, id)) return *upload;
  throw Failure(ErrorWord::kNotFound, "no upload " + id);
}

}  // namespace

HttpResponse Api::upload(const Exchange& exchange) {
  const auto name = exchange.request.query.find("name");
  if (name == exchange.request.query.end() || name->second.empty())
    throw Failure(ErrorWord::kBadRequest, "query name is missing: the file's name, with the ending that says its format");
  if (exchange.upload->bytes() == 0) throw Failure(ErrorWord::kBadRequest, "the upload is empty");
  const StoredFile file = exchange.upload->finish(harmless_name(name->second, "scene"));
  const Upload made = jobs_.add_upload(exchange.request.owner, file);
  HttpResponse response = json_response(201, upload_json(made));
  response.headers.emplace_back("Location", "/v1/uploads/" + made.id);
  return response;
}

HttpResponse Api::list_uploads(const Exchange& exchange) {
  json list = json::array();
  for (const Upload& upload : jobs_.uploads_of(exchange.request.owner)) list.push_back(upload_json(upload));
  return json_response(200, {{"uploads", list}});
}

HttpResponse Api::get_upload(const Exchange& exchange) {
  return json_response(200, upload_json(upload_of(jobs_, exchange.request.owner, exchange.path.at("id"))));
}

HttpResponse Api::get_upload_content(const Exchange& exchange) {
  const StoredFile file = upload_of(jobs_, exchange.request.owner, exchange.path.at("id")).file;
  return file_response(exchange.request, blobs_.path_of(file.sha256), file.bytes, file.sha256, "application/octet-stream");
}

HttpResponse Api::delete_upload(const Exchange& exchange) {
  const Upload upload = upload_of(jobs_, exchange.request.owner, exchange.path.at("id"));
  jobs_.remove_upload(exchange.request.owner, upload.id);
  hooks_.queue_changed();
  return {204, {}, std::string()};
}

HttpResponse Api::list_scenes(const Exchange&) {
  return json_response(200, {{"scenes", files_json(hooks_.scenes.files())}});
}

HttpResponse Api::list_targets(const Exchange&) {
  return json_response(200, {{"targets", files_json(hooks_.targets.files())}});
}

HttpResponse Api::get_schema(const Exchange&) {
  return json_response(200, spec_schema(is_services_own));
}

HttpResponse Api::list_presets(const Exchange&) {
  return json_response(200, {{"presets", presets_}});
}

// The page is one document; what it shows is in the part of the address that it reads itself.
HttpResponse Api::page(const Exchange& exchange) {
  const std::string& path = exchange.request.path;
  auto found = page_files_.find(path == "/" ? "/index.html" : path);
  const bool names_a_file = path.substr(path.find_last_of('/') + 1).find('.') != std::string::npos;
  if (found == page_files_.end() && !names_a_file && !path.starts_with("/v1")) found = page_files_.find("/index.html");
  if (found == page_files_.end()) throw Failure(ErrorWord::kNotFound, "no route " + path);
  HttpResponse response{200,
                        {{"Content-Type", media_type(found->second.filename().string())},
                         {"X-Content-Type-Options", "nosniff"},
                         {"Cache-Control", found->first.starts_with("/assets/") ? "public, max-age=31536000, immutable" : "no-cache"}},
                        FileBody{found->second, 0, std::filesystem::file_size(found->second)}};
  if (found->first.ends_with(".html"))
    response.headers.emplace_back("Content-Security-Policy",
                                  "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; script-src 'self' "
                                  "'wasm-unsafe-eval'; worker-src 'self' blob:; connect-src 'self' blob: data:; frame-ancestors 'none'");
  return response;
}

}  // namespace standin
