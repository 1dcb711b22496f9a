// HTTP as a client needs it, through libcurl: small answers in memory, files straight from and to disk.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "render/base/work.h"

namespace standin {

struct Answer {
  long status = 0;
  std::map<std::string, std::string> headers;  // names in lower case
  std::string body;
};

class HttpClient {
 public:
  /// `server`: http://host:port; `token`: empty: none. Throws Failure(kBadUsage) where it is no such address.
  HttpClient(std::string server, std::string token);

  /// Any status is an answer. Throws Failure(kServerUnreachable) where none comes, Failure(kCancelled).
  Answer get(const std::string& path, const WorkBudget& budget) const;
  Answer post_json(const std::string& path, const nlohmann::json& body, const std::map<std::string, std::string>& headers,
                   const WorkBudget& budget) const;
  Answer post_file(const std::string& path, const std::filesystem::path& file, const WorkBudget& budget) const;
  /// The answer's body goes to the file, which appears whole or not at all; what is not 200 stays in the answer.
  Answer download(const std::string& path, const std::filesystem::path& file, const WorkBudget& budget) const;
  [[nodiscard]] static std::string escaped(const std::string& text);

 private:
  std::string server_;
  std::string token_;
};

/// Throws the Failure that a problem document describes; returns the body of any other answer as JSON.
nlohmann::json body_or_failure(const Answer& answer);

}  // namespace standin
