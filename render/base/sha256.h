// Fingerprints of files: scenes, targets and jobs are named by their SHA-256.
#pragma once

#include <string>
#include <string_view>

#include "render/base/fingerprint.h"

namespace standin {

/// Lower-case hex. Throws Failure(kInternal) where OpenSSL offers no SHA-256.
[[nodiscard]] inline std::string sha256_hex(std::string_view bytes) {
  return fingerprint_of(bytes).hex();
}

}  // namespace standin
