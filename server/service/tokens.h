// Who may use the service: bearer tokens, of which only hashes are kept.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace standin {

/// Owner of all jobs where no tokens are configured.
inline constexpr const char* kLocalOwner = "local";

class Tokens {
 public:
  /// None: everybody is the local owner.
  Tokens() = default;
  /// A file of lines `OWNER SHA256`, in hex, of the token; `#` begins a comment. Throws Failure(kBadConfig) naming the line,
  /// Failure(kFileMissing).
  explicit Tokens(const std::filesystem::path& file);

  [[nodiscard]] bool required() const { return required_; }
  [[nodiscard]] bool of_several_owners() const;
  /// `authorization`: the header's value. Nothing where it holds no known token. Takes the same time whichever token matches, and how much
  /// of one.
  [[nodiscard]] std::optional<std::string> owner_of(const std::string& authorization) const;

 private:
  struct Entry {
    std::string owner;
    std::string sha256;
  };
  bool required_ = false;
  std::vector<Entry> entries_;
};

}  // namespace standin
