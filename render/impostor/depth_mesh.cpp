#include "render/impostor/depth_mesh.h"

#include <algorithm>
#include <numeric>

namespace standin {
namespace {

struct Cell {
  std::int32_t x = 0;
  std::int32_t y = 0;
};

constexpr std::array<Cell, 4> kSides{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

Cell beside(const Cell& cell, const Cell& side) {
  return {cell.x + side.x, cell.y + side.y};
}

/// Which polygons there are, as pure questions about cells.
class Rules {
 public:
  Rules(const VoxelLattice& lattice, Sheets sheets)
      : lattice_(lattice),
        all_(sheets == Sheets::kAll),
        columns_(2 * static_cast<int>(lattice.width) - 1),
        rows_(2 * static_cast<int>(lattice.height) - 1) {}

  [[nodiscard]] bool opaque(const Cell& c, int layer) const { return has_layer(layer) && every_voxel(at(layer).opaque, c); }
  [[nodiscard]] bool in_both(const Cell& c, int layer) const { return opaque(c, layer) && opaque(c, layer - 1); }

  [[nodiscard]] bool front_flat(const Cell& c, int layer) const {
    return opaque(c, layer) && !opaque(c, layer - 1) && (all_ || any_voxel(at(layer).wanted, c));
  }

  /// From a cell of X to one outside, seen from that side.
  [[nodiscard]] bool wall(const Cell& c, const Cell& side, int layer) const {
    const Cell outside = beside(c, side);
    if (!in_both(c, layer) || in_both(outside, layer)) return false;
    if (all_) return true;
    if (!any_voxel(at(layer).joined, c) && !any_voxel(at(layer - 1).joined, c)) return false;
    if (solid(outside, layer) && solid(outside, layer - 1)) return false;
    return !under_a_sheet(c, outside, side, layer);
  }

  /// Where a surface recedes under itself: its steps' undersides, as far as a row or column of them joins loose edges at both ends.
  [[nodiscard]] bool back_flat(const Cell& c, int layer) const {
    if (!may_be_back_flat(c, layer)) return false;
    return (leads_to_loose_edge(c, kSides[0], layer) && leads_to_loose_edge(c, kSides[2], layer)) ||
           (leads_to_loose_edge(c, kSides[1], layer) && leads_to_loose_edge(c, kSides[3], layer));
  }

 private:
  [[nodiscard]] bool has_layer(int layer) const { return layer >= 0 && layer < static_cast<int>(lattice_.layers.size()); }
  [[nodiscard]] const VoxelLayer& at(int layer) const { return lattice_.layers[static_cast<std::size_t>(layer)]; }
  [[nodiscard]] bool inside(const Cell& c) const { return c.x >= 0 && c.y >= 0 && c.x < columns_ && c.y < rows_; }

  [[nodiscard]] bool every_voxel(const BitImage& image, const Cell& c) const {
    if (!inside(c)) return false;
    const auto x0 = static_cast<std::uint32_t>(c.x) / 2, x1 = (static_cast<std::uint32_t>(c.x) + 1) / 2;
    const auto y0 = static_cast<std::uint32_t>(c.y) / 2, y1 = (static_cast<std::uint32_t>(c.y) + 1) / 2;
    return image.test(x0, y0) && image.test(x1, y1) && image.test(x1, y0) && image.test(x0, y1);
  }
  [[nodiscard]] static bool any_voxel(const BitImage& image, const Cell& c) {
    const auto x0 = static_cast<std::uint32_t>(c.x) / 2, x1 = (static_cast<std::uint32_t>(c.x) + 1) / 2;
    const auto y0 = static_cast<std::uint32_t>(c.y) / 2, y1 = (static_cast<std::uint32_t>(c.y) + 1) / 2;
    return image.test(x0, y0) || image.test(x1, y1) || image.test(x1, y0) || image.test(x0, y1);
  }
  [[nodiscard]] bool solid(const Cell& c, int layer) const { return has_layer(layer) && every_voxel(at(layer).solid, c); }

  /// Whether whoever comes straight at the wall is stopped by the nearer layer, and the wall would be a third polygon at its upper edge:
  /// rays shift by one texel a layer at most, which is two cells.
  [[nodiscard]] bool under_a_sheet(const Cell& c, const Cell& outside, const Cell& side, int layer) const {
    return solid(outside, layer - 1) && solid(beside(outside, side), layer - 1) && every_voxel(at(layer - 1).wanted, c) &&
           front_flat(c, layer - 1) && front_flat(outside, layer - 1);
  }
  [[nodiscard]] bool wall_between(const Cell& c, const Cell& side, int layer) const {
    return has_layer(layer) && (wall(c, side, layer) || wall(beside(c, side), {-side.x, -side.y}, layer));
  }

  /// Without counting undersides.
  [[nodiscard]] int polygons_at(const Cell& c, const Cell& side, int layer) const {
    return front_flat(beside(c, side), layer) + wall_between(c, side, layer) + wall_between(c, side, layer + 1);
  }
  [[nodiscard]] bool may_be_back_flat(const Cell& c, int layer) const {
    if (all_ || !in_both(c, layer) || opaque(c, layer + 1) || !any_voxel(at(layer).joined, c)) return false;
    return std::all_of(kSides.begin(), kSides.end(), [&](const Cell& side) { return polygons_at(c, side, layer) <= 1; });
  }
  [[nodiscard]] bool leads_to_loose_edge(Cell c, const Cell& side, int layer) const {
    for (int steps = 0; steps < kLongestUnderside && may_be_back_flat(c, layer); ++steps, c = beside(c, side))
      if (polygons_at(c, side, layer) == 1) return true;
    return false;
  }

  static constexpr int kLongestUnderside = 8;  // cells; a surface recedes by a texel a layer, the rest is for touched texels

  const VoxelLattice& lattice_;
  bool all_;
  int columns_;
  int rows_;
};

/// Gives each lattice point one vertex. Only three depths are open at a time; a slot that points at a vertex of other coordinates is empty.
class VertexGrid {
 public:
  VertexGrid(const VoxelLattice& lattice, std::vector<LatticeVertex>& vertices)
      : columns_(2 * std::size_t{lattice.width}), vertices_(vertices) {
    for (auto& slots : slots_) slots.assign(columns_ * 2 * lattice.height, 0xFFFFFFFF);
  }

  std::uint32_t operator()(std::int32_t x, std::int32_t y, std::int32_t depth) {
    const LatticeVertex vertex{x, y, depth};
    std::uint32_t& slot = slots_[static_cast<std::size_t>(depth) % 4][static_cast<std::size_t>(y) * columns_ + static_cast<std::size_t>(x)];
    if (slot < vertices_.size() && vertices_[slot] == vertex) return slot;
    slot = static_cast<std::uint32_t>(vertices_.size());
    vertices_.push_back(vertex);
    return slot;
  }

 private:
  std::size_t columns_;
  std::vector<LatticeVertex>& vertices_;
  std::array<std::vector<std::uint32_t>, 4> slots_;
};

class Mesher {
 public:
  Mesher(const VoxelLattice& lattice, Sheets sheets) : lattice_(lattice), rules_(lattice, sheets), vertex_(lattice, mesh_.vertices) {}

  DepthMesh take() {
    for (int layer = 0; layer < static_cast<int>(lattice_.layers.size()); ++layer) add_layer(layer);
    return std::move(mesh_);
  }

 private:
  void add_layer(int layer) {
    const BitImage& opaque = lattice_.layers[static_cast<std::size_t>(layer)].opaque;
    for (std::uint32_t y = 0; y < lattice_.height; ++y)
      for (std::size_t word = 0; word < opaque.words_per_row(); ++word)
        for (std::uint64_t bits = opaque.row(y)[word]; bits != 0; bits &= bits - 1) {
          const auto x = 2 * static_cast<std::int32_t>(64 * word + static_cast<std::size_t>(__builtin_ctzll(bits)));
          for (std::int32_t dy = 0; dy < 2; ++dy)
            for (std::int32_t dx = 0; dx < 2; ++dx) add_cell({x + dx, 2 * static_cast<std::int32_t>(y) + dy}, layer);
        }
  }

  void add_cell(const Cell& c, int layer) {
    if (rules_.front_flat(c, layer) || rules_.back_flat(c, layer)) add_flat(c, layer);
    for (const Cell& side : kSides)
      if (rules_.wall(c, side, layer)) add_wall(c, side, layer);
  }

  void add_flat(const Cell& c, int layer) {
    const std::int32_t depth = 2 * layer;
    mesh_.polygons.push_back(
        {{vertex_(c.x, c.y, depth), vertex_(c.x, c.y + 1, depth), vertex_(c.x + 1, c.y + 1, depth), vertex_(c.x + 1, c.y, depth)},
         c.x,
         c.y,
         layer});
    ++mesh_.flats;
  }

  void add_wall(const Cell& c, const Cell& side, int layer) {
    const std::int32_t x0 = c.x + (side.x > 0 || side.y > 0), x1 = c.x + (side.x > 0 || side.y < 0);
    const std::int32_t y0 = c.y + (side.y > 0 || side.x < 0), y1 = c.y + (side.y > 0 || side.x > 0);
    for (const std::int32_t depth : {2 * layer - 2, 2 * layer - 1})
      mesh_.polygons.push_back({{vertex_(x0, y0, depth), vertex_(x1, y1, depth), vertex_(x1, y1, depth + 1), vertex_(x0, y0, depth + 1)},
                                c.x,
                                c.y,
                                (depth + 1) / 2});
    ++mesh_.walls;
  }

  const VoxelLattice& lattice_;
  Rules rules_;
  DepthMesh mesh_;
  VertexGrid vertex_;
};

std::uint32_t connected_parts(const DepthMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  auto parts = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const DepthPolygon& polygon : mesh.polygons)
    for (std::size_t i = 1; i < 4; ++i) {
      const std::uint32_t a = root(polygon.corners[0]), b = root(polygon.corners[i]);
      if (a == b) continue;
      parent[std::max(a, b)] = std::min(a, b);
      --parts;
    }
  return parts;
}

}  // namespace

DepthMesh initial_depth_mesh(const VoxelLattice& lattice, Sheets sheets) {
  DepthMesh mesh = Mesher(lattice, sheets).take();
  mesh.meshes = connected_parts(mesh);
  return mesh;
}

}  // namespace standin
