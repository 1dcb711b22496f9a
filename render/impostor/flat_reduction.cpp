#include "render/impostor/flat_reduction.h"

#include <algorithm>

namespace standin {

LatticeNormal lattice_normal(const LatticeVertex& a, const LatticeVertex& b, const LatticeVertex& c) {
  const std::int64_t ux = b.x - a.x, uy = b.y - a.y, uz = b.depth - a.depth;
  const std::int64_t vx = c.x - a.x, vy = c.y - a.y, vz = c.depth - a.depth;
  return {uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx};
}

namespace {

/// Same direction: planes of the initial mesh are axis-aligned, so one component is enough to compare.
bool same_direction(const LatticeNormal& a, const LatticeNormal& b) {
  const auto sign = [](std::int64_t v) { return (v > 0) - (v < 0); };
  return sign(a.x) == sign(b.x) && sign(a.y) == sign(b.y) && sign(a.z) == sign(b.z) && dot(b, b) != 0;
}

class FlatReduction {
 public:
  explicit FlatReduction(TriangleComplex& complex)
      : complex_(complex), due_(complex.vertex_count(), 1), rested_(complex.vertex_count(), 0) {
    for (std::uint32_t v = 0; v < complex.vertex_count(); ++v) slope_.push_back(on_slope(v) ? 1 : 0);
  }

  /// A vertex rests for a pass once a neighbour went, so that triangles grow evenly.
  void run() {
    for (std::uint32_t pass = 1; pass_through(pass); ++pass) {
    }
  }

 private:
  bool pass_through(std::uint32_t pass) {
    bool any = false;
    for (std::uint32_t v = 0; v < complex_.vertex_count(); ++v) {
      if (due_[v] == 0) continue;
      if (rested_[v] == pass) {
        any = true;
        continue;
      }
      due_[v] = 0;
      if (!remove(v)) continue;
      any = true;
      for (const auto& n : neighbours_) due_[n.vertex] = 1, rested_[n.vertex] = pass;
    }
    return any;
  }

  bool remove(std::uint32_t v) {
    complex_.triangles_of(v, star_);
    if (star_.empty()) return false;
    normals_.clear();
    for (const std::uint32_t t : star_) normals_.push_back(normal_of(complex_.corners(t)));
    complex_.neighbours_of(v, neighbours_);
    std::sort(neighbours_.begin(), neighbours_.end(), [&](const auto& a, const auto& b) {
      const std::int64_t la = complex_.length2(v, a.vertex), lb = complex_.length2(v, b.vertex);
      return la != lb ? la < lb : a.vertex < b.vertex;
    });
    for (const auto& n : neighbours_) {
      if ((slope_[v] != 0 && slope_[n.vertex] == 0) || !keeps_surface(v, n.vertex)) continue;
      complex_.neighbours_of(n.vertex, others_);
      if (!complex_.may_contract(neighbours_, others_, v, n.vertex)) continue;
      complex_.contract(v, n.vertex, star_);
      return true;
    }
    return false;
  }

  [[nodiscard]] LatticeNormal normal_of(const TriangleCorners& c) const {
    return lattice_normal(complex_.position(c[0]), complex_.position(c[1]), complex_.position(c[2]));
  }

  /// No triangle leaves its plane or turns over, and a border through v goes straight on.
  [[nodiscard]] bool keeps_surface(std::uint32_t v, std::uint32_t kept) const {
    for (std::size_t i = 0; i < star_.size(); ++i) {
      TriangleCorners corners = complex_.corners(star_[i]);
      if (corners[0] == kept || corners[1] == kept || corners[2] == kept) continue;
      std::replace(corners.begin(), corners.end(), v, kept);
      if (!same_direction(normals_[i], normal_of(corners))) return false;
    }
    return std::all_of(neighbours_.begin(), neighbours_.end(), [&](const auto& n) {
      return n.triangles == 2 || n.vertex == kept ||
             lattice_normal(complex_.position(v), complex_.position(kept), complex_.position(n.vertex)) == LatticeNormal{};
    });
  }

  /// Half way down a step of one layer. Where a wall goes on it is no slope.
  [[nodiscard]] bool on_slope(std::uint32_t v) {
    const LatticeVertex p = complex_.position(v);
    if (p.depth % 2 == 0) return false;
    complex_.neighbours_of(v, neighbours_);
    for (const auto& n : neighbours_) {
      const LatticeVertex q = complex_.position(n.vertex);
      if (q.x != p.x || q.y != p.y) continue;
      complex_.neighbours_of(n.vertex, others_);
      for (const auto& m : others_)
        if (complex_.position(m.vertex) == LatticeVertex{p.x, p.y, 2 * q.depth - p.depth}) return false;
    }
    return true;
  }

  TriangleComplex& complex_;
  std::vector<std::uint8_t> slope_;
  std::vector<std::uint8_t> due_;
  std::vector<std::uint32_t> rested_;  // the pass
  std::vector<std::uint32_t> star_;
  std::vector<LatticeNormal> normals_;  // of the star
  std::vector<TriangleComplex::Neighbour> neighbours_, others_;
};

}  // namespace

void reduce_flat_parts(TriangleComplex& complex) {
  FlatReduction(complex).run();
}

}  // namespace standin
