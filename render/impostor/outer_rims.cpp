#include "render/impostor/outer_rims.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "render/impostor/bit_image.h"

namespace standin {
namespace {

constexpr int kDiscTexels = 12;    // a disc of 2 pixels, seen from up to five times the distance, and the rim's own texel
constexpr int kWidestWindow = 32;  // beyond, a surface anywhere counts

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

  /// Anything in the window to the outer side along x, or along y: a little more than the half plane.
  [[nodiscard]] static bool in_window(const BitImage& surface, const Texel& rim, const Texel& outward, int window) {
    const auto along = [&](int from, int towards) {
      return towards > 0 ? std::pair{from + 1, from + window + 1} : std::pair{from - window, from};
    };
    const auto any = [&](std::pair<int, int> x, std::pair<int, int> y) {
      const auto inside = [](int at, std::uint32_t size) { return static_cast<std::uint32_t>(std::clamp(at, 0, static_cast<int>(size))); };
      return surface.any(inside(x.first, surface.width()), inside(y.first, surface.height()), inside(x.second, surface.width()),
                         inside(y.second, surface.height()));
    };
    const std::pair whole_x{rim.x - window, rim.x + window + 1}, whole_y{rim.y - window, rim.y + window + 1};
    return (outward.x != 0 && any(along(rim.x, outward.x), whole_y)) || (outward.y != 0 && any(whole_x, along(rim.y, outward.y)));
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
