#include "render/base/sha256.h"

#include <openssl/evp.h>

#include <array>

#include "render/base/error.h"

namespace standin {

std::string sha256_hex(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr) != 1)
    throw Failure(ErrorWord::kInternal, "SHA-256 is not available");
  std::string hex;
  for (unsigned int i = 0; i < length; ++i)
    for (const int nibble : {digest[i] >> 4, digest[i] & 15}) hex += "0123456789abcdef"[nibble];
  return hex;
}

}  // namespace standin
