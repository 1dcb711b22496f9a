// An impostor as bytes: what a bake made, without the request that it was asked for with.
#pragma once

#include <optional>

#include "render/base/bytes.h"
#include "render/impostor/impostor.h"

namespace standin {

/// Nothing is bytes, too: that a bake is impossible.
[[nodiscard]] std::string bytes_of(const std::optional<Impostor>& impostor);
/// Its objects and view cell are empty. Throws Failure(kFileBroken).
[[nodiscard]] std::optional<Impostor> read_impostor(ByteReader& bytes);

}  // namespace standin
