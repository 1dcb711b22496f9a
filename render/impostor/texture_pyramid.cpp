#include "render/impostor/texture_pyramid.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace standin {
namespace {

/// Texel indices [first, last] of one axis, wrapped into [0, size): one or two runs.
struct Runs {
  int first[2] = {0, 0};
  int last[2] = {-1, -1};
};

Runs wrapped_runs(double low, double high, int size) {
  constexpr double kSlack = 1e-6;  // of a texel, for rounding in the caller's interpolation
  const double first = std::floor(low * size - kSlack), last = std::floor(high * size + kSlack);
  Runs runs;
  if (!(last - first < size - 1)) {
    runs.last[0] = size - 1;
    return runs;
  }
  const int start = static_cast<int>(first - std::floor(first / size) * size);
  const int end = start + static_cast<int>(last - first);
  runs.first[0] = start;
  runs.last[0] = std::min(end, size - 1);
  runs.last[1] = end - size;
  return runs;
}

}  // namespace

TexturePyramid::TexturePyramid(const Texture& texture, int least_alpha) : texture_(texture), least_alpha_(least_alpha) {
  levels_.push_back({texture.width, texture.height, Vec2(texture.width, texture.height), texture.rgba.data()});
  while (levels_.back().width > 1 || levels_.back().height > 1) add_half_of(coarsest_level());
}

void TexturePyramid::add_half_of(int level) {
  const Level fine = levels_[static_cast<std::size_t>(level)];
  Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, 0.5 * fine.size_texels, nullptr};
  std::vector<std::uint8_t>& texels =
      storage_.emplace_back(4 * static_cast<std::size_t>(coarse.width) * static_cast<std::size_t>(coarse.height));
  coarse.rgbw = texels.data();
  std::uint8_t* out = texels.data();
  for (int y = 0; y < coarse.height; ++y)
    for (int x = 0; x < coarse.width; ++x, out += 4) {
      WeightedColour sum;
      float count = 0.0F;
      for (int j = 2 * y; j < std::min(2 * y + 2, fine.height); ++j)
        for (int i = 2 * x; i < std::min(2 * x + 2, fine.width); ++i, count += 1.0F) {
          const std::uint8_t* texel = texel_at(fine, i, j);
          const float weight = weight_of(level, texel);
          sum.colour += weight * glm::vec3(texel[0], texel[1], texel[2]);
          sum.weight += weight;
        }
      const glm::vec3 mean = sum.weight > 0.0F ? sum.colour / sum.weight : glm::vec3(0.0F);
      for (int c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>(std::lround(mean[c]));
      out[3] = static_cast<std::uint8_t>(std::ceil(sum.weight / count));
    }
  levels_.push_back(coarse);
}

TexturePyramid::WeightedColour TexturePyramid::bilinear(int level, const Vec2& wrapped_uv) const {
  const Level& texels = levels_[static_cast<std::size_t>(level)];
  const Vec2 position = wrapped_uv * texels.size_texels - 0.5;
  const Vec2 corner = glm::floor(position);
  const glm::vec2 share(position - corner);
  const auto wrapped = [](int i, int size) { return i < 0 ? i + size : (i >= size ? i - size : i); };
  const int x0 = wrapped(static_cast<int>(corner.x), texels.width), y0 = wrapped(static_cast<int>(corner.y), texels.height);
  const int x1 = wrapped(x0 + 1, texels.width), y1 = wrapped(y0 + 1, texels.height);
  WeightedColour sum;
  const auto add = [&](int x, int y, float area) {
    const std::uint8_t* texel = texel_at(texels, x, y);
    const float weight = area * weight_of(level, texel);
    sum.colour += weight * glm::vec3(texel[0], texel[1], texel[2]);
    sum.weight += weight;
  };
  add(x0, y0, (1.0F - share.x) * (1.0F - share.y));
  add(x1, y0, share.x * (1.0F - share.y));
  add(x0, y1, (1.0F - share.x) * share.y);
  add(x1, y1, share.x * share.y);
  return sum;
}

TexturePyramid::Sample TexturePyramid::sample(const Vec2& uv, double level) const {
  const Vec2 wrapped_uv = uv - glm::floor(uv);
  const double clamped = std::clamp(level, 0.0, static_cast<double>(coarsest_level()));
  for (int fine = static_cast<int>(clamped); fine <= coarsest_level(); ++fine) {
    WeightedColour sum = bilinear(fine, wrapped_uv);
    if (const double share = clamped - fine; share > 0.0) {
      const WeightedColour coarse = bilinear(fine + 1, wrapped_uv);
      sum.colour += static_cast<float>(share) * (coarse.colour - sum.colour);
      sum.weight += static_cast<float>(share) * (coarse.weight - sum.weight);
    }
    if (sum.weight > 0.0F) return {sum.colour / (255.0F * sum.weight), sum.weight / 255.0F};
  }
  return {};
}

bool TexturePyramid::passes(const Vec2& uv) const {
  const Vec2 wrapped_uv = uv - glm::floor(uv);
  const int x = std::min(static_cast<int>(wrapped_uv.x * texture_.width), texture_.width - 1);
  const int y = std::min(static_cast<int>(wrapped_uv.y * texture_.height), texture_.height - 1);
  return weight_of(0, texel_at(levels_[0], x, y)) > 0.0F;
}

/// Whether a texel within the range passes below texel (x, y) of a level, which meets the range.
bool TexturePyramid::any_below(int level, int x, int y, const Range& range) const {
  const Level& texels = levels_[static_cast<std::size_t>(level)];
  if (weight_of(level, texel_at(texels, x, y)) <= 0.0F) return false;
  const int x0 = x << level, y0 = y << level, x1 = x0 + (1 << level) - 1, y1 = y0 + (1 << level) - 1;
  if (range.x0 <= x0 && x1 <= range.x1 && range.y0 <= y0 && y1 <= range.y1) return true;
  const int finer = level - 1;  // level 0 ended above: its texels meet the range only as a whole
  for (int j = std::max(2 * y, range.y0 >> finer); j <= std::min(2 * y + 1, range.y1 >> finer); ++j)
    for (int i = std::max(2 * x, range.x0 >> finer); i <= std::min(2 * x + 1, range.x1 >> finer); ++i)
      if (any_below(finer, i, j, range)) return true;
  return false;
}

bool TexturePyramid::any_in(const Range& range) const {
  int level = 0;
  while (level < coarsest_level() && ((range.x1 - range.x0) >> level > 1 || (range.y1 - range.y0) >> level > 1)) ++level;
  for (int y = range.y0 >> level; y <= range.y1 >> level; ++y)
    for (int x = range.x0 >> level; x <= range.x1 >> level; ++x)
      if (any_below(level, x, y, range)) return true;
  return false;
}

bool TexturePyramid::any_passes(const Vec2& uv_min, const Vec2& uv_max) const {
  const Runs columns = wrapped_runs(uv_min.x, uv_max.x, texture_.width), rows = wrapped_runs(uv_min.y, uv_max.y, texture_.height);
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      if (columns.first[i] <= columns.last[i] && rows.first[j] <= rows.last[j] &&
          any_in({columns.first[i], columns.last[i], rows.first[j], rows.last[j]}))
        return true;
  return false;
}

int least_passing_alpha(const Material& material) {
  if (material.alpha_mode != AlphaMode::kMask) return 0;
  int alpha = 0;
  while (alpha < 256 && material.base_colour.a * (static_cast<float>(alpha) / 255.0F) < material.alpha_cutoff) ++alpha;
  return alpha;
}

TexturePyramids::TexturePyramids(const Scene& scene) : scene_(scene), slot_of_material_(scene.materials.size(), nullptr) {
  std::map<std::pair<int, int>, Slot*> known;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& material = scene.materials[i];
    if (material.texture < 0) continue;
    Slot*& slot = known[{material.texture, least_passing_alpha(material)}];
    if (slot == nullptr) {
      slots_.push_back(std::make_unique<Slot>());
      slot = slots_.back().get();
      slot->texture = material.texture;
      slot->least_alpha = least_passing_alpha(material);
    }
    slot_of_material_[i] = slot;
  }
}

const TexturePyramid* TexturePyramids::of_material(std::uint32_t material) const {
  Slot* slot = slot_of_material_.at(material);
  if (slot == nullptr) return nullptr;
  std::call_once(slot->built, [&] {
    slot->pyramid = std::make_unique<TexturePyramid>(scene_.textures.at(static_cast<std::size_t>(slot->texture)), slot->least_alpha);
  });
  return slot->pyramid.get();
}

}  // namespace standin
