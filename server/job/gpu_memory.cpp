#include "server/job/gpu_memory.h"

#include <chrono>

#include "render/image/block_compression.h"

namespace standin {
namespace {

using nlohmann::json;

json compression_json(const std::vector<Texture>& pages, BlockFormat format, int threads, const WorkBudget& budget) {
  const auto start = std::chrono::steady_clock::now();
  CompressionLoss loss;
  for (const Texture& page : pages) loss.add(page, decompress(compress(page, format, threads, budget)));
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  const auto psnr_db = loss.psnr_db();
  return {{"alpha_exact", loss.alpha_exact()},
          {"alpha_changed_texels", loss.alpha_changes},
          {"opaque_psnr_db", psnr_db ? json(*psnr_db) : json()},
          {"mean_error", loss.mean_error()},
          {"seconds", elapsed.count()}};
}

}  // namespace

json gpu_bytes_json(const std::vector<Texture>& pages) {
  std::uint64_t blocks = 0, texels = 0;
  for (const Texture& page : pages) {
    blocks += block_count(page);
    texels += static_cast<std::uint64_t>(page.width) * static_cast<std::uint64_t>(page.height);
  }
  const std::uint64_t bc1 = bytes_per_block(BlockFormat::kBc1) * blocks, bc3 = bytes_per_block(BlockFormat::kBc3) * blocks;
  return {{"rgba8", 4 * texels},      {"bc1", bc1}, {"bc3", bc3}, {"bc7", 16 * blocks}, {"etc2_rgb8a1", 8 * blocks},
          {"etc2_rgba8", 16 * blocks}};
}

json gpu_compression_json(const std::vector<Texture>& pages, int threads, const WorkBudget& budget) {
  return {{"bc1", compression_json(pages, BlockFormat::kBc1, threads, budget)},
          {"bc3", compression_json(pages, BlockFormat::kBc3, threads, budget)}};
}

}  // namespace standin
