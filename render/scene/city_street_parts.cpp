// What stands in the streets, and the streets: cars, furniture, ground tiles.

#include <cmath>
#include <numbers>

#include "render/scene/city_detail.h"
#include "render/scene/mesh_builder.h"

namespace standin {
namespace {

// Point of a rounded rectangle (superellipse of degree 4) with half axes a, b.
Vec2 rounded(double angle, double a, double b) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const double scale = std::pow(c * c * c * c + s * s * s * s, -0.25);
  return {a * c * scale, b * s * scale};
}

// How full the section is at share v of the length: 1 in the middle, rounded down to `least` over a share `end` of the length.
double fullness(double v, double least, double end) {
  const double inward = std::min(v, 1.0 - v) / end;
  return inward >= 1.0 ? 1.0 : least + (1.0 - least) * std::sqrt(std::max(1.0 - (1.0 - inward) * (1.0 - inward), 0.0));
}

void add_body(MeshBuilder& paint, const CarShape& car, int level) {
  constexpr double kBluntness = 0.6;
  const double half_height = 0.27 * car.height_m;
  const double middle = 0.22 + half_height;
  const auto half_width = [&](double full) { return 0.5 * car.width_m * (0.7 + 0.3 * full); };
  const auto body = [&](double u, double v) {
    const double full = fullness(v, kBluntness, 0.12);
    const Vec2 section = rounded(2.0 * std::numbers::pi * u, half_width(full), half_height * full);
    return Vec3(section.x, middle + section.y, (v - 0.5) * car.length_m);
  };
  paint.surface(body, 4 + 2 * level, 6 + 3 * level);
  for (const double end : {-1.0, 1.0}) {  // bumpers close the blunt ends
    const double z = end * (0.5 * car.length_m - 0.02);
    const Vec3 half(0.98 * half_width(kBluntness), 0.95 * kBluntness * half_height, 0.05);
    paint.box(Vec3(0.0, middle, z) - half, Vec3(0.0, middle, z) + half);
  }
}

void add_cabin(MeshBuilder& glass, const CarShape& car, int level) {
  const double foot = 0.22 + 0.5 * car.height_m;
  const auto cabin = [&](double u, double v) {
    const double full = fullness(v, 0.05, 0.3);
    const Vec2 section = rounded(std::numbers::pi * u, 0.43 * car.width_m * (0.85 + 0.15 * full), (car.height_m - foot) * full);
    return Vec3(section.x, foot + section.y, (car.cabin_from + (car.cabin_to - car.cabin_from) * v - 0.5) * car.length_m);
  };
  glass.surface(cabin, 3 + level, 4 + 2 * level);
}

void add_wheels(MeshBuilder& tyre, const CarShape& car, int level) {
  const int segments = 5 + level;
  for (const double side : {-1.0, 1.0}) {
    for (const double z : {-0.3 * car.length_m, 0.3 * car.length_m}) {
      const double out = side * 0.5 * car.width_m;
      const Vec3 inner(out - side * 0.22, 0.31, z);
      const Vec3 outer(out, 0.31, z);
      tyre.tube(inner, outer, 0.31, 0.31, segments, 1);
      tyre.tube(outer, outer + Vec3(side * 0.02, 0, 0), 0.31, 0.01, segments, 1);
    }
  }
}

Model car_at(const CarShape& car, int level) {
  MeshBuilder paint;
  MeshBuilder glass;
  MeshBuilder tyre;
  add_body(paint, car, level);
  add_cabin(glass, car, level);
  add_wheels(tyre, car, level);
  Model model;
  model.parts.push_back({paint.finish("body"), Surface::kPaint});
  model.parts.push_back({glass.finish("cabin"), Surface::kGlass});
  model.parts.push_back({tyre.finish("wheels"), Surface::kTyre});
  return model;
}

// A turned piece whose every profile step is cut into 1 + level / 2.
Model turned(const std::vector<Ring>& profile, Surface surface, int level) {
  std::vector<Ring> fine{profile.front()};
  const int cuts = 1 + level / 2;
  for (std::size_t i = 1; i < profile.size(); ++i) {
    for (int c = 1; c <= cuts; ++c) {
      const double t = static_cast<double>(c) / cuts;
      fine.push_back({profile[i - 1].radius_m + t * (profile[i].radius_m - profile[i - 1].radius_m),
                      profile[i - 1].height_m + t * (profile[i].height_m - profile[i - 1].height_m)});
    }
  }
  MeshBuilder builder;
  builder.lathe(Vec3(0.0), fine, 4 + level);
  Model model;
  model.parts.push_back({builder.finish("turned"), surface});
  return model;
}

Model lamp(int level) {
  MeshBuilder metal;
  metal.tube({0, 0, 0}, {0, 1.0, 0}, 0.11, 0.07, 4 + level, 1);
  metal.tube({0, 1.0, 0}, {0, 5.2, 0}, 0.06, 0.045, 4 + level, 1 + level / 2);
  metal.tube({0, 5.2, 0}, {0, 5.6, 1.3}, 0.04, 0.03, 4 + level, 1 + level / 2);
  metal.box({-0.14, 5.52, 1.0}, {0.14, 5.66, 1.7}, 1 + level / 4);
  Model model;
  model.parts.push_back({metal.finish("lamp"), Surface::kMetal});
  return model;
}

Model bench(int level) {
  const int n = 1 + level / 3;
  MeshBuilder wood;
  MeshBuilder metal;
  for (int slat = 0; slat < 2 + std::min(level, 4); ++slat)
    wood.box({-0.9, 0.42, -0.25 + 0.09 * slat}, {0.9, 0.46, -0.18 + 0.09 * slat}, n);
  wood.box({-0.9, 0.6, -0.32}, {0.9, 0.85, -0.28}, n);
  for (const double x : {-0.7, 0.7}) metal.box({x - 0.03, 0.0, -0.3}, {x + 0.03, 0.42, 0.25}, n);
  Model model;
  model.parts.push_back({wood.finish("slats"), Surface::kWood});
  model.parts.push_back({metal.finish("feet"), Surface::kMetal});
  return model;
}

Model sign(int level) {
  MeshBuilder metal;
  MeshBuilder face;
  metal.tube({0, 0, 0}, {0, 2.7, 0}, 0.035, 0.035, 4 + level, 1 + level / 2);
  face.box({-0.35, 2.0, 0.04}, {0.35, 2.7, 0.07}, 1 + level / 2);
  Model model;
  model.parts.push_back({metal.finish("pole"), Surface::kMetal});
  model.parts.push_back({face.finish("face"), Surface::kPoster});
  return model;
}

Model furniture_at(FurnitureKind kind, int level) {
  switch (kind) {
    case FurnitureKind::kLamp:
      return lamp(level);
    case FurnitureKind::kBench:
      return bench(level);
    case FurnitureKind::kSign:
      return sign(level);
    case FurnitureKind::kBollard:
      return turned({{0.12, 0.0}, {0.1, 0.1}, {0.08, 0.8}, {0.1, 0.9}, {0.02, 1.0}}, Surface::kMetal, level);
    case FurnitureKind::kBin:
      return turned({{0.2, 0.0}, {0.25, 0.75}, {0.28, 0.8}, {0.2, 0.9}, {0.03, 0.95}}, Surface::kMetal, level);
    case FurnitureKind::kColumn:
      break;
  }
  return turned({{0.75, 0.0}, {0.7, 0.3}, {0.7, 2.9}, {0.85, 3.0}, {0.6, 3.3}, {0.05, 3.8}}, Surface::kPoster, level);
}

// An upward rectangle with its texture fixed to the ground, 4 m to a repeat.
void add_floor(MeshBuilder& builder, const Vec2& low, const Vec2& high, double y, int n) {
  const UvRect uv{low / 4.0, high / 4.0};
  builder.patch({low.x, y, high.y}, {high.x, y, high.y}, {high.x, y, low.y}, {low.x, y, low.y}, n, n, uv);
}

// The frame between two centred rectangles of half sizes `outer` and `inner`.
void add_frame(MeshBuilder& builder, const Vec2& outer, const Vec2& inner, double y, int n) {
  add_floor(builder, {-outer.x, inner.y}, outer, y, n);
  add_floor(builder, -outer, {outer.x, -inner.y}, y, n);
  add_floor(builder, {inner.x, -inner.y}, {outer.x, inner.y}, y, n);
  add_floor(builder, {-outer.x, -inner.y}, {-inner.x, inner.y}, y, n);
}

Model tile_at(const TileShape& shape, int level) {
  const int n = 1 + level;
  const double kerb_m = kPavementHeight_m;
  const Vec2 outer = 0.5 * shape.pitch_m;
  const Vec2 kerb = outer - (0.5 * shape.street_width_m - shape.pavement_m);
  const Vec2 yard = kerb - shape.pavement_m;
  MeshBuilder asphalt;
  MeshBuilder paving;
  MeshBuilder grass;
  add_frame(asphalt, outer, kerb, 0.0, n);
  add_frame(paving, kerb, yard, kerb_m, n);
  const auto kerbstone = [&](const Vec3& a, const Vec3& b) {
    paving.patch(a, b, b + Vec3(0, kerb_m, 0), a + Vec3(0, kerb_m, 0), n, 1, {{0.0, 0.0}, {glm::length(b - a) / 4.0, 0.05}});
  };
  kerbstone({-kerb.x, 0, kerb.y}, {kerb.x, 0, kerb.y});
  kerbstone({kerb.x, 0, kerb.y}, {kerb.x, 0, -kerb.y});
  kerbstone({kerb.x, 0, -kerb.y}, {-kerb.x, 0, -kerb.y});
  kerbstone({-kerb.x, 0, -kerb.y}, {-kerb.x, 0, kerb.y});
  add_floor(shape.lawn ? grass : paving, -yard, yard, kerb_m, n);
  Model model;
  model.parts.push_back({asphalt.finish("carriageway"), Surface::kAsphalt});
  model.parts.push_back({paving.finish("pavement"), Surface::kPaving});
  if (shape.lawn) model.parts.push_back({grass.finish("lawn"), Surface::kGrass});
  return model;
}

}  // namespace

Model make_car(const CarShape& shape, std::uint64_t triangles) {
  return finest_within(triangles, [&](int level) { return car_at(shape, level); });
}

Model make_furniture(FurnitureKind kind, std::uint64_t triangles) {
  return finest_within(triangles, [&](int level) { return furniture_at(kind, level); });
}

Model make_tile(const TileShape& shape, std::uint64_t triangles) {
  return finest_within(triangles, [&](int level) { return tile_at(shape, level); });
}

}  // namespace standin
