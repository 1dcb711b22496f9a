// Base64 (RFC 4648, with padding), for pictures in data URIs.
#pragma once

#include <string>
#include <string_view>

namespace standin {

[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace standin
