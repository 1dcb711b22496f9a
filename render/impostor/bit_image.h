// One bit per texel, 64 to a word: masks of whole layers that are combined and shifted at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace standin {

class BitImage {
 public:
  BitImage(std::uint32_t width, std::uint32_t height)
      : width_(width), height_(height), words_per_row_((width + 63) / 64), words_(words_per_row_ * height, 0) {}

  [[nodiscard]] std::uint32_t width() const { return width_; }
  [[nodiscard]] std::uint32_t height() const { return height_; }
  [[nodiscard]] std::size_t words_per_row() const { return words_per_row_; }
  [[nodiscard]] const std::uint64_t* row(std::uint32_t y) const { return words_.data() + words_per_row_ * y; }
  [[nodiscard]] std::uint64_t* row(std::uint32_t y) { return words_.data() + words_per_row_ * y; }

  [[nodiscard]] bool test(std::uint32_t x, std::uint32_t y) const { return (row(y)[x / 64] >> (x % 64) & 1) != 0; }
  void set(std::uint32_t x, std::uint32_t y) { row(y)[x / 64] |= std::uint64_t{1} << (x % 64); }
  void clear(std::uint32_t x, std::uint32_t y) { row(y)[x / 64] &= ~(std::uint64_t{1} << (x % 64)); }

  /// Whether any bit of [x0, x1) x [y0, y1) is set.
  [[nodiscard]] bool any(std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) const {
    for (std::uint32_t y = y0; y < y1; ++y)
      for (std::size_t word = x0 / 64; x0 < x1 && word <= (x1 - 1) / 64; ++word) {
        std::uint64_t bits = row(y)[word];
        if (word == x0 / 64) bits &= ~std::uint64_t{0} << (x0 % 64);
        if (word == (x1 - 1) / 64) bits &= ~std::uint64_t{0} >> (63 - (x1 - 1) % 64);
        if (bits != 0) return true;
      }
    return false;
  }

  BitImage& operator&=(const BitImage& other) {
    for (std::size_t i = 0; i < words_.size(); ++i) words_[i] &= other.words_[i];
    return *this;
  }
  BitImage& operator|=(const BitImage& other) {
    for (std::size_t i = 0; i < words_.size(); ++i) words_[i] |= other.words_[i];
    return *this;
  }
  /// Clears what is set in `other`.
  BitImage& operator-=(const BitImage& other) {
    for (std::size_t i = 0; i < words_.size(); ++i) words_[i] &= ~other.words_[i];
    return *this;
  }
  friend bool operator==(const BitImage& a, const BitImage& b) = default;

 private:
  std::uint32_t width_ = 0;
  std::uint32_t height_ = 0;
  std::size_t words_per_row_ = 0;
  std::vector<std::uint64_t> words_;  // bits beyond the width stay 0
};

}  // namespace standin
