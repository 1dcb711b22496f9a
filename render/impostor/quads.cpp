#include "render/impostor/quads.h"

#include <algorithm>
#include <optional>

namespace standin {
namespace {

/// Cells or texels [x0, x1) x [y0, y1).
struct Rect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  [[nodiscard]] int width() const { return x1 - x0; }
  [[nodiscard]] int height() const { return y1 - y0; }
  [[nodiscard]] std::int64_t area() const { return std::int64_t{width()} * height(); }
};

Rect enclosing(const Rect& a, const Rect& b) {
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

/// Filled cells of the coarse grid, with sums over rectangles from the cells as they were at the start of a box.
class CellGrid {
 public:
  CellGrid(const BitImage& opaque, std::uint32_t cell_texels)
      : columns_(static_cast<int>((opaque.width() + cell_texels - 1) / cell_texels)),
        rows_(static_cast<int>((opaque.height() + cell_texels - 1) / cell_texels)),
        filled_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0) {
    for (int y = 0; y < rows_; ++y)
      for (int x = 0; x < columns_; ++x) {
        const auto x0 = static_cast<std::uint32_t>(x) * cell_texels, y0 = static_cast<std::uint32_t>(y) * cell_texels;
        cell(x, y) = opaque.any(x0, y0, std::min(x0 + cell_texels, opaque.width()), std::min(y0 + cell_texels, opaque.height()));
      }
  }

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] bool filled(int x, int y) const { return filled_[index(x, y)] != 0; }
  [[nodiscard]] std::int64_t count(const Rect& rect) const {
    std::int64_t sum = 0;
    for (int y = rect.y0; y < rect.y1; ++y)
      for (int x = rect.x0; x < rect.x1; ++x) sum += filled_[index(x, y)];
    return sum;
  }
  void empty(const Rect& rect) {
    for (int y = rect.y0; y < rect.y1; ++y)
      for (int x = rect.x0; x < rect.x1; ++x) cell(x, y) = 0;
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
  }
  std::uint8_t& cell(int x, int y) { return filled_[index(x, y)]; }

  int columns_;
  int rows_;
  std::vector<std::uint8_t> filled_;
};

/// The box after its best step, with its new number of filled cells; nullopt where no neighbouring cell is filled or the box is too large.
struct Growth {
  Rect box;
  std::int64_t filled = 0;
};

std::optional<Growth> best_growth(const CellGrid& grid, const Growth& current, int max_cells) {
  std::optional<Growth> best;
  double best_ratio = 0.0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      Rect box = current.box;
      if (dx < 0) --box.x0;
      if (dx > 0) ++box.x1;
      if (dy < 0) --box.y0;
      if (dy > 0) ++box.y1;
      const bool inside = box.x0 >= 0 && box.y0 >= 0 && box.x1 <= grid.columns() && box.y1 <= grid.rows();
      if ((dx == 0 && dy == 0) || !inside || std::max(box.width(), box.height()) > max_cells) continue;
      std::int64_t gained = 0;
      if (dx != 0) gained += grid.count({dx < 0 ? box.x0 : box.x1 - 1, box.y0, dx < 0 ? box.x0 + 1 : box.x1, box.y1});
      if (dy != 0) gained += grid.count({current.box.x0, dy < 0 ? box.y0 : box.y1 - 1, current.box.x1, dy < 0 ? box.y0 + 1 : box.y1});
      const double ratio = static_cast<double>(gained) / static_cast<double>(box.area() - current.box.area());
      if (ratio > best_ratio) {
        best_ratio = ratio;
        best = {box, current.filled + gained};
      }
    }
  return best;
}

Rect grow(const CellGrid& grid, int x, int y, double fill_ratio, int max_cells) {
  Growth box{{x, y, x + 1, y + 1}, 1};
  while (const auto grown = best_growth(grid, box, max_cells)) {
    if (static_cast<double>(grown->filled) < fill_ratio * static_cast<double>(grown->box.area())) break;
    box = *grown;
  }
  return box.box;
}

/// The tight bounds of the opaque texels within `box`; empty where there are none.
Rect tight_bounds(const BitImage& opaque, const Rect& box) {
  Rect tight{box.x1, box.y1, box.x0, box.y0};
  for (int y = box.y0; y < box.y1; ++y)
    for (int x = box.x0; x < box.x1; ++x)
      if (opaque.test(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y))) tight = enclosing(tight, {x, y, x + 1, y + 1});
  return tight.x0 < tight.x1 ? tight : Rect{};
}

bool above(const Rect& a, const Rect& b) {
  return a.y0 != b.y0 ? a.y0 < b.y0 : a.x0 < b.x0;
}

/// Joins boxes whose common block with gutters holds no more texels than theirs. Such boxes are at most two gutters apart.
void join_boxes(std::vector<Rect>& boxes, const BoxGrowing& settings) {
  const int gutter = static_cast<int>(settings.gutter), max_side = static_cast<int>(settings.max_side);
  const auto cost = [&](const Rect& r) { return Rect{r.x0 - gutter, r.y0 - gutter, r.x1 + gutter, r.y1 + gutter}.area(); };
  bool joined = true;
  while (joined) {
    joined = false;
    std::sort(boxes.begin(), boxes.end(), above);
    for (std::size_t i = 0; i < boxes.size(); ++i)
      for (std::size_t j = i + 1; j < boxes.size() && boxes[j].y0 <= boxes[i].y1 + 2 * gutter; ++j) {
        const Rect both = enclosing(boxes[i], boxes[j]);
        if (std::max(both.width(), both.height()) > max_side || cost(both) > cost(boxes[i]) + cost(boxes[j])) continue;
        boxes[i] = both;
        boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(j--));
        joined = true;
      }
  }
}

}  // namespace

std::vector<Quad> grow_quads(const BitImage& opaque, std::uint32_t layer, const BoxGrowing& settings) {
  const int cell = static_cast<int>(std::min(settings.grid_texels, settings.max_side));
  const int max_cells = std::max(1, static_cast<int>(settings.max_side) / cell);
  CellGrid grid(opaque, static_cast<std::uint32_t>(cell));
  const int width = static_cast<int>(opaque.width()), height = static_cast<int>(opaque.height());
  std::vector<Rect> boxes;
  for (int y = 0; y < grid.rows(); ++y)
    for (int x = 0; x < grid.columns(); ++x) {
      if (!grid.filled(x, y)) continue;
      const Rect cells = grow(grid, x, y, settings.fill_ratio, max_cells);
      grid.empty(cells);
      boxes.push_back(
          tight_bounds(opaque, {cells.x0 * cell, cells.y0 * cell, std::min(cells.x1 * cell, width), std::min(cells.y1 * cell, height)}));
    }
  join_boxes(boxes, settings);

  BitImage left = opaque;
  std::vector<Quad> quads;
  for (const Rect& box : boxes) {
    const Rect tight = tight_bounds(left, box);
    if (tight.area() == 0) continue;
    const auto x0 = static_cast<std::uint32_t>(tight.x0), y0 = static_cast<std::uint32_t>(tight.y0);
    quads.push_back({layer, x0, y0, static_cast<std::uint32_t>(tight.width()), static_cast<std::uint32_t>(tight.height())});
    for (std::uint32_t y = y0; y < y0 + quads.back().height; ++y)
      for (std::uint32_t x = x0; x < x0 + quads.back().width; ++x) left.clear(x, y);
  }
  return quads;
}

}  // namespace standin
