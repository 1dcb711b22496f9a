#include "render/impostor/depth_mesh_simplify.h"

#include <algorithm>
#include <queue>
#include <unordered_set>

#include "render/impostor/flat_reduction.h"
#include "render/impostor/voxel_cover.h"

namespace standin {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;
constexpr std::size_t kLargestNeedlessPart = 64;  // triangles

/// The voxels that polygons stand for, one mask a layer.
std::vector<BitImage> voxels_of(const DepthMesh& mesh, const VoxelLattice& lattice) {
  std::vector<BitImage> voxels(lattice.layers.size(), BitImage(lattice.width, lattice.height));
  for (const DepthPolygon& p : mesh.polygons)
    for (const std::int32_t y : {p.cell_y / 2, (p.cell_y + 1) / 2})
      for (const std::int32_t x : {p.cell_x / 2, (p.cell_x + 1) / 2})
        voxels[static_cast<std::size_t>(p.layer)].set(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
  return voxels;
}

/// Voxels by the triangle they belong to, as linked lists.
class VoxelOwners {
 public:
  explicit VoxelOwners(std::uint32_t triangles) : first_(triangles, kNone) {}

  void add(std::uint32_t triangle, const Voxel& voxel) {
    voxels_.push_back(voxel);
    next_.push_back(first_[triangle]);
    first_[triangle] = static_cast<std::uint32_t>(voxels_.size()) - 1;
  }
  void give(std::uint32_t id, std::uint32_t triangle) {
    next_[id] = first_[triangle];
    first_[triangle] = id;
  }
  /// Appends the ids of the triangle's voxels.
  void collect(std::uint32_t triangle, std::vector<std::uint32_t>& ids) const {
    for (std::uint32_t id = first_[triangle]; id != kNone; id = next_[id]) ids.push_back(id);
  }
  void clear(std::uint32_t triangle) { first_[triangle] = kNone; }
  [[nodiscard]] const Voxel& voxel(std::uint32_t id) const { return voxels_[id]; }

 private:
  std::vector<Voxel> voxels_;
  std::vector<std::uint32_t> next_;
  std::vector<std::uint32_t> first_;  // of a triangle
};

/// Edges to be tried, shortest first; each at most once in the queue, since its length never changes.
class EdgeQueue {
 public:
  struct Edge {
    std::int64_t length2 = 0;
    std::uint32_t a = 0, b = 0;  // a < b
    friend auto operator<=>(const Edge&, const Edge&) = default;
  };

  void push(std::int64_t length2, std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    if (waiting_.insert(key(a, b)).second) queue_.push({length2, a, b});
  }
  [[nodiscard]] bool empty() const { return queue_.empty(); }
  Edge pop() {
    const Edge edge = queue_.top();
    queue_.pop();
    waiting_.erase(key(edge.a, edge.b));
    return edge;
  }

 private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) { return std::uint64_t{a} << 32 | b; }
  std::priority_queue<Edge, std::vector<Edge>, std::greater<>> queue_;
  std::unordered_set<std::uint64_t> waiting_;
};

class Simplifier {
 public:
  Simplifier(const DepthMesh& mesh, const VoxelLattice& lattice, const LatticeDepths& depths, const SurfaceDepth& surface_depth,
             double enlargement)
      : complex_(mesh),
        cover_(lattice, depths, enlargement),
        exact_(lattice, depths, 1.0),
        depths_(depths),
        surface_depth_(surface_depth),
        owners_(2 * static_cast<std::uint32_t>(mesh.polygons.size())) {
    reduce_flat_parts(complex_);
    give_voxels(voxels_of(mesh, lattice));
  }

  void run(const WorkBudget& budget) {
    for (std::uint32_t v = 0; v < complex_.vertex_count(); ++v) push_edges(v);
    for (std::uint64_t step = 0; !queue_.empty(); ++step) {
      if (step % 1024 == 0) budget.check();
      const auto edge = queue_.pop();
      const bool keep_b = between_layers(edge.b) && !between_layers(edge.a);
      const std::uint32_t kept = keep_b ? edge.b : edge.a, other = keep_b ? edge.a : edge.b;
      if (!contract(other, kept)) (void)contract(kept, other);
    }
  }

  /// Small parts whose every voxel the rest of the mesh meets as well add nothing; the smallest go first.
  void drop_needless_parts() {
    std::vector<std::vector<std::uint32_t>> parts = parts_of_mesh();
    std::stable_sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    std::vector<CoverTriangle> triangles;
    std::vector<std::uint32_t> ids;
    for (const auto& part : parts)
      for (const std::uint32_t t : part) {
        triangles.push_back(cover_triangle(complex_.corners(t)));
        ids.push_back(t);
      }
    std::size_t first = 0;  // of the part at hand
    for (const auto& part : parts) {
      if (part.size() > kLargestNeedlessPart) break;
      const std::size_t end = first + part.size();
      if (covered_without(first, end, triangles, ids)) {
        for (std::size_t i = first; i < end; ++i) complex_.remove(ids[i]);
        for (std::size_t i = 0; i < voxels_.size(); ++i) owners_.give(voxels_[i], new_owners_[i]);
      }
      first = end;
    }
  }

  [[nodiscard]] SimplifiedDepthMesh result() {
    SimplifiedDepthMesh mesh;
    std::vector<std::uint32_t> id(complex_.vertex_count(), kNone);
    for (std::uint32_t t = 0; t < complex_.triangle_count(); ++t) {
      if (!complex_.alive(t)) continue;
      TriangleCorners corners = complex_.corners(t);
      for (std::uint32_t& corner : corners) {
        if (id[corner] == kNone) {
          id[corner] = static_cast<std::uint32_t>(mesh.vertices.size());
          mesh.vertices.push_back(complex_.position(corner));
        }
        corner = id[corner];
      }
      mesh.triangles.push_back(corners);
    }
    return mesh;
  }

 private:
  using Neighbour = TriangleComplex::Neighbour;

  [[nodiscard]] Vec3 place(std::uint32_t v) const {
    const LatticeVertex& p = complex_.position(v);
    return {texel_coordinates(p), depths_.at(p.depth)};
  }
  /// There a slope passes, while its steps' corners lie half a layer before and behind it.
  [[nodiscard]] bool between_layers(std::uint32_t v) const { return complex_.position(v).depth % 2 != 0; }
  [[nodiscard]] CoverTriangle cover_triangle(const TriangleCorners& c) const { return {place(c[0]), place(c[1]), place(c[2])}; }

  /// Each voxel to the first triangle that meets it.
  void give_voxels(std::vector<BitImage> voxels) {
    for (std::uint32_t t = 0; t < complex_.triangle_count(); ++t) {
      if (!complex_.alive(t)) continue;
      const CoverTriangle triangle = cover_triangle(complex_.corners(t));
      std::int32_t first = complex_.position(complex_.corners(t)[0]).depth, last = first;
      for (const std::uint32_t v : complex_.corners(t)) {
        first = std::min(first, complex_.position(v).depth);
        last = std::max(last, complex_.position(v).depth);
      }
      for (std::int32_t layer = first / 2; layer <= (last + 1) / 2; ++layer)
        give_voxels(t, triangle, static_cast<std::uint32_t>(layer), voxels);
    }
  }

  void give_voxels(std::uint32_t t, const CoverTriangle& triangle, std::uint32_t layer, std::vector<BitImage>& voxels) {
    BitImage& left = voxels[layer];
    for (auto y = static_cast<std::uint32_t>(triangle.low.y); y <= static_cast<std::uint32_t>(triangle.high.y); ++y)
      for (auto x = static_cast<std::uint32_t>(triangle.low.x); x <= static_cast<std::uint32_t>(triangle.high.x); ++x)
        if (left.test(x, y)) {
          const Voxel voxel{x, y, layer, surface_depth_(x, y, layer)};
          if (!exact_.meets(triangle, voxel)) continue;
          owners_.add(t, voxel);
          left.clear(x, y);
        }
  }

  void push_edges(std::uint32_t v) {
    complex_.neighbours_of(v, around_);
    for (const Neighbour& n : around_) queue_.push(complex_.length2(v, n.vertex), v, n.vertex);
  }

  /// The live triangles, by connected part.
  [[nodiscard]] std::vector<std::vector<std::uint32_t>> parts_of_mesh() {
    std::vector<std::vector<std::uint32_t>> parts;
    std::vector<std::uint8_t> seen(complex_.triangle_count(), 0);
    for (std::uint32_t t = 0; t < complex_.triangle_count(); ++t) {
      if (!complex_.alive(t) || seen[t] != 0) continue;
      seen[t] = 1;
      std::vector<std::uint32_t>& part = parts.emplace_back(1, t);
      for (std::size_t i = 0; i < part.size(); ++i)
        for (const std::uint32_t v : complex_.corners(part[i])) {
          complex_.triangles_of(v, star_);
          for (const std::uint32_t next : star_)
            if (seen[next] == 0) seen[next] = 1, part.push_back(next);
        }
    }
    return parts;
  }

  /// Whether live triangles beyond [first, end) meet all voxels of those within.
  [[nodiscard]] bool covered_without(std::size_t first, std::size_t end, const std::vector<CoverTriangle>& triangles,
                                     const std::vector<std::uint32_t>& ids) {
    voxels_.clear();
    new_owners_.clear();
    for (std::size_t i = first; i < end; ++i) owners_.collect(ids[i], voxels_);
    return std::all_of(voxels_.begin(), voxels_.end(), [&](std::uint32_t id) {
      for (std::size_t i = triangles.size(); i-- > 0;)
        if ((i < first || i >= end) && complex_.alive(ids[i]) && exact_.meets(triangles[i], owners_.voxel(id))) {
          new_owners_.push_back(ids[i]);
          return true;
        }
      return false;
    });
  }

  /// Takes `removed` into `kept` if all rules allow it.
  bool contract(std::uint32_t removed, std::uint32_t kept) {
    complex_.neighbours_of(removed, of_removed_);
    if (find_neighbour(of_removed_, kept) == nullptr) return false;
    complex_.neighbours_of(kept, of_kept_);
    complex_.triangles_of(removed, star_);
    if (!complex_.may_contract(of_removed_, of_kept_, removed, kept) || !prepare_triangles(removed, kept) || !new_edges_covered(kept) ||
        !find_new_owners())
      return false;
    complex_.contract(removed, kept, star_);
    for (const std::uint32_t t : star_) owners_.clear(t);
    for (std::size_t i = 0; i < voxels_.size(); ++i) owners_.give(voxels_[i], new_owners_[i]);
    const std::uint32_t twins = complex_.vertex_count();
    complex_.split_fans(kept);
    for (std::uint32_t v = twins; v < complex_.vertex_count(); ++v) push_edges(v);
    push_edges(kept);
    const std::vector<Neighbour> changed = of_removed_;
    for (const Neighbour& n : changed) push_edges(n.vertex);
    return true;
  }

  /// The surviving triangles as they would be; false where one would turn over or vanish.
  bool prepare_triangles(std::uint32_t removed, std::uint32_t kept) {
    new_ids_.clear();
    new_triangles_.clear();
    for (const std::uint32_t t : star_) {
      const TriangleCorners& old = complex_.corners(t);
      if (old[0] == kept || old[1] == kept || old[2] == kept) continue;
      TriangleCorners corners = old;
      std::replace(corners.begin(), corners.end(), removed, kept);
      const LatticeNormal before = normal_of(old), after = normal_of(corners);
      if (dot(before, after) <= 0 || (before.z < 0 ? after.z > 0 : before.z > 0 && after.z < 0)) return false;
      new_ids_.push_back(t);
      new_triangles_.push_back(cover_triangle(corners));
    }
    return true;
  }

  [[nodiscard]] LatticeNormal normal_of(const TriangleCorners& c) const {
    return lattice_normal(complex_.position(c[0]), complex_.position(c[1]), complex_.position(c[2]));
  }

  [[nodiscard]] bool new_edges_covered(std::uint32_t kept) const {
    return std::all_of(of_removed_.begin(), of_removed_.end(), [&](const Neighbour& n) {
      return n.vertex == kept || find_neighbour(of_kept_, n.vertex) != nullptr || cover_.covers(place(kept), place(n.vertex));
    });
  }

  /// Which new triangle meets each voxel of the old ones; false where none does.
  bool find_new_owners() {
    voxels_.clear();
    new_owners_.clear();
    for (const std::uint32_t t : star_) owners_.collect(t, voxels_);
    const bool at_border = std::any_of(of_removed_.begin(), of_removed_.end(), [](const Neighbour& n) { return n.triangles == 1; });
    const VoxelCover& cover = at_border ? exact_ : cover_;
    std::size_t last = 0;
    for (const std::uint32_t id : voxels_) {
      const Voxel& voxel = owners_.voxel(id);
      std::size_t tried = 0;
      while (tried < new_ids_.size() && !cover.meets(new_triangles_[(last + tried) % new_ids_.size()], voxel)) ++tried;
      if (tried == new_ids_.size()) return false;
      last = (last + tried) % new_ids_.size();
      new_owners_.push_back(new_ids_[last]);
    }
    return true;
  }

  TriangleComplex complex_;
  VoxelCover cover_;  // enlarged
  VoxelCover exact_;
  const LatticeDepths& depths_;
  const SurfaceDepth& surface_depth_;
  VoxelOwners owners_;
  EdgeQueue queue_;
  std::vector<Neighbour> of_removed_, of_kept_, around_;
  std::vector<std::uint32_t> star_;           // of the vertex to be removed
  std::vector<std::uint32_t> new_ids_;        // its surviving triangles
  std::vector<CoverTriangle> new_triangles_;  // as they would be
  std::vector<std::uint32_t> voxels_, new_owners_;
};

}  // namespace

SimplifiedDepthMesh simplify(const DepthMesh& mesh, const VoxelLattice& lattice, const LatticeDepths& depths,
                             const SurfaceDepth& surface_depth, double enlargement, const WorkBudget& budget) {
  Simplifier simplifier(mesh, lattice, depths, surface_depth, enlargement);
  simplifier.run(budget);
  simplifier.drop_needless_parts();
  return simplifier.result();
}

}  // namespace standin
