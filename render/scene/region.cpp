#include "render/scene/region.h"

#include <geos_c.h>

#include <string>

#include "render/base/error.h"

namespace standin {
namespace {

constexpr double kGrid_m = 0.001;
constexpr int kQuadrantSegments = 3;  // of a round line end: a street's corner, not a circle

// GEOS' state, one per thread: it is not to be shared.
class Geos {
 public:
  Geos() : handle_(GEOS_init_r()) { GEOSContext_setErrorMessageHandler_r(handle_, note, this); }
  ~Geos() { GEOS_finish_r(handle_); }
  Geos(const Geos&) = delete;
  Geos& operator=(const Geos&) = delete;
  [[nodiscard]] GEOSContextHandle_t handle() const { return handle_; }
  [[nodiscard]] const std::string& message() const { return message_; }

 private:
  static void note(const char* message, void* self) { static_cast<Geos*>(self)->message_ = message; }
  GEOSContextHandle_t handle_;
  std::string message_;
};

const Geos& geos() {
  thread_local const Geos kGeos;
  return kGeos;
}

GEOSContextHandle_t handle() {
  return geos().handle();
}

GEOSGeometry* checked(GEOSGeometry* geometry) {
  if (geometry == nullptr) throw Failure(ErrorWord::kInternal, "GEOS: " + geos().message());
  return geometry;
}

struct Destroy {
  void operator()(GEOSGeometry* geometry) const { GEOSGeom_destroy_r(handle(), geometry); }
  void operator()(const GEOSPreparedGeometry* prepared) const { GEOSPreparedGeom_destroy_r(handle(), prepared); }
};
using Geometry = std::unique_ptr<GEOSGeometry, Destroy>;

GEOSCoordSequence* sequence(const Path& path, bool closed) {
  const std::size_t count = path.size() + (closed ? 1 : 0);
  GEOSCoordSequence* points = GEOSCoordSeq_create_r(handle(), static_cast<unsigned int>(count), 2);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2& point = path[i % path.size()];
    GEOSCoordSeq_setXY_r(handle(), points, static_cast<unsigned int>(i), point.x, point.y);
  }
  return points;
}

GEOSGeometry* ring(const Path& path) {
  return checked(GEOSGeom_createLinearRing_r(handle(), sequence(path, true)));
}

Path path_of(const GEOSGeometry* line, bool closed) {
  const GEOSCoordSequence* points = GEOSGeom_getCoordSeq_r(handle(), line);
  unsigned int count = 0;
  GEOSCoordSeq_getSize_r(handle(), points, &count);
  Path path;
  for (unsigned int i = 0; i + (closed ? 1 : 0) < count; ++i) {
    Vec2 point(0.0);
    GEOSCoordSeq_getXY_r(handle(), points, i, &point.x, &point.y);
    path.push_back(point);
  }
  return path;
}

// The areas of a geometry of any kind, down its collections.
template <typename Use>
void each_polygon(const GEOSGeometry* geometry, const Use& use) {
  if (GEOSGeomTypeId_r(handle(), geometry) == GEOS_POLYGON) {
    if (GEOSisEmpty_r(handle(), geometry) == 0) use(geometry);
    return;
  }
  const int count = GEOSGetNumGeometries_r(handle(), geometry);
  for (int i = 0; i < count; ++i) {
    const GEOSGeometry* part = GEOSGetGeometryN_r(handle(), geometry, i);
    if (part != geometry) each_polygon(part, use);
  }
}

// An overlay may leave lines and points where areas only touch; they are no area.
Geometry areas_of(const GEOSGeometry* geometry) {
  std::vector<GEOSGeometry*> parts;
  if (GEOSGeomTypeId_r(handle(), geometry) >= GEOS_POLYGON || GEOSGetNumGeometries_r(handle(), geometry) > 1) {
    each_polygon(geometry, [&](const GEOSGeometry* polygon) { parts.push_back(GEOSGeom_clone_r(handle(), polygon)); });
  }
  return Geometry(checked(GEOSGeom_createCollection_r(handle(), GEOS_MULTIPOLYGON, parts.data(), static_cast<unsigned int>(parts.size()))));
}

Geometry areas_of(Geometry geometry) {
  return areas_of(static_cast<const GEOSGeometry*>(geometry.get()));
}

Polygon polygon_of(const GEOSGeometry* from) {
  Polygon polygon;
  polygon.shell = path_of(GEOSGetExteriorRing_r(handle(), from), true);
  const int holes = GEOSGetNumInteriorRings_r(handle(), from);
  for (int i = 0; i < holes; ++i) polygon.holes.push_back(path_of(GEOSGetInteriorRingN_r(handle(), from, i), true));
  return polygon;
}

}  // namespace

struct Region::Shape {
  Geometry areas;  // a multipolygon
  std::unique_ptr<const GEOSPreparedGeometry, Destroy> prepared;
};

Region::Region() : shape_(std::make_unique<Shape>()) {
  shape_->areas.reset(checked(GEOSGeom_createEmptyCollection_r(handle(), GEOS_MULTIPOLYGON)));
}
Region::Region(std::unique_ptr<Shape> shape) : shape_(std::move(shape)) {}
Region::~Region() = default;
Region::Region(Region&&) noexcept = default;
Region& Region::operator=(Region&&) noexcept = default;

Region Region::of(const Polygon& polygon) {
  if (polygon.shell.size() < 3) return {};
  std::vector<GEOSGeometry*> holes;
  for (const Path& hole : polygon.holes) {
    if (hole.size() >= 3) holes.push_back(ring(hole));
  }
  const Geometry raw(
      checked(GEOSGeom_createPolygon_r(handle(), ring(polygon.shell), holes.data(), static_cast<unsigned int>(holes.size()))));
  auto shape = std::make_unique<Shape>();
  shape->areas = areas_of(Geometry(checked(GEOSMakeValid_r(handle(), raw.get()))));
  return Region(std::move(shape));
}

Region Region::around(const Path& line, double half_width_m) {
  if (line.size() < 2) return {};
  const Geometry raw(checked(GEOSGeom_createLineString_r(handle(), sequence(line, false))));
  auto shape = std::make_unique<Shape>();
  shape->areas = areas_of(Geometry(checked(GEOSBuffer_r(handle(), raw.get(), half_width_m, kQuadrantSegments))));
  return Region(std::move(shape));
}

Region Region::united(const std::vector<Region>& regions) {
  std::vector<GEOSGeometry*> parts;
  parts.reserve(regions.size());
  for (const Region& region : regions) parts.push_back(GEOSGeom_clone_r(handle(), region.shape_->areas.get()));
  const Geometry all(
      checked(GEOSGeom_createCollection_r(handle(), GEOS_GEOMETRYCOLLECTION, parts.data(), static_cast<unsigned int>(parts.size()))));
  auto shape = std::make_unique<Shape>();
  shape->areas = areas_of(Geometry(checked(GEOSUnaryUnionPrec_r(handle(), all.get(), kGrid_m))));
  return Region(std::move(shape));
}

Region Region::minus(const Region& other) const {
  auto shape = std::make_unique<Shape>();
  shape->areas = areas_of(Geometry(checked(GEOSDifferencePrec_r(handle(), shape_->areas.get(), other.shape_->areas.get(), kGrid_m))));
  return Region(std::move(shape));
}

Region Region::common(const Region& other) const {
  auto shape = std::make_unique<Shape>();
  shape->areas = areas_of(Geometry(checked(GEOSIntersectionPrec_r(handle(), shape_->areas.get(), other.shape_->areas.get(), kGrid_m))));
  return Region(std::move(shape));
}

Region Region::within(const PlanBox& box) const {
  return common(of({{box.min, {box.max.x, box.min.y}, box.max, {box.min.x, box.max.y}}, {}}));
}

Region Region::grown(double by_m) const {
  auto shape = std::make_unique<Shape>();
  shape->areas = areas_of(Geometry(checked(GEOSBuffer_r(handle(), shape_->areas.get(), by_m, kQuadrantSegments))));
  return Region(std::move(shape));
}

double Region::area_m2() const {
  double area = 0.0;
  GEOSArea_r(handle(), shape_->areas.get(), &area);
  return area;
}

bool Region::contains(const Vec2& point) const {
  if (!shape_->prepared) shape_->prepared.reset(GEOSPrepare_r(handle(), shape_->areas.get()));
  const Geometry place(checked(GEOSGeom_createPointFromXY_r(handle(), point.x, point.y)));
  return GEOSPreparedContains_r(handle(), shape_->prepared.get(), place.get()) == 1;
}

std::vector<Polygon> Region::polygons() const {
  std::vector<Polygon> result;
  each_polygon(shape_->areas.get(), [&](const GEOSGeometry* polygon) { result.push_back(polygon_of(polygon)); });
  return result;
}

std::vector<std::array<Vec2, 3>> Region::triangles() const {
  std::vector<std::array<Vec2, 3>> result;
  const Geometry cut(checked(GEOSConstrainedDelaunayTriangulation_r(handle(), shape_->areas.get())));
  each_polygon(cut.get(), [&](const GEOSGeometry* triangle) {
    const Path corners = polygon_of(triangle).shell;
    if (corners.size() == 3) result.push_back({corners[0], corners[1], corners[2]});
  });
  return result;
}

}  // namespace standin
