#include "server/http/message.h"

#include <charconv>

#include "server/error_table.h"

namespace standin {
namespace {

using nlohmann::json;

// Half-open.
struct ByteRange {
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
};

std::optional<std::uint64_t> number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

// Of one range, "bytes=4-8", "bytes=4-" or "bytes=-4". Others are no ranges to us, and RFC 9110 (14.2) lets us send the whole.
std::optional<ByteRange> parse_range(std::string_view text, std::uint64_t bytes) {
  if (!text.starts_with("bytes=") || text.find(',') != std::string_view::npos) return std::nullopt;
  text.remove_prefix(6);
  const std::size_t dash = text.find('-');
  if (dash == std::string_view::npos) return std::nullopt;
  const auto first = number(text.substr(0, dash)), last = number(text.substr(dash + 1));
  if (dash == 0) return last ? std::optional(ByteRange{bytes - std::min(*last, bytes), bytes}) : std::nullopt;
  const bool open = dash + 1 == text.size();
  if (!first || (!open && (!last || *last < *first))) return std::nullopt;
  return ByteRange{*first, open ? bytes : std::min(bytes, *last >= bytes ? bytes : *last + 1)};
}

bool names(const std::string& list, const std::string& etag) {
  return list == "*" || list.find(etag) != std::string::npos;
}

const char* title_of(int status) {
  switch (status) {
    case 400:
      return "Bad Request";
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 409:
      return "Conflict";
    case 413:
      return "Content Too Large";
    case 415:
      return "Unsupported Media Type";
    case 416:
      return "Range Not Satisfiable";
    case 422:
      return "Unprocessable Content";
    case 429:
      return "Too Many Requests";
    case 499:
      return "Cancelled";
    case 502:
      return "Bad Gateway";
    case 503:
      return "Service Unavailable";
    case 504:
      return "Deadline Passed";
    case 507:
      return "Insufficient Storage";
    default:
      return "Internal Server Error";
  }
}

std::string sentence_of(const std::vector<FieldProblem>& problems) {
  std::string sentence;
  for (const auto& [pointer, detail] : problems) sentence += (sentence.empty() ? "" : "; ") + pointer + ": " + detail;
  return sentence;
}

}  // namespace

InvalidBody::InvalidBody(std::vector<FieldProblem> problems)
    : Failure(ErrorWord::kBadConfig, sentence_of(problems)), problems_(std::move(problems)) {}

void TextBody::write(std::string_view piece) {
  if (piece.size() > most_bytes_ - text_.size())
    throw Failure(ErrorWord::kTooLarge, "the body has more than " + std::to_string(most_bytes_) + " bytes");
  text_ += piece;
}

HttpResponse json_response(int status, const json& object) {
  return {status, {{"Content-Type", "application/json"}}, object.dump(-1, ' ', false, json::error_handler_t::replace)};
}

json problem_of(ErrorWord word, const std::string& detail) {
  const ErrorRow& row = error_row(word);
  return {{"type", "about:blank"}, {"title", title_of(row.http_status)}, {"status", row.http_status},
          {"word", row.name},      {"exit_code", row.exit_code},         {"detail", detail}};
}

HttpResponse problem_response(const Failure& failure) {
  json problem = problem_of(failure.word(), failure.what());
  if (const auto* invalid = dynamic_cast<const InvalidBody*>(&failure)) {
    problem["errors"] = json::array();
    for (const auto& [pointer, detail] : invalid->problems()) problem["errors"].push_back({{"pointer", pointer}, {"detail", detail}});
  }
  HttpResponse response = json_response(problem["status"], problem);
  response.headers = {{"Content-Type", "application/problem+json"}};
  if (failure.word() == ErrorWord::kQueueFull || failure.word() == ErrorWord::kBusy) response.headers.emplace_back("Retry-After", "30");
  if (failure.word() == ErrorWord::kUnauthorized) response.headers.emplace_back("WWW-Authenticate", "Bearer");
  if (const auto* more = dynamic_cast<const FailureWithHeader*>(&failure)) response.headers.emplace_back(more->name(), more->value());
  return response;
}

HttpResponse file_response(const HttpRequest& request, const std::filesystem::path& file, std::uint64_t bytes, const std::string& sha256,
                           const std::string& type) {
  const std::string etag = '"' + sha256 + '"';
  HttpResponse response{200,
                        {{"Content-Type", type},
                         {"ETag", etag},
                         {"Accept-Ranges", "bytes"},
                         {"Cache-Control", "private, no-cache"},
                         {"X-Content-Type-Options", "nosniff"}},
                        FileBody{file, 0, bytes}};
  if (const std::string known = request.header("if-none-match"); !known.empty() && names(known, etag)) {
    response.status = 304;
    response.body = std::string();
    return response;
  }
  const std::string condition = request.header("if-range");
  const auto range = condition.empty() || condition == etag ? parse_range(request.header("range"), bytes) : std::nullopt;
  if (!range) return response;
  if (range->begin >= range->end)
    throw FailureWithHeader(ErrorWord::kRangeUnsatisfiable, request.header("range") + " of " + std::to_string(bytes) + " bytes",
                            "Content-Range", "bytes */" + std::to_string(bytes));
  response.status = 206;
  response.body = FileBody{file, range->begin, range->end - range->begin};
  response.headers.emplace_back(
      "Content-Range", "bytes " + std::to_string(range->begin) + "-" + std::to_string(range->end - 1) + "/" + std::to_string(bytes));
  return response;
}

}  // namespace standin
