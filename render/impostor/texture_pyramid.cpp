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

int wrapped(int i, int size) {
  const int r = i % size;
  return r < 0 ? r + size : r;
}

}  // namespace

TexturePyramid::TexturePyramid(const Texture& texture, int least_alpha) : texture_(texture), least_alpha_(least_alpha) {
  for (int level = 0; width_of(level) > 1 || height_of(level) > 1; ++level) levels_.push_back(half(level));
}

TexturePyramid::Texel TexturePyramid::fetch(int level, int x, int y) const {
  const std::size_t index = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_of(level)) + static_cast<std::size_t>(x));
  const std::uint8_t* texel = (level == 0 ? texture_.rgba : levels_[static_cast<std::size_t>(level) - 1].rgbw).data() + index;
  const float weight = level == 0 ? (texel[3] >= least_alpha_ ? 255.0F : 0.0F) : static_cast<float>(texel[3]);
  return {{texel[0], texel[1], texel[2]}, weight};
}

TexturePyramid::Level TexturePyramid::half(int level) const {
  Level coarse{(width_of(level) + 1) / 2, (height_of(level) + 1) / 2, {}};
  coarse.rgbw.resize(4 * static_cast<std::size_t>(coarse.width) * static_cast<std::size_t>(coarse.height));
  std::uint8_t* out = coarse.rgbw.data();
  for (int y = 0; y < coarse.height; ++y)
    for (int x = 0; x < coarse.width; ++x, out += 4) {
      glm::vec3 sum{0.0F};
      float weight = 0.0F, count = 0.0F;
      for (int j = 2 * y; j < std::min(2 * y + 2, height_of(level)); ++j)
        for (int i = 2 * x; i < std::min(2 * x + 2, width_of(level)); ++i, count += 1.0F) {
          const Texel texel = fetch(level, i, j);
          sum += texel.weight * texel.colour;
          weight += texel.weight;
        }
      const glm::vec3 mean = weight > 0.0F ? sum / weight : glm::vec3(0.0F);
      for (int c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>(mean[c] + 0.5F);
      out[3] = static_cast<std::uint8_t>(std::ceil(weight / count));
    }
  return coarse;
}

TexturePyramid::Texel TexturePyramid::bilinear(int level, const Vec2& uv) const {
  const double scale = std::ldexp(1.0, -level);
  const double x = (uv.x - std::floor(uv.x)) * texture_.width * scale - 0.5, y = (uv.y - std::floor(uv.y)) * texture_.height * scale - 0.5;
  const double x_floor = std::floor(x), y_floor = std::floor(y);
  const auto fx = static_cast<float>(x - x_floor), fy = static_cast<float>(y - y_floor);
  const int w = width_of(level), h = height_of(level);
  const int x0 = wrapped(static_cast<int>(x_floor), w), y0 = wrapped(static_cast<int>(y_floor), h);
  const int x1 = x0 + 1 == w ? 0 : x0 + 1, y1 = y0 + 1 == h ? 0 : y0 + 1;
  Texel sum{glm::vec3(0.0F), 0.0F};  // of colours times weight
  const auto add = [&](int i, int j, float share) {
    const Texel texel = fetch(level, i, j);
    sum.colour += share * texel.weight * texel.colour;
    sum.weight += share * texel.weight;
  };
  add(x0, y0, (1.0F - fx) * (1.0F - fy));
  add(x1, y0, fx * (1.0F - fy));
  add(x0, y1, (1.0F - fx) * fy);
  add(x1, y1, fx * fy);
  return sum;
}

TexturePyramid::Sample TexturePyramid::sample(const Vec2& uv, double level) const {
  const double clamped = std::clamp(level, 0.0, static_cast<double>(coarsest_level()));
  for (int fine = static_cast<int>(clamped); fine <= coarsest_level(); ++fine) {
    const double fraction = std::max(0.0, clamped - fine);
    Texel sum = bilinear(fine, uv);
    if (fraction > 0.0) {
      const Texel coarse = bilinear(fine + 1, uv);
      const auto share = static_cast<float>(fraction);
      sum.colour += share * (coarse.colour - sum.colour);
      sum.weight += share * (coarse.weight - sum.weight);
    }
    if (sum.weight > 0.0F) return {sum.colour / (255.0F * sum.weight), sum.weight / 255.0F};
  }
  return {};
}

bool TexturePyramid::passes(const Vec2& uv) const {
  const Vec2 wrapped_uv = uv - glm::floor(uv);
  const int x = std::min(static_cast<int>(wrapped_uv.x * texture_.width), texture_.width - 1);
  const int y = std::min(static_cast<int>(wrapped_uv.y * texture_.height), texture_.height - 1);
  return fetch(0, x, y).weight > 0.0F;
}

bool TexturePyramid::any_in(int level, int x0, int x1, int y0, int y1) const {
  for (int y = y0 >> level; y <= y1 >> level; ++y)
    for (int x = x0 >> level; x <= x1 >> level; ++x)
      if (fetch(level, x, y).weight > 0.0F) return true;
  return false;
}

bool TexturePyramid::any_passes(const Vec2& uv_min, const Vec2& uv_max) const {
  constexpr int kMostTexels = 4;  // a side: coarser than this would reach too far beyond the box
  const Runs columns = wrapped_runs(uv_min.x, uv_max.x, texture_.width), rows = wrapped_runs(uv_min.y, uv_max.y, texture_.height);
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      const int x0 = columns.first[i], x1 = columns.last[i], y0 = rows.first[j], y1 = rows.last[j];
      if (x1 < x0 || y1 < y0) continue;
      int level = 0;
      while (level < coarsest_level() && std::max(x1 - x0, y1 - y0) >> level >= kMostTexels) ++level;
      if (any_in(level, x0, x1, y0, y1)) return true;
    }
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
