#include "render/impostor/culling.h"

namespace standin {
namespace {

/// Which neighbour a texel of the next layer is compared with, along one axis.
struct Offset {
  int x = 0;
  int y = 0;
};

/// Bit x of the result: bit x of the row and of its neighbour at x + direction; outside is 0.
void and_with_neighbour(std::uint64_t* row, std::size_t words, int direction) {
  if (direction > 0) {
    for (std::size_t i = 0; i < words; ++i) row[i] &= row[i] >> 1 | (i + 1 < words ? row[i + 1] << 63 : 0);
  } else {
    for (std::size_t i = words; i-- > 0;) row[i] &= row[i] << 1 | (i > 0 ? row[i - 1] >> 63 : 0);
  }
}

/// All of the texel, its neighbours along x and y, and the diagonal one.
void require_block(BitImage& image, Offset offset) {
  const std::size_t words = image.words_per_row();
  const std::uint32_t height = image.height();
  for (std::uint32_t y = 0; y < height; ++y) and_with_neighbour(image.row(y), words, offset.x);
  for (std::uint32_t k = 0; k < height; ++k) {
    const std::uint32_t y = offset.y > 0 ? k : height - 1 - k;  // towards the neighbour, which must not have been changed yet
    const bool border = offset.y > 0 ? y + 1 == height : y == 0;
    const std::uint64_t* neighbour = border ? nullptr : image.row(offset.y > 0 ? y + 1 : y - 1);
    for (std::size_t i = 0; i < words; ++i) image.row(y)[i] &= border ? 0 : neighbour[i];
  }
}

}  // namespace

OcclusionCulling::OcclusionCulling(std::uint32_t width, std::uint32_t height, CullRule rule)
    : rule_(rule), hidden_(rule == CullRule::kUmbra ? 1 : 4, BitImage(width, height)) {}

BitImage OcclusionCulling::hidden() const {
  BitImage result = hidden_.front();
  for (const BitImage& hidden : hidden_) result &= hidden;
  return result;
}

BitImage OcclusionCulling::hidden_in_next(const BitImage& opaque) {
  constexpr Offset kClasses[] = {{-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
  BitImage result = opaque;
  for (const BitImage& hidden : hidden_) result &= hidden;
  for (std::size_t i = 0; i < hidden_.size(); ++i) {
    hidden_[i] |= opaque;
    require_block(hidden_[i], kClasses[i]);
    if (rule_ == CullRule::kUmbra) require_block(hidden_[i], kClasses[3]);  // 2 x 2 both ways: 3 x 3
  }
  return result;
}

}  // namespace standin
