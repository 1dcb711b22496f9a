#include "render/scene/real_city_parts.h"

#include <algorithm>
#include <cmath>

#include "render/scene/mesh_builder.h"

namespace standin {
namespace {

constexpr double kTexture_m = 4.0;  // one repeat of a ground texture
constexpr double kParapet_m = 0.6;
constexpr double kRoofSlope = 0.55;        // rise over half the width
constexpr double kMostGabledFloors = 2.0;  // and
constexpr double kMostGabledWidth_m = 16.0;
constexpr double kLeastBalconyFloors = 3.0;  // and
constexpr double kLeastBalconyEdge_m = 9.0;
constexpr double kShortestEdge_m = 0.01;

Vec3 lifted(const Vec2& p, double height_m) {
  return {p.x, height_m, p.y};
}

// The ring with the polygon's inside on the left for somebody who walks along it on a map: what is right of each edge is outside.
Path with_inside_left(Path ring, bool is_hole) {
  if ((signed_area(ring) > 0.0) != is_hole) std::reverse(ring.begin(), ring.end());
  return ring;
}

template <typename Use>
void each_edge(const Path& ring, const Use& use) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2& a = ring[i];
    const Vec2& b = ring[(i + 1) % ring.size()];
    if (glm::distance(a, b) > kShortestEdge_m) use(a, b);
  }
}

void add_flat(MeshBuilder& builder, const std::vector<std::array<Vec2, 3>>& triangles, const Vec2& origin, double height_m) {
  for (const auto& corners : triangles) {
    std::array<Vec3, 3> p{};
    for (std::size_t c = 0; c < 3; ++c) p[c] = lifted(corners[c] - origin, height_m);
    const bool up = glm::cross(p[1] - p[0], p[2] - p[0]).y > 0.0;
    if (!up) std::swap(p[1], p[2]);
    builder.level_triangle(p[0], p[1], p[2], 1.0 / kTexture_m);
  }
}

class Extrusion {
 public:
  Extrusion(double floors, const Vec2& origin)
      : floors_(std::max(1.0, std::round(floors))), eaves_m_(floors_ * kFloorHeight_m), origin_(origin) {}

  void add(const Polygon& polygon) {
    add_ring(with_inside_left(polygon.shell, false));
    for (const Path& hole : polygon.holes) add_ring(with_inside_left(hole, true));
    gabled(polygon) ? add_gable(with_inside_left(polygon.shell, false)) : add_flat_roof(polygon);
  }

  [[nodiscard]] Model finish() {
    Model model;
    model.parts.push_back({walls_.finish("walls"), Surface::kFacade});
    if (tiles_.triangle_count() > 0) model.parts.push_back({tiles_.finish("roof"), Surface::kRoof});
    if (roof_.triangle_count() > 0) model.parts.push_back({roof_.finish("flat_roof"), Surface::kPaving});
    if (trim_.triangle_count() > 0) model.parts.push_back({trim_.finish("parapet"), Surface::kTrim});
    if (balconies_.triangle_count() > 0) model.parts.push_back({balconies_.finish("balconies"), Surface::kTrim});
    return model;
  }

 private:
  void add_ring(const Path& ring) {
    each_edge(ring, [&](const Vec2& a, const Vec2& b) {
      const double bays = std::max(1.0, std::round(glm::distance(a, b) / kBayWidth_m));
      const UvRect uv{{0.0, 0.0}, {bays / kFacadeBays, floors_ / kFacadeFloors}};
      add_wall(walls_, a, b, 0.0, eaves_m_, uv);
      if (floors_ >= kLeastBalconyFloors && glm::distance(a, b) >= kLeastBalconyEdge_m) add_balconies(a, b, static_cast<int>(bays));
    });
  }

  void add_wall(MeshBuilder& builder, const Vec2& a, const Vec2& b, double low, double high, const UvRect& uv = {}) const {
    builder.patch(lifted(a - origin_, low), lifted(b - origin_, low), lifted(b - origin_, high), lifted(a - origin_, high), 1, 1, uv);
  }

  // Closed balconies, as houses there have: on every second bay of each floor but the ground floor.
  void add_balconies(const Vec2& a, const Vec2& b, int bays) {
    constexpr double kHeight_m = 1.1;
    constexpr double kOut_m = 0.9;
    const Vec2 bay = (b - a) / static_cast<double>(bays);
    const Vec2 along = glm::normalize(b - a);
    const Vec2 outward(-along.y, along.x);
    for (int i = 1; i < bays; i += 2) {
      const Vec2 left = a + static_cast<double>(i) * bay + 0.2 * along;
      const Vec2 right = a + static_cast<double>(i + 1) * bay - 0.2 * along;
      const std::array<Vec2, 4> corners{left, left + kOut_m * outward, right + kOut_m * outward, right};
      for (int floor = 1; floor < floors_; ++floor) {
        const double foot_m = floor * kFloorHeight_m;
        for (std::size_t c = 0; c < 3; ++c) add_wall(balconies_, corners[c], corners[c + 1], foot_m, foot_m + kHeight_m);
        for (const double height_m : {foot_m, foot_m + kHeight_m}) add_slab(corners, height_m, height_m > foot_m);
      }
    }
  }

  void add_slab(const std::array<Vec2, 4>& corners, double height_m, bool faces_up) {
    std::array<Vec3, 4> p{};
    for (std::size_t c = 0; c < 4; ++c) p[c] = lifted(corners[faces_up ? c : 3 - c] - origin_, height_m);
    balconies_.patch(p[0], p[1], p[2], p[3]);
  }

  void add_flat_roof(const Polygon& polygon) {
    const Region region = Region::of(polygon);
    add_flat(roof_, region.triangles(), origin_, eaves_m_);
    const auto parapet = [&](const Path& ring) {
      each_edge(ring, [&](const Vec2& a, const Vec2& b) { add_wall(trim_, a, b, eaves_m_, eaves_m_ + kParapet_m); });
    };
    parapet(with_inside_left(polygon.shell, false));
    for (const Path& hole : polygon.holes) parapet(with_inside_left(hole, true));
  }

  [[nodiscard]] bool gabled(const Polygon& polygon) const {
    const Path& ring = polygon.shell;
    if (ring.size() != 4 || !polygon.holes.empty() || floors_ > kMostGabledFloors) return false;
    const auto side = [&](std::size_t i) { return glm::distance(ring[i], ring[(i + 1) % 4]); };
    if (std::min(side(0) + side(2), side(1) + side(3)) > 2.0 * kMostGabledWidth_m) return false;
    const double area = signed_area(ring);
    for (std::size_t i = 0; i < 4; ++i) {  // a corner that turns the other way: not convex
      if (signed_area({ring[i], ring[(i + 1) % 4], ring[(i + 2) % 4]}) * area <= 0.0) return false;
    }
    return true;
  }

  // The ridge joins the middles of the two shorter opposite sides.
  void add_gable(Path ring) {
    const auto side = [&](std::size_t i) { return glm::distance(ring[i], ring[(i + 1) % 4]); };
    if (side(0) + side(2) < side(1) + side(3)) std::rotate(ring.begin(), ring.begin() + 1, ring.end());
    const auto [a, b, c, d] = std::tuple(lifted(ring[0] - origin_, eaves_m_), lifted(ring[1] - origin_, eaves_m_),
                                         lifted(ring[2] - origin_, eaves_m_), lifted(ring[3] - origin_, eaves_m_));
    const double rise_m = kRoofSlope * 0.25 * (side(1) + side(3));
    const Vec3 p = 0.5 * (d + a) + Vec3(0.0, rise_m, 0.0);
    const Vec3 q = 0.5 * (b + c) + Vec3(0.0, rise_m, 0.0);
    const UvRect uv{{0.0, 0.0}, {side(0) / kTexture_m, 0.25 * (side(1) + side(3)) / kTexture_m}};
    tiles_.patch(a, b, q, p, 1, 1, uv);
    tiles_.patch(c, d, p, q, 1, 1, uv);
    trim_.triangle(b, c, q);
    trim_.triangle(d, a, p);
  }

  double floors_;
  double eaves_m_;
  Vec2 origin_;
  MeshBuilder walls_;
  MeshBuilder roof_;
  MeshBuilder tiles_;
  MeshBuilder trim_;
  MeshBuilder balconies_;
};

// Where both ends lie on the same side of the box the next tile goes on, and there is no kerb.
bool on_border(const Vec2& a, const Vec2& b, const PlanBox& box) {
  constexpr double kNear_m = 0.005;
  for (int axis = 0; axis < 2; ++axis) {
    for (const double side : {box.min[axis], box.max[axis]}) {
      if (std::abs(a[axis] - side) < kNear_m && std::abs(b[axis] - side) < kNear_m) return true;
    }
  }
  return false;
}

// Kerbs face the carriageway: its inside.
void add_kerbs(MeshBuilder& builder, const Region& low, const PlanBox& box) {
  const auto add = [&](Path ring, bool is_hole) {
    ring = with_inside_left(std::move(ring), is_hole);
    each_edge(ring, [&](const Vec2& a, const Vec2& b) {
      if (on_border(a, b, box)) return;
      const auto [from, to] = std::pair(b - box.centre(), a - box.centre());
      const UvRect uv{{0.0, 0.0}, {glm::distance(a, b) / kTexture_m, kPavementHeight_m / kTexture_m}};
      builder.patch(lifted(from, 0.0), lifted(to, 0.0), lifted(to, kPavementHeight_m), lifted(from, kPavementHeight_m), 1, 1, uv);
    });
  };
  for (const Polygon& polygon : low.polygons()) {
    add(polygon.shell, false);
    for (const Path& hole : polygon.holes) add(hole, true);
  }
}

}  // namespace

Ground Ground::within(const PlanBox& box) const {
  return {asphalt.within(box), paving.within(box), grass.within(box), water.within(box)};
}

Model extruded_building(const Region& footprint, double floors, const Vec2& origin) {
  Extrusion building(floors, origin);
  for (const Polygon& polygon : footprint.polygons()) building.add(polygon);
  return building.finish();
}

Model ground_tile(const Ground& ground, const PlanBox& box) {
  const Ground part = ground.within(box);
  Model model;
  const auto add = [&](const Region& area, const char* name, Surface surface, double height_m, const std::vector<const Region*>& kerbs) {
    MeshBuilder builder;
    add_flat(builder, area.triangles(), box.centre(), height_m);
    for (const Region* low : kerbs) add_kerbs(builder, *low, box);
    if (builder.triangle_count() > 0) model.parts.push_back({builder.finish(name), surface});
  };
  add(part.asphalt, "carriageway", Surface::kAsphalt, 0.0, {});
  add(part.paving, "pavement", Surface::kPaving, kPavementHeight_m, {&part.asphalt, &part.water});
  add(part.grass, "grass", Surface::kGrass, kPavementHeight_m, {});
  add(part.water, "water", Surface::kGlass, 0.0, {});
  return model;
}

}  // namespace standin
