// Areas in the plan of a city and what is done with them: union, difference, clipping, growing, triangulation with holes.
//
// By GEOS, and nowhere else: maps are full of rings that touch or cross themselves, streets overlap where they meet, and a ground made of
// areas that truly do not overlap has no two surfaces in one plane. Overlays are snapped to a millimetre, which never fails.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "render/scene/plan_geometry.h"

namespace standin {

class Region {
 public:
  Region();
  ~Region();
  Region(Region&&) noexcept;
  Region& operator=(Region&&) noexcept;
  Region(const Region&) = delete;
  Region& operator=(const Region&) = delete;

  /// A polygon that crosses itself is made valid; one without area is empty.
  [[nodiscard]] static Region of(const Polygon& polygon);
  /// All points within `half_width_m` of the line.
  [[nodiscard]] static Region around(const Path& line, double half_width_m);
  [[nodiscard]] static Region united(const std::vector<Region>& regions);

  [[nodiscard]] Region minus(const Region& other) const;
  [[nodiscard]] Region within(const PlanBox& box) const;
  [[nodiscard]] Region common(const Region& other) const;
  [[nodiscard]] Region grown(double by_m) const;

  [[nodiscard]] double area_m2() const;
  /// Quick after the first call.
  [[nodiscard]] bool contains(const Vec2& point) const;
  [[nodiscard]] std::vector<Polygon> polygons() const;
  /// Delaunay triangles of the polygons, without new vertices.
  [[nodiscard]] std::vector<std::array<Vec2, 3>> triangles() const;

 private:
  struct Shape;
  explicit Region(std::unique_ptr<Shape> shape);
  std::unique_ptr<Shape> shape_;
};

}  // namespace standin
