#include "render/base/fingerprint.h"

#include <openssl/evp.h>

#include "render/base/error.h"

namespace standin {
namespace {

struct FreeContext {
  void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
};

void require(int succeeded) {
  if (succeeded != 1) throw Failure(ErrorWord::kInternal, "SHA-256 is not available");
}

}  // namespace

struct Fingerprinter::State {
  std::unique_ptr<EVP_MD_CTX, FreeContext> context{EVP_MD_CTX_new()};
};

std::string Fingerprint::hex() const {
  std::string text;
  for (const std::uint8_t byte : bytes)
    for (const int nibble : {byte >> 4, byte & 15}) text += "0123456789abcdef"[nibble];
  return text;
}

Fingerprinter::Fingerprinter() : state_(std::make_unique<State>()) {
  require(EVP_DigestInit_ex(state_->context.get(), EVP_sha256(), nullptr));
}

Fingerprinter::~Fingerprinter() = default;
Fingerprinter::Fingerprinter(Fingerprinter&&) noexcept = default;

Fingerprinter::Fingerprinter(const Fingerprinter& other) : state_(std::make_unique<State>()) {
  require(EVP_MD_CTX_copy_ex(state_->context.get(), other.state_->context.get()));
}

Fingerprinter& Fingerprinter::add_bytes(const void* data, std::size_t size) {
  if (size > 0) require(EVP_DigestUpdate(state_->context.get(), data, size));
  return *this;
}

Fingerprint Fingerprinter::fingerprint() const {
  const Fingerprinter copy(*this);
  Fingerprint result;
  unsigned int length = 0;
  require(EVP_DigestFinal_ex(copy.state_->context.get(), result.bytes.data(), &length));
  return result;
}

Fingerprint fingerprint_of(std::string_view bytes) {
  Fingerprint result;
  unsigned int length = 0;
  require(EVP_Digest(bytes.data(), bytes.size(), result.bytes.data(), &length, EVP_sha256(), nullptr));
  return result;
}

}  // namespace standin
