#include "server/service/tokens.h"

#include <openssl/crypto.h>

#include <algorithm>
#include <sstream>

#include "render/base/error.h"
#include "render/base/sha256.h"
#include "render/base/staged_file.h"

namespace standin {
namespace {

constexpr std::size_t kHexDigits = 64;

bool is_sha256(const std::string& text) {
  return text.size() == kHexDigits && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace

Tokens::Tokens(const std::filesystem::path& file) : required_(true) {
  std::istringstream lines(read_file(file));
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::istringstream words(line.substr(0, line.find('#')));
    Entry entry;
    std::string rest;
    if (!(words >> entry.owner)) continue;
    if (!(words >> entry.sha256) || !is_sha256(entry.sha256) || words >> rest)
      throw Failure(ErrorWord::kBadConfig,
                    file.string() + ":" + std::to_string(number) + ": OWNER and the SHA-256 of a token are expected, in lower-case hex");
    entries_.push_back(entry);
  }
  if (entries_.empty()) throw Failure(ErrorWord::kBadConfig, file.string() + " names no token: nobody could use the service");
}

bool Tokens::of_several_owners() const {
  return std::ranges::any_of(entries_, [&](const Entry& entry) { return entry.owner != entries_.front().owner; });
}

std::optional<std::string> Tokens::owner_of(const std::string& authorization) const {
  if (!required_) return kLocalOwner;
  constexpr std::string_view kScheme = "Bearer ";
  const bool bearer =
      authorization.size() > kScheme.size() &&
      std::equal(kScheme.begin(), kScheme.end(), authorization.begin(), [](char a, char b) { return std::tolower(a) == std::tolower(b); });
  const std::string digest = sha256_hex(bearer ? authorization.substr(kScheme.size()) : "");
  const Entry* found = nullptr;
  for (const Entry& entry : entries_)
    if (CRYPTO_memcmp(entry.sha256.data(), digest.data(), kHexDigits) == 0) found = &entry;
  return bearer && found != nullptr ? std::optional(found->owner) : std::nullopt;
}

}  // namespace standin
