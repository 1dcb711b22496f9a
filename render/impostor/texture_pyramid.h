// A texture filtered to every coarseness, for colours and for alpha masks.
//
// Each level holds the mean colour of the texels below that count (all of them for opaque materials, those that pass the mask for masked
// ones) and the share of them as weight, rounded up: a weight is zero only where no texel passes at all. So one pyramid gives trilinear
// colours that no cut-out background bleeds into, and a mask test over a whole footprint that misses nothing.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "render/scene/scene.h"

namespace standin {

class TexturePyramid {
 public:
  /// `texture` must outlive this. Texels of alpha below `least_alpha` (0..256) do not count; 0: all do.
  TexturePyramid(const Texture& texture, int least_alpha);

  struct Sample {
    glm::vec3 colour{0.0F};  // 0..1
    float weight = 0.0F;     // share of texels that pass the mask, 0: none
  };
  /// Trilinear, repeating. `level` 0 is the texture itself; where nothing passes at that level, the next coarser one that has something.
  [[nodiscard]] Sample sample(const Vec2& uv, double level) const;
  /// Whether the texel at `uv` passes the mask.
  [[nodiscard]] bool passes(const Vec2& uv) const;
  /// Whether any texel that meets the closed box passes the mask; a millionth of a texel beyond it counts too.
  [[nodiscard]] bool any_passes(const Vec2& uv_min, const Vec2& uv_max) const;

  [[nodiscard]] int width() const { return texture_.width; }
  [[nodiscard]] int height() const { return texture_.height; }
  [[nodiscard]] int coarsest_level() const { return static_cast<int>(levels_.size()) - 1; }

 private:
  struct Level {
    int width = 0;
    int height = 0;
    Vec2 size_texels{0.0};  // of the whole texture, in texels of this level (a fraction where a border texel is not full)
    const std::uint8_t* rgbw = nullptr;
  };
  struct WeightedColour {
    glm::vec3 colour{0.0F};  // times weight
    float weight = 0.0F;
  };
  [[nodiscard]] float weight_of(int level, const std::uint8_t* texel) const {
    return level > 0 ? texel[3] : (texel[3] >= least_alpha_ ? 255.0F : 0.0F);
  }
  [[nodiscard]] static const std::uint8_t* texel_at(const Level& level, int x, int y) {
    return level.rgbw + 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) + static_cast<std::size_t>(x));
  }
  [[nodiscard]] WeightedColour bilinear(int level, const Vec2& wrapped_uv) const;
  void add_half_of(int level);
  /// Texels [x0, x1] x [y0, y1] of the texture itself.
  struct Range {
    int x0 = 0, x1 = -1, y0 = 0, y1 = -1;
  };
  [[nodiscard]] bool any_in(const Range& range) const;
  [[nodiscard]] bool any_below(int level, int x, int y, const Range& range) const;

  const Texture& texture_;
  int least_alpha_ = 0;
  std::vector<Level> levels_;                       // 0 is the texture; texel x of level k covers texels [x 2^k, (x+1) 2^k) of it
  std::vector<std::vector<std::uint8_t>> storage_;  // of the levels from 1 on
};

/// The pyramids of a scene's materials, each built when first asked for. Safe to share between threads.
class TexturePyramids {
 public:
  explicit TexturePyramids(const Scene& scene);
  /// nullptr where the material has no texture.
  [[nodiscard]] const TexturePyramid* of_material(std::uint32_t material) const;

 private:
  struct Slot {
    int texture = -1;
    int least_alpha = 0;
    std::once_flag built;
    std::unique_ptr<TexturePyramid> pyramid;
  };
  const Scene& scene_;
  std::vector<std::unique_ptr<Slot>> slots_;
  std::vector<Slot*> slot_of_material_;
};

/// Least texture alpha (0..256) that passes the material's mask; 0 where the material has none.
[[nodiscard]] int least_passing_alpha(const Material& material);

}  // namespace standin
