#include "server/service/api.h"

#include <algorithm>
#include <set>
#include <sstream>

#include "render/base/error.h"
#include "render/base/json_text.h"

namespace standin {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// A body that goes straight to disk.
class UploadBody : public BodySink {
 public:
  UploadBody(BlobStore& blobs, std::uint64_t most_bytes, std::unique_ptr<OwnerTally::Hold> open)
      : incoming_(blobs), most_bytes_(most_bytes), open_(std::move(open)) {}
  void write(std::string_view piece) override {
    if (piece.size() > most_bytes_ - incoming_.bytes())
      throw Failure(ErrorWord::kTooLarge, "the upload has more than " + std::to_string(most_bytes_) + " bytes");
    incoming_.write(piece);
  }
  BlobStore::Incoming& incoming() { return incoming_; }

 private:
  BlobStore::Incoming incoming_;
  std::uint64_t most_bytes_;
  std::unique_ptr<OwnerTally::Hold> open_;
};

std::vector<std::string> parts_of(const std::string& path) {
  std::vector<std::string> parts;
  std::istringstream stream(path);
  for (std::string part; std::getline(stream, part, '/');) parts.push_back(part);
  return parts;
}

// "{name}" takes one part, "{name...}" at the end all the rest.
bool fits(const std::vector<std::string>& pattern, const std::vector<std::string>& path, std::map<std::string, std::string>& taken) {
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    if (i >= path.size()) return false;
    const std::string& part = pattern[i];
    if (part.ends_with("...}")) {
      std::string rest = path[i];
      for (std::size_t k = i + 1; k < path.size(); ++k) rest += "/" + path[k];
      taken[part.substr(1, part.size() - 5)] = rest;
      return true;
    }
    if (part.starts_with('{'))
      taken[part.substr(1, part.size() - 2)] = path[i];
    else if (part != path[i])
      return false;
  }
  return pattern.size() == path.size();
}

std::string media_type_of(const HttpRequest& request) {
  std::string type = request.header("content-type");
  type = type.substr(0, type.find(';'));
  while (type.ends_with(' ')) type.pop_back();
  return type;
}

void require_type(const HttpRequest& request, const std::set<std::string>& types) {
  const std::string type = media_type_of(request);
  if (types.contains(type)) return;
  std::string expected;
  for (const auto& one : types) expected += (expected.empty() ? "" : ", ") + one;
  throw Failure(ErrorWord::kMediaUnsupported, "Content-Type \"" + type + "\": " + expected + " is expected");
}

void require_length(const HttpRequest& request, std::uint64_t most_bytes) {
  const std::uint64_t announced = std::strtoull(request.header("content-length").c_str(), nullptr, 10);
  if (announced > most_bytes)
    throw Failure(ErrorWord::kTooLarge,
                  "a body of " + std::to_string(announced) + " bytes, no more than " + std::to_string(most_bytes) + " are taken");
}

std::string host_name(const std::string& host) {
  const std::size_t bracket = host.starts_with('[') ? host.find(']') : host.find(':');
  if (!host.starts_with('[')) return host.substr(0, bracket);
  return bracket == std::string::npos ? host : host.substr(0, bracket + 1);
}

json presets_of(const fs::path& folder) {
  json presets = json::array();
  if (folder.empty()) return presets;
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".toml") files.insert(entry.path());
  for (const fs::path& file : files) {
    JobSpec spec;
    read_config(spec, file);
    presets.push_back({{"name", file.stem().string()}, {"spec", changed_settings(spec)}});
  }
  return presets;
}

std::map<std::string, fs::path> files_of_page(const fs::path& folder) {
  std::map<std::string, fs::path> files;
  if (folder.empty() || !fs::is_directory(folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files["/" + fs::relative(entry.path(), folder).generic_string()] = entry.path();
  return files;
}

// What strangers gave is data, never a page of this server's.
void harden(HttpResponse& response) {
  const auto has = [&](const char* name) {
    return std::ranges::any_of(response.headers, [&](const auto& header) { return header.first == name; });
  };
  if (!has("X-Content-Type-Options")) response.headers.emplace_back("X-Content-Type-Options", "nosniff");
  if (!has("Content-Security-Policy")) response.headers.emplace_back("Content-Security-Policy", "sandbox; default-src 'none'");
}

constexpr int kDeepestBody = 16;
// `what`: as in "3 of them".
void require_place(const OwnerTally& open, unsigned most, unsigned share, const std::string& owner, const std::string& what) {
  if (open.all() >= most) throw Failure(ErrorWord::kBusy, std::to_string(most) + " " + what + ", no more may be");
  if (open.of(owner) >= share) throw Failure(ErrorWord::kBusy, std::to_string(share) + " " + what + " for you alone, no more may be");
}

const std::set<std::string> kUploadTypes = {"application/octet-stream", "application/json", "model/gltf-binary", "application/zip"};

}  // namespace

Api::Api(ApiConfig config, JobStore& jobs, BlobStore& blobs, Tokens tokens, ApiHooks hooks)
    : config_(std::move(config)),
      jobs_(jobs),
      blobs_(blobs),
      tokens_(std::move(tokens)),
      hooks_(std::move(hooks)),
      presets_(presets_of(config_.presets)),
      page_files_(files_of_page(config_.web)) {}

Api::Match Api::match(const HttpRequest& request) {
  static const std::vector<std::vector<std::string>> patterns = [] {
    std::vector<std::vector<std::string>> parts;
    for (const Route& route : routes()) parts.push_back(parts_of(route.pattern));
    return parts;
  }();
  const std::vector<std::string> path = parts_of(request.path);
  std::string allowed;
  for (std::size_t i = 0; i < patterns.size(); ++i) {
    const Route& route = routes()[i];
    Match match{&route, {}};
    if (!fits(patterns[i], path, match.path)) continue;
    if (route.method == request.method || (route.method == "GET" && request.method == "HEAD")) return match;
    if (allowed.find(route.method) == std::string::npos) allowed += (allowed.empty() ? "" : ", ") + route.method;
  }
  if (!allowed.empty())
    throw FailureWithHeader(ErrorWord::kMethodNotAllowed, request.method + " " + request.path + ": it takes " + allowed, "Allow", allowed);
  throw Failure(ErrorWord::kNotFound, "no route " + request.path);
}

// Without tokens, a page of another site must not reach the service through its reader's browser: not by a name that resolves to this
// machine (the Host header tells), not by a request of its own (the Origin header tells).
void Api::require_own_host(const HttpRequest& request) const {
  static const std::set<std::string> kLoopback = {"127.0.0.1", "localhost", "[::1]", ""};
  const std::string host = request.header("host");
  if (config_.loopback_only && !kLoopback.contains(host_name(host)))
    throw Failure(ErrorWord::kForbidden, "host " + host + " is not this server");
  const std::string origin = request.header("origin");
  const std::size_t scheme = origin.find("://");
  if (!origin.empty() && request.method != "GET" && (scheme == std::string::npos || origin.substr(scheme + 3) != host))
    throw Failure(ErrorWord::kForbidden, "a page of " + origin + " asks, not one of this server");
}

void Api::require_stream(const std::string& owner) const {
  require_place(streams_, config_.most_streams, share_of(config_.most_streams, config_.owner_share), owner, "event streams are open");
}

void Api::require_upload(const std::string& owner) const {
  require_place(uploads_, config_.most_uploads, share_of(config_.most_uploads, config_.owner_share), owner, "uploads are on their way");
}

void Api::require_room(const std::string& owner) {
  if (hooks_.stored_bytes() >= config_.quota_bytes)
    throw Failure(ErrorWord::kDiskFull,
                  "the service keeps " + std::to_string(config_.quota_bytes) + " bytes at most: delete jobs or uploads");
  if (config_.owner_share >= 1.0) return;
  const auto share = static_cast<std::uint64_t>(config_.owner_share * static_cast<double>(config_.quota_bytes));
  std::set<std::string> offered;  // what the operator put there is nobody's burden
  for (const Catalogue* catalogue : {&hooks_.scenes, &hooks_.targets})
    for (const StoredFile& file : catalogue->files()) offered.insert(file.sha256);
  const std::uint64_t mine = jobs_.bytes_of(owner, offered);
  if (mine >= share)
    throw Failure(ErrorWord::kQuotaFull, "your jobs and uploads hold " + std::to_string(mine) + " bytes, no more than " +
                                             std::to_string(share) + " may be: delete some");
}

std::unique_ptr<BodySink> Api::begin(HttpRequest& request) {
  require_own_host(request);
  const Match found = match(request);
  if (!found.route->open) {
    const auto owner = tokens_.owner_of(request.header("authorization"));
    if (!owner) throw Failure(ErrorWord::kUnauthorized, "a known bearer token is needed");
    request.owner = *owner;
  }
  switch (found.route->body) {
    case Body::kNone:
      return std::make_unique<TextBody>(config_.most_body_bytes);
    case Body::kJson:
      require_type(request, {"application/json"});
      require_length(request, config_.most_body_bytes);
      return std::make_unique<TextBody>(config_.most_body_bytes);
    case Body::kUpload:
      require_type(request, kUploadTypes);
      require_length(request, config_.most_upload_bytes);
      require_room(request.owner);
      require_upload(request.owner);
      return std::make_unique<UploadBody>(blobs_, config_.most_upload_bytes, uploads_.hold(request.owner));
  }
  return nullptr;
}

HttpResponse Api::answer(const HttpRequest& request, BodySink& body) {
  const Match found = match(request);
  Exchange exchange{request, found.path, nullptr};
  if (found.route->body == Body::kJson)
    exchange.body = parse_json(dynamic_cast<TextBody&>(body).text(), "the body", ErrorWord::kBadRequest, kDeepestBody);
  if (found.route->body == Body::kUpload) exchange.upload = &dynamic_cast<UploadBody&>(body).incoming();
  HttpResponse response = (this->*found.route->handler)(exchange);
  if (request.path.starts_with("/v1")) harden(response);
  return response;
}

void Api::answered(const HttpRequest&, int status, double seconds) {
  const std::scoped_lock lock(counting_);
  ++answers_[status];
  answer_s_ += seconds;
}

std::string media_type(const std::string& name) {
  static const std::map<std::string, std::string> kTypes = {
      {".json", "application/json"}, {".glb", "model/gltf-binary"}, {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript"},    {".css", "text/css"},          {".svg", "image/svg+xml"},
      {".png", "image/png"},         {".csv", "text/csv"},          {".txt", "text/plain"},
      {".wasm", "application/wasm"}, {".map", "application/json"},  {".ico", "image/x-icon"}};
  const auto found = kTypes.find(fs::path(name).extension().string());
  return found == kTypes.end() ? "application/octet-stream" : found->second;
}

}  // namespace standin
