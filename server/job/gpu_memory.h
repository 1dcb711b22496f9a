// What the atlases take on a GPU, beside the objective's uncompressed bytes (metrics.json, memory.gpu_bytes and memory.gpu_compression).
//
// The thesis' memory is that of plain texels (3.7.2); engines keep textures in blocks of a fixed size, whose sum follows from the pages'
// sizes alone. Whether a format keeps the masks, and at what loss of colour, does not: BC1 and BC3 are compressed and decoded to see. BC7
// and ETC2 are sizes only.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "render/base/work.h"
#include "render/scene/scene.h"

namespace standin {

/// Bytes of all pages by format, without mip levels: nearest-texel sampling uses none. `rgba8` is page area, unused space included.
[[nodiscard]] nlohmann::json gpu_bytes_json(const std::vector<Texture>& pages);

/// For each format that we can compress: {alpha_exact, alpha_changed_texels, opaque_psnr_db (null: no colour differs), mean_error,
/// seconds}.
[[nodiscard]] nlohmann::json gpu_compression_json(const std::vector<Texture>& pages, int threads, const WorkBudget& budget);

}  // namespace standin
