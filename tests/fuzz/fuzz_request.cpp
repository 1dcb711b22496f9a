// HTTP requests as far as they are ours to understand: routes, queries, headers, bodies. libmicrohttpd has parsed the rest by then.
//
// An input is a request as it is written, without percent-encoding: "METHOD PATH?QUERY", lines of headers, an empty line, the body. In its
// path, "DONE", "WAITING" and "UPLOAD" stand for ids that the service knows.
#include <array>
#include <sstream>

#include "server/service/api.h"
#include "server/store/blob_store.h"
#include "server/store/job_store.h"
#include "tests/fuzz/input_file.h"

namespace fs = std::filesystem;

namespace standin::fuzz {
namespace {

using nlohmann::json;

constexpr const char* kFile = "0123456789abcdef";
constexpr int kRequestsEach = 500;  // then the service begins anew

// A service without its loop, its scheduler and its workers.
class Bench {
 public:
  Bench() {
    const StoredFile file = blobs_.copy(input_folder().write("file", kFile), "file.glb");
    upload_ = jobs_.add_upload(kLocalOwner, file).id;
    done_ = jobs_.submit({kLocalOwner, "calibrate", "done", {{"kind", "calibrate"}}, {{"scene", file}}}, "").job.id;
    (void)jobs_.start_next();
    StoredFile page = file, target = file;
    page.name = "report.html";
    target.name = "target.json";
    jobs_.finish(done_, {JobState::kSucceeded, true, nullptr, {page, target}, JobUse{1.0, 1}});
    waiting_ = jobs_.submit({kLocalOwner, "place", "waiting", {{"kind", "place"}}, {{"scene", file}}}, "").job.id;
  }
  ~Bench() { fs::remove_all(folder_); }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  Api& api() { return api_; }
  [[nodiscard]] std::string with_ids(std::string text) const {
    for (const auto& [name, id] : {std::pair<std::string, std::string>{"DONE", done_}, {"WAITING", waiting_}, {"UPLOAD", upload_}})
      if (const std::size_t at = text.find(name); at != std::string::npos) text.replace(at, name.size(), id);
    return text;
  }

 private:
  ApiHooks hooks() {
    return {none_, none_, [] {}, [] { return 0.0; }, [] { return std::uint64_t{0}; }, [](const std::string&) {}};
  }
  const fs::path folder_ = input_folder().path() / "service";
  BlobStore blobs_{folder_ / "blobs"};
  JobStore jobs_{folder_ / "jobs.sqlite", {.all = 10, .of_one_owner = 8}};
  Catalogue none_{"", blobs_, [](const std::string&) {}};
  Api api_{{}, jobs_, blobs_, {}, hooks()};
  std::string upload_, done_, waiting_;
};

Bench& bench() {
  static std::unique_ptr<Bench> now;
  static int requests = 0;
  if (requests++ % kRequestsEach == 0) {
    now.reset();
    now = std::make_unique<Bench>();
  }
  return *now;
}

void read_query(const std::string& text, std::map<std::string, std::string>& query) {
  std::istringstream stream(text);
  for (std::string pair; std::getline(stream, pair, '&');) {
    const std::size_t equals = std::min(pair.find('='), pair.size());
    query[pair.substr(0, equals)] = pair.substr(std::min(equals + 1, pair.size()));
  }
}

struct Written {
  HttpRequest request;
  std::string body;
};

Written read_request(std::string_view input) {
  Written written;
  const std::size_t blank = input.find("\n\n");
  std::istringstream lines(std::string(input.substr(0, blank)));
  if (blank != std::string_view::npos) written.body = input.substr(blank + 2);
  std::string line;
  std::getline(lines, line);
  const std::size_t space = std::min(line.find(' '), line.size());
  written.request.method = line.substr(0, space);
  const std::string address = bench().with_ids(line.substr(std::min(space + 1, line.size())));
  const std::size_t mark = std::min(address.find('?'), address.size());
  written.request.path = address.substr(0, mark);
  read_query(address.substr(std::min(mark + 1, address.size())), written.request.query);
  while (std::getline(lines, line)) {
    const std::size_t colon = line.find(": ");
    if (colon != std::string::npos) written.request.headers[line.substr(0, colon)] = line.substr(colon + 2);
  }
  return written;
}

void check_body(const HttpResponse& response) {
  if (const auto* text = std::get_if<std::string>(&response.body)) {
    if (response.status >= 400) require(!json::parse(*text, nullptr, false).is_discarded(), "a problem is JSON");
  } else if (const auto* file = std::get_if<FileBody>(&response.body)) {
    const auto size = fs::file_size(file->file);
    require(file->begin <= size && file->bytes <= size - file->begin, "a range lies in its file");
  } else {
    const auto& stream = std::get<std::shared_ptr<TextStream>>(response.body);
    for (int i = 0; i < 3 && stream->next(); ++i) (void)stream->heartbeat();
  }
}

void check_response(const HttpResponse& response) {
  require(response.status < 500 || response.status == 503 || response.status == 507, "no failure of the server's own");
  for (const auto& [name, value] : response.headers)
    require(value.find_first_of("\r\n") == std::string::npos && value.find('\0') == std::string::npos, "no header ends early");
  check_body(response);
}

HttpResponse answer(Written& written) {
  Api& api = bench().api();
  try {
    const std::unique_ptr<BodySink> body = api.begin(written.request);
    const std::size_t half = written.body.size() / 2;
    body->write(std::string_view(written.body).substr(0, half));
    body->write(std::string_view(written.body).substr(half));
    return api.answer(written.request, *body);
  } catch (const Failure& failure) {
    return problem_response(failure);
  }
}

void ask_for_tokens(const HttpRequest& request) {
  static const Tokens tokens(
      input_folder().write("tokens", "anna 2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b # secret\n"));
  const auto owner = tokens.owner_of(request.header("authorization"));
  if (owner) require(request.header("authorization").ends_with("secret"), "who is let in has a token");
}

}  // namespace
}  // namespace standin::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace standin::fuzz;
  auto written = read_request(view_of(data, size));
  ask_for_tokens(written.request);
  check_response(answer(written));
  return 0;
}
