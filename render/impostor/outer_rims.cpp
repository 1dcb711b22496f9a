#include "render/impostor/outer_rims.h"

#include <algorithm>
#include <cstdlib>

#include "render/impostor/bit_image.h"

namespace standin {
namespace {

constexpr int kDiscTexels = 3;     // a disc of 2 pixels and the rim's own texel
constexpr int kWidestWindow = 16;  // beyond, a surface anywhere counts

struct Texel {
  int x = 0, y = 0;
};

class OuterRims {
 public:
  OuterRims(std::vector<LayerImage>& images, float shift_only) : images_(images), shift_only_(shift_only) {
    for (const LayerImage& image : images) {
      BitImage surface(image.width(), image.height());
      image.for_each_opaque([&](std::uint32_t x, std::uint32_t y) {
        if (image.get(x, y).order < shift_only_) surface.set(x, y);
      });
      surfaces_.push_back(std::move(surface));
    }
  }

  void remove() {
    for (std::size_t layer = 0; layer < images_.size(); ++layer) {
      std::vector<Texel> outer;
      images_[layer].for_each_opaque([&](std::uint32_t x, std::uint32_t y) {
        if (images_[layer].get(x, y).order < shift_only_) return;
        const Texel rim{static_cast<int>(x), static_cast<int>(y)};
        if (!anything_beyond(layer, rim, outward(layer, rim))) outer.push_back(rim);
      });
      for (const Texel& rim : outer) images_[layer].at(static_cast<std::uint32_t>(rim.x), static_cast<std::uint32_t>(rim.y)) = {};
    }
  }

 private:
  [[nodiscard]] bool holds(const BitImage& surface, int x, int y) const {
    return x >= 0 && y >= 0 && x < static_cast<int>(surface.width()) && y < static_cast<int>(surface.height()) &&
           surface.test(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
  }

  /// Away from the surface's texels around; none where they lie on all sides or farther off.
  [[nodiscard]] Texel outward(std::size_t layer, const Texel& rim) const {
    Texel sum;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (holds(surfaces_[layer], rim.x + dx, rim.y + dy)) sum = {sum.x - dx, sum.y - dy};
    return {std::clamp(sum.x, -1, 1), std::clamp(sum.y, -1, 1)};
  }

  [[nodiscard]] bool anything_beyond(std::size_t layer, const Texel& rim, const Texel& outward) const {
    if (outward.x == 0 && outward.y == 0) return true;
    for (std::size_t other = 0; other < surfaces_.size(); ++other) {
      if (images_[other].empty()) continue;
      const int window = kDiscTexels + std::abs(static_cast<int>(other) - static_cast<int>(layer));
      if (window > kWidestWindow || in_window(surfaces_[other], rim, outward, window)) return true;
    }
    return false;
  }

  [[nodiscard]] bool in_window(const BitImage& surface, const Texel& rim, const Texel& outward, int window) const {
    for (int dy = -window; dy <= window; ++dy)
      for (int dx = -window; dx <= window; ++dx)
        if (dx * outward.x + dy * outward.y > 0 && holds(surface, rim.x + dx, rim.y + dy)) return true;
    return false;
  }

  std::vector<LayerImage>& images_;
  float shift_only_;
  std::vector<BitImage> surfaces_;
};

}  // namespace

void remove_outer_rims(std::vector<LayerImage>& images, float shift_only) {
  OuterRims(images, shift_only).remove();
}

}  // namespace standin
