// What verification found, as metrics.json and verify.json carry it (units in the key names; what was not measured is null).
#pragma once

#include <nlohmann/json.hpp>

#include "server/verify/verify.h"

namespace standin {

/// "verify": counts, percentiles before and after, every frame, and the files of those that are pictured (by index into the frames).
[[nodiscard]] nlohmann::json verify_json(const VerifyResult& result);
/// "image": what the pictures and the rays said.
[[nodiscard]] nlohmann::json image_json(const VerifyResult& result);

}  // namespace standin
