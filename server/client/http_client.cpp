#include "server/client/http_client.h"

#include <curl/curl.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "render/base/error.h"
#include "render/base/staged_file.h"
#include "server/error_table.h"

namespace standin {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr long kConnect_s = 10;
constexpr long kSilent_s = 60;

struct Close {
  void operator()(CURL* handle) const { curl_easy_cleanup(handle); }
  void operator()(curl_slist* list) const { curl_slist_free_all(list); }
  void operator()(std::FILE* file) const { std::fclose(file); }
};

constexpr std::size_t kMostBytes = 64 << 20;  // of an answer that is kept in memory

size_t append(char* data, size_t, size_t size, void* text) {
  if (static_cast<std::string*>(text)->size() > kMostBytes) return 0;
  static_cast<std::string*>(text)->append(data, size);
  return size;
}

size_t keep_header(char* data, size_t, size_t size, void* headers) {
  const std::string line(data, size);
  const std::size_t colon = line.find(": ");
  if (colon != std::string::npos) {
    std::string name = line.substr(0, colon);
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
    (*static_cast<std::map<std::string, std::string>*>(headers))[name] = line.substr(colon + 2, line.find_last_not_of("\r\n") - colon - 1);
  }
  return size;
}

int stop_if_asked(void* budget, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return static_cast<const WorkBudget*>(budget)->stopped() ? 1 : 0;
}

// One request, under way.
class Transfer {
 public:
  Transfer(const std::string& server, const std::string& token, const std::string& path, const WorkBudget& budget)
      : handle_(curl_easy_init()), url_(server + path), budget_(budget) {
    set(CURLOPT_URL, url_.c_str());
    set(CURLOPT_PROTOCOLS_STR, "http,https");
    set(CURLOPT_CONNECTTIMEOUT, kConnect_s);
    set(CURLOPT_LOW_SPEED_LIMIT, 1L);
    set(CURLOPT_LOW_SPEED_TIME, kSilent_s);
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_HEADERFUNCTION, &keep_header);
    set(CURLOPT_HEADERDATA, &answer_.headers);
    set(CURLOPT_WRITEFUNCTION, &append);
    set(CURLOPT_WRITEDATA, &answer_.body);
    set(CURLOPT_NOPROGRESS, 0L);
    set(CURLOPT_XFERINFOFUNCTION, &stop_if_asked);
    set(CURLOPT_XFERINFODATA, &budget_);
    if (!token.empty()) header("Authorization", "Bearer " + token);
  }

  template <class Value>
  void set(CURLoption option, Value value) {
    curl_easy_setopt(handle_.get(), option, value);
  }
  void header(const std::string& name, const std::string& value) {
    headers_.reset(curl_slist_append(headers_.release(), (name + ": " + value).c_str()));
  }
  Answer run() {
    set(CURLOPT_HTTPHEADER, headers_.get());
    const CURLcode code = curl_easy_perform(handle_.get());
    budget_.check();
    if (code != CURLE_OK) throw Failure(ErrorWord::kServerUnreachable, url_ + ": " + curl_easy_strerror(code));
    curl_easy_getinfo(handle_.get(), CURLINFO_RESPONSE_CODE, &answer_.status);
    return std::move(answer_);
  }

 private:
  std::unique_ptr<CURL, Close> handle_;
  std::unique_ptr<curl_slist, Close> headers_;
  std::string url_;
  const WorkBudget& budget_;
  Answer answer_;
};

using File = std::unique_ptr<std::FILE, Close>;

}  // namespace

HttpClient::HttpClient(std::string server, std::string token) : server_(std::move(server)), token_(std::move(token)) {
  if (!server_.starts_with("http://") && !server_.starts_with("https://"))
    throw Failure(ErrorWord::kBadUsage, "--server " + server_ + ": http://HOST:PORT is expected");
  while (server_.ends_with('/')) server_.pop_back();
}

std::string HttpClient::escaped(const std::string& text) {
  const std::unique_ptr<char, void (*)(void*)> safe(curl_easy_escape(nullptr, text.c_str(), static_cast<int>(text.size())), &curl_free);
  return safe.get();
}

Answer HttpClient::get(const std::string& path, const WorkBudget& budget) const {
  return Transfer(server_, token_, path, budget).run();
}

Answer HttpClient::post_json(const std::string& path, const json& body, const std::map<std::string, std::string>& headers,
                             const WorkBudget& budget) const {
  const std::string text = body.dump();
  Transfer transfer(server_, token_, path, budget);
  transfer.header("Content-Type", "application/json");
  for (const auto& [name, value] : headers) transfer.header(name, value);
  transfer.set(CURLOPT_POST, 1L);
  transfer.set(CURLOPT_POSTFIELDS, text.c_str());
  transfer.set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(text.size()));
  return transfer.run();
}

Answer HttpClient::post_file(const std::string& path, const fs::path& file, const WorkBudget& budget) const {
  const File stream(std::fopen(file.c_str(), "rb"));
  if (!stream || !fs::is_regular_file(file)) throw Failure(ErrorWord::kFileMissing, file.string() + " cannot be read");
  Transfer transfer(server_, token_, path, budget);
  transfer.header("Content-Type", "application/octet-stream");
  transfer.set(CURLOPT_POST, 1L);
  transfer.set(CURLOPT_READDATA, stream.get());
  transfer.set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(fs::file_size(file)));
  return transfer.run();
}

Answer HttpClient::download(const std::string& path, const fs::path& file, const WorkBudget& budget) const {
  const fs::path staged = staged_path(file);
  Answer answer;
  {
    const File stream(std::fopen(staged.c_str(), "wb"));
    if (!stream) throw Failure(ErrorWord::kFileMissing, file.string() + " cannot be written");
    Transfer transfer(server_, token_, path, budget);
    transfer.set(CURLOPT_WRITEFUNCTION, static_cast<curl_write_callback>(nullptr));
    transfer.set(CURLOPT_WRITEDATA, stream.get());
    try {
      answer = transfer.run();
    } catch (...) {
      fs::remove(staged);
      throw;
    }
  }
  if (answer.status == 200) {
    fs::rename(staged, file);
  } else {
    answer.body = read_file(staged);
    fs::remove(staged);
  }
  return answer;
}

json body_or_failure(const Answer& answer) {
  json body = json::parse(answer.body, nullptr, false);
  if (answer.status < 400) return body;
  const bool is_problem = body.is_object() && body.contains("word") && body.contains("detail");
  if (!is_problem) throw Failure(ErrorWord::kServerUnreachable, "the server answered with HTTP status " + std::to_string(answer.status));
  throw Failure(word_named(body["word"].get<std::string>()), body["detail"].get<std::string>());
}

}  // namespace standin
