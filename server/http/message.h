// An HTTP request and its answer, as the routes see them: no socket, no library.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "render/base/error.h"

namespace standin {

struct HttpRequest {
  std::string method;
  std::string path;
  std::map<std::string, std::string> query;
  std::map<std::string, std::string> headers;  // names in lower case
  std::string owner;                           // whom the token belongs to

  /// Empty where there is none.
  [[nodiscard]] std::string header(const std::string& lower_case_name) const {
    const auto found = headers.find(lower_case_name);
    return found == headers.end() ? "" : found->second;
  }
};

/// Where a body goes while it comes in.
class BodySink {
 public:
  virtual ~BodySink() = default;
  /// Throws Failure: the rest is not looked at.
  virtual void write(std::string_view piece) = 0;
};

/// A body of bounded size, in memory.
class TextBody : public BodySink {
 public:
  explicit TextBody(std::size_t most_bytes) : most_bytes_(most_bytes) {}
  void write(std::string_view piece) override;
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::size_t most_bytes_;
  std::string text_;
};

/// Part of a file.
struct FileBody {
  std::filesystem::path file;
  std::uint64_t begin = 0;
  std::uint64_t bytes = 0;
};

/// Text that comes as it is made (server-sent events).
class TextStream {
 public:
  virtual ~TextStream() = default;
  /// Next text, or "" where there is none yet; nothing at the end.
  virtual std::optional<std::string> next() = 0;
  /// Of whose changes it tells.
  [[nodiscard]] virtual const std::string& subject() const = 0;
  /// What is sent when nothing has been for a while.
  [[nodiscard]] virtual std::string heartbeat() const = 0;
};

struct HttpResponse {
  int status = 200;
  std::vector<std::pair<std::string, std::string>> headers;
  std::variant<std::string, FileBody, std::shared_ptr<TextStream>> body;
};

[[nodiscard]] HttpResponse json_response(int status, const nlohmann::json& object);

/// One part of a body that is not as it should be.
struct FieldProblem {
  std::string pointer;  // RFC 6901, into the body
  std::string detail;
};

/// A body that names each field that is wrong.
class InvalidBody : public Failure {
 public:
  explicit InvalidBody(std::vector<FieldProblem> problems);
  [[nodiscard]] const std::vector<FieldProblem>& problems() const { return problems_; }

 private:
  std::vector<FieldProblem> problems_;
};

/// One whose answer is to carry a header of its own: Allow, Content-Range.
class FailureWithHeader : public Failure {
 public:
  FailureWithHeader(ErrorWord word, const std::string& sentence, std::string name, std::string value)
      : Failure(word, sentence), name_(std::move(name)), value_(std::move(value)) {}
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& value() const { return value_; }

 private:
  std::string name_;
  std::string value_;
};

/// RFC 9457 problem document of a word of the error table.
[[nodiscard]] nlohmann::json problem_of(ErrorWord word, const std::string& detail);
[[nodiscard]] HttpResponse problem_response(const Failure& failure);

/// The whole file, the range that was asked for, or 304: by `Range`, `If-Range` and `If-None-Match`. `sha256` is its ETag. Throws
/// Failure(kRangeUnsatisfiable).
[[nodiscard]] HttpResponse file_response(const HttpRequest& request, const std::filesystem::path& file, std::uint64_t bytes,
                                         const std::string& sha256, const std::string& type);

}  // namespace standin
