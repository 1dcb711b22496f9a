// Skyline packing, tallest blocks first: the thesis' rule (lowest place that fits), without its powers of two.
//
// The gutter repeats a block's border texels, alpha included: a sample that rounding pushes over the border still finds the block's edge,
// so quads that adjoin leave no pinhole between them.
#include "render/impostor/atlas.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "render/base/error.h"

namespace standin {
namespace {

constexpr int kDilationTexels = 4;
constexpr std::uint32_t kWholeBlocks = 4;  // texels a side: graphics interfaces refuse compressed textures of other sizes

struct Block {
  std::uint32_t impostor = 0;
  std::uint32_t chart = 0;
  std::uint32_t width = 0;  // with gutters
  std::uint32_t height = 0;
  std::size_t first_byte = 0;  // in Impostor::texels
};

/// The upper outline of what lies on a page, as steps from left to right.
class Skyline {
 public:
  Skyline(std::uint32_t width, std::uint32_t max_height)
      : width_(width), max_height_(max_height), steps_{{0, 0}}, refused_height_(width + 1, max_height + 1) {}

  /// Places a rectangle as low as possible, then as far left; false where it does not fit. The outline only rises: what was refused once
  /// stays refused, and so does all that is no smaller.
  bool place(std::uint32_t width, std::uint32_t height, std::uint32_t& x, std::uint32_t& y) {
    if (width > width_ || height >= refused_height_[width]) return false;
    std::size_t best = steps_.size();
    std::uint32_t best_y = max_height_ - height + 1;
    for (std::size_t i = 0; i < steps_.size() && steps_[i].x + width <= width_; ++i) {
      if (steps_[i].y >= best_y) continue;
      const std::uint32_t level = level_over(i, width);
      if (level < best_y) {
        best = i;
        best_y = level;
      }
    }
    if (best == steps_.size()) {
      for (std::uint32_t w = width; w <= width_; ++w) refused_height_[w] = std::min(refused_height_[w], height);
      return false;
    }
    x = steps_[best].x;
    y = best_y;
    raise(best, width, best_y + height);
    used_height_ = std::max(used_height_, best_y + height);
    return true;
  }
  [[nodiscard]] std::uint32_t used_height() const { return used_height_; }

 private:
  struct Step {
    std::uint32_t x = 0;
    std::uint32_t y = 0;
  };

  [[nodiscard]] std::uint32_t level_over(std::size_t first, std::uint32_t width) const {
    std::uint32_t level = 0;
    for (std::size_t i = first; i < steps_.size() && steps_[i].x < steps_[first].x + width; ++i) level = std::max(level, steps_[i].y);
    return level;
  }

  void raise(std::size_t first, std::uint32_t width, std::uint32_t level) {
    const std::uint32_t begin = steps_[first].x, end = begin + width;
    std::size_t last = first;
    std::uint32_t level_behind = 0;
    for (; last < steps_.size() && steps_[last].x < end; ++last) level_behind = steps_[last].y;
    const bool splits = end < width_ && (last == steps_.size() || steps_[last].x > end);
    const auto at = steps_.erase(steps_.begin() + static_cast<std::ptrdiff_t>(first), steps_.begin() + static_cast<std::ptrdiff_t>(last));
    const auto raised = steps_.insert(at, {begin, level});
    if (splits) steps_.insert(raised + 1, {end, level_behind});
  }

  std::uint32_t width_;
  std::uint32_t max_height_;
  std::uint32_t used_height_ = 0;
  std::vector<Step> steps_;                    // ascending x from 0; each reaches to the next one, the last to the page's border
  std::vector<std::uint32_t> refused_height_;  // by width: rectangles at least that high do not fit
};

struct Placed {
  std::size_t block = 0;
  std::uint32_t x = 0;
  std::uint32_t y = 0;
};

struct Page {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<Placed> placed;
};

std::vector<Block> blocks_by_height(const std::vector<Impostor>& impostors, const AtlasOptions& options) {
  std::vector<Block> blocks;
  for (std::uint32_t i = 0; i < impostors.size(); ++i) {
    std::size_t first_byte = 0;
    const std::vector<Chart> charts = textured_mesh(impostors[i]).charts;
    for (std::uint32_t c = 0; c < charts.size(); ++c) {
      blocks.push_back({i, c, charts[c].width + 2 * options.gutter, charts[c].height + 2 * options.gutter, first_byte});
      first_byte += 4 * std::size_t{charts[c].width} * charts[c].height;
    }
  }
  std::stable_sort(blocks.begin(), blocks.end(),
                   [](const Block& a, const Block& b) { return a.height != b.height ? a.height > b.height : a.width > b.width; });
  return blocks;
}

/// Packs what fits, in order; the page ends where its last block does, or up to three texels further.
Page pack_page(const std::vector<Block>& blocks, const std::vector<std::size_t>& waiting, std::uint32_t width, std::uint32_t max_height) {
  Page page;
  Skyline skyline(width, max_height);
  for (const std::size_t i : waiting) {
    Placed placed{i, 0, 0};
    if (!skyline.place(blocks[i].width, blocks[i].height, placed.x, placed.y)) continue;
    page.placed.push_back(placed);
    page.width = std::max(page.width, placed.x + blocks[i].width);
  }
  const auto whole_blocks = [&](std::uint32_t texels) {
    return std::min((texels + kWholeBlocks - 1) / kWholeBlocks * kWholeBlocks, max_height);
  };
  page.width = whole_blocks(page.width);
  page.height = whole_blocks(skyline.used_height());
  return page;
}

/// A full page where more blocks wait than it holds; else, of several widths about the square root of their area, the one that wastes
/// least.
Page best_page(const std::vector<Block>& blocks, const std::vector<std::size_t>& waiting, std::uint32_t max_side) {
  double area = 0.0;
  std::uint32_t widest = 0;
  for (const std::size_t i : waiting) {
    area += static_cast<double>(blocks[i].width) * blocks[i].height;
    widest = std::max(widest, blocks[i].width);
  }
  Page best = pack_page(blocks, waiting, max_side, max_side);
  if (best.placed.size() < waiting.size()) return best;
  for (int step = 0; step < 16; ++step) {
    const double wanted = std::sqrt(area) * (0.8 + 0.05 * step);
    const auto width = std::clamp(static_cast<std::uint32_t>(std::ceil(wanted)), widest, max_side);
    Page page = pack_page(blocks, waiting, width, max_side);
    const auto texels = [](const Page& p) { return std::uint64_t{p.width} * p.height; };
    if (page.placed.size() == waiting.size() && texels(page) < texels(best)) best = std::move(page);
  }
  return best;
}

std::vector<Page> pack_pages(const std::vector<Block>& blocks, std::uint32_t max_side) {
  std::vector<std::size_t> waiting(blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    waiting[i] = i;
    if (std::max(blocks[i].width, blocks[i].height) > max_side)
      throw Failure(ErrorWord::kInternal, "block of impostor " + std::to_string(blocks[i].impostor) + " needs " +
                                              std::to_string(blocks[i].width) + " x " + std::to_string(blocks[i].height) +
                                              " texels with gutters; a page has " + std::to_string(max_side) + " a side");
  }
  std::vector<Page> pages;
  while (!waiting.empty()) {
    pages.push_back(best_page(blocks, waiting, max_side));
    std::vector<bool> done(blocks.size(), false);
    for (const Placed& placed : pages.back().placed) done[placed.block] = true;
    std::erase_if(waiting, [&](std::size_t i) { return done[i]; });
  }
  return pages;
}

/// A window of RGBA8 texels within a page.
struct Window {
  std::uint8_t* first;
  std::size_t stride;  // bytes
  int width;
  int height;
  [[nodiscard]] std::uint8_t* at(int x, int y) const {
    return first + static_cast<std::size_t>(y) * stride + 4 * static_cast<std::size_t>(x);
  }
};

/// The block's texels, its border ones repeated into the gutter.
void copy_block(const std::uint8_t* texels, const Block& block, int gutter, const Window& window) {
  const int width = static_cast<int>(block.width) - 2 * gutter, height = static_cast<int>(block.height) - 2 * gutter;
  for (int y = 0; y < window.height; ++y)
    for (int x = 0; x < window.width; ++x) {
      const int from_x = std::clamp(x - gutter, 0, width - 1), from_y = std::clamp(y - gutter, 0, height - 1);
      std::copy_n(texels + 4 * (static_cast<std::size_t>(from_y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(from_x)), 4,
                  window.at(x, y));
    }
}

/// The mean colour of the known texels around (x, y); false where there are none.
bool mean_of_neighbours(const Window& window, const std::vector<std::uint8_t>& known, int x, int y, std::uint8_t* colour) {
  int sum[3] = {0, 0, 0}, count = 0;
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, window.height - 1); ++j)
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, window.width - 1); ++i) {
      if (known[static_cast<std::size_t>(j) * static_cast<std::size_t>(window.width) + static_cast<std::size_t>(i)] == 0) continue;
      for (int c = 0; c < 3; ++c) sum[c] += window.at(i, j)[c];
      ++count;
    }
  if (count == 0) return false;
  for (int c = 0; c < 3; ++c) colour[c] = static_cast<std::uint8_t>((sum[c] + count / 2) / count);
  return true;
}

/// Colour, not alpha, flows from opaque texels into the transparent ones around them, so that no filter ever mixes in black.
void dilate_colour(const Window& window) {
  std::vector<std::uint8_t> known(static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height));
  for (std::size_t i = 0; i < known.size(); ++i)
    known[i] = window.at(static_cast<int>(i) % window.width, static_cast<int>(i) / window.width)[3] != 0;
  for (int pass = 0; pass < kDilationTexels; ++pass) {
    std::vector<std::uint8_t> next = known;
    for (int y = 0; y < window.height; ++y)
      for (int x = 0; x < window.width; ++x) {
        const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(window.width) + static_cast<std::size_t>(x);
        if (known[i] == 0 && mean_of_neighbours(window, known, x, y, window.at(x, y))) next[i] = 1;
      }
    if (next == known) return;
    known = std::move(next);
  }
}

}  // namespace

ImpostorSet pack_atlas(std::vector<Impostor> impostors, const AtlasOptions& options) {
  ImpostorSet set;
  set.impostors = std::move(impostors);
  for (const Impostor& impostor : set.impostors) set.slots.emplace_back(textured_mesh(impostor).charts.size());
  const std::vector<Block> blocks = blocks_by_height(set.impostors, options);
  const int gutter = static_cast<int>(options.gutter);
  for (const Page& page : pack_pages(blocks, options.max_side)) {
    const auto number = static_cast<std::uint32_t>(set.pages.size());
    Texture texture{"atlas_" + std::to_string(number), static_cast<int>(page.width), static_cast<int>(page.height), {}};
    texture.rgba.resize(4 * std::size_t{page.width} * page.height);
    for (const Placed& placed : page.placed) {
      const Block& block = blocks[placed.block];
      const Window window{texture.rgba.data() + 4 * (std::size_t{placed.y} * page.width + placed.x), 4 * std::size_t{page.width},
                          static_cast<int>(block.width), static_cast<int>(block.height)};
      copy_block(set.impostors[block.impostor].texels.data() + block.first_byte, block, gutter, window);
      dilate_colour(window);
      set.slots[block.impostor][block.chart] = {number, placed.x + options.gutter, placed.y + options.gutter};
    }
    set.pages.push_back(std::move(texture));
  }
  return set;
}

std::uint64_t texture_bytes(const Impostor& impostor, const AtlasOptions& options) {
  std::uint64_t texels = 0;
  const auto add = [&](const auto& block) {
    texels += std::uint64_t{block.width + 2 * options.gutter} * (block.height + 2 * options.gutter);
  };
  std::for_each(impostor.quads.begin(), impostor.quads.end(), add);
  std::for_each(impostor.mesh.charts.begin(), impostor.mesh.charts.end(), add);
  return 4 * texels;
}

std::uint64_t padding_bytes(const ImpostorSet& set, const AtlasOptions& options) {
  std::uint64_t pages = 0, blocks = 0;
  for (const Texture& page : set.pages) pages += page.rgba.size();
  for (const Impostor& impostor : set.impostors) blocks += texture_bytes(impostor, options);
  return pages - blocks;
}

}  // namespace standin
