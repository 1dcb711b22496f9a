#include "render/scene/mesh_builder.h"

#include <cmath>
#include <map>
#include <numbers>

namespace standin {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

double share(int i, int n) {
  return static_cast<double>(i) / n;
}

glm::dvec2 lerp(const UvRect& uv, double u, double v) {
  return {uv.from.x + (uv.to.x - uv.from.x) * u, uv.to.y + (uv.from.y - uv.to.y) * v};
}

Vec3 unit_or_up(const Vec3& v) {
  const double length = glm::length(v);
  return length > 0.0 ? v / length : Vec3(0.0, 1.0, 0.0);
}

// Some unit vector at right angles to the unit vector `axis`.
Vec3 across(const Vec3& axis) {
  return glm::normalize(glm::cross(axis, std::abs(axis.y) < 0.9 ? Vec3(0.0, 1.0, 0.0) : Vec3(1.0, 0.0, 0.0)));
}

}  // namespace

std::uint32_t MeshBuilder::vertex(const Vec3& position, const Vec3& normal, const glm::dvec2& uv) {
  mesh_.positions.emplace_back(position);
  mesh_.normals.emplace_back(normal);
  mesh_.uvs.emplace_back(uv);
  return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
}

// Triangles of a lattice of (nu + 1) x (nv + 1) vertices that start at `first`, rows along u.
void MeshBuilder::grid(std::uint32_t first, int nu, int nv) {
  const auto stride = static_cast<std::uint32_t>(nu + 1);
  for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(nv); ++j) {
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(nu); ++i) {
      const std::uint32_t a = first + j * stride + i;
      for (const std::uint32_t k : {a, a + 1, a + stride + 1, a, a + stride + 1, a + stride}) mesh_.indices.push_back(k);
    }
  }
}

void MeshBuilder::patch(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, int nu, int nv, const UvRect& uv) {
  const Vec3 normal = unit_or_up(glm::cross(c - a, d - b));
  const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
  for (int j = 0; j <= nv; ++j) {
    for (int i = 0; i <= nu; ++i) {
      const double u = share(i, nu);
      const double v = share(j, nv);
      vertex((a * (1 - u) + b * u) * (1 - v) + (d * (1 - u) + c * u) * v, normal, lerp(uv, u, v));
    }
  }
  grid(first, nu, nv);
}

void MeshBuilder::triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = unit_or_up(glm::cross(b - a, c - a));
  mesh_.indices.push_back(vertex(a, normal, {0.0, 1.0}));
  mesh_.indices.push_back(vertex(b, normal, {1.0, 1.0}));
  mesh_.indices.push_back(vertex(c, normal, {0.5, 0.0}));
}

void MeshBuilder::level_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double repeats_per_m) {
  const Vec3 normal = unit_or_up(glm::cross(b - a, c - a));
  for (const Vec3& p : {a, b, c}) mesh_.indices.push_back(vertex(p, normal, {p.x * repeats_per_m, p.z * repeats_per_m}));
}

void MeshBuilder::box(const Vec3& low, const Vec3& high, int n) {
  const auto at = [&](int i) { return Box{low, high}.corner(i); };
  patch(at(4), at(5), at(7), at(6), n, n);
  patch(at(5), at(1), at(3), at(7), n, n);
  patch(at(1), at(0), at(2), at(3), n, n);
  patch(at(0), at(4), at(6), at(2), n, n);
  patch(at(6), at(7), at(3), at(2), n, n);
}

void MeshBuilder::lathe(const Vec3& foot, const std::vector<Ring>& profile, int segments) {
  const int steps = static_cast<int>(profile.size()) - 1;
  const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
  for (int j = 0; j <= steps; ++j) {
    const Ring& ring = profile[static_cast<std::size_t>(j)];
    const Ring& below = profile[static_cast<std::size_t>(std::max(j - 1, 0))];
    const Ring& above = profile[static_cast<std::size_t>(std::min(j + 1, steps))];
    const glm::dvec2 outward(above.height_m - below.height_m, below.radius_m - above.radius_m);
    for (int i = 0; i <= segments; ++i) {
      const double angle = kTurn * share(i % segments, segments);
      const Vec3 radial(std::sin(angle), 0.0, std::cos(angle));
      vertex(foot + radial * ring.radius_m + Vec3(0.0, ring.height_m, 0.0), unit_or_up(radial * outward.x + Vec3(0.0, outward.y, 0.0)),
             {share(i, segments), 1.0 - share(j, steps)});
    }
  }
  grid(first, segments, steps);
}

void MeshBuilder::tube(const Vec3& p, const Vec3& q, double p_radius_m, double q_radius_m, int segments, int rings) {
  const Vec3 axis = unit_or_up(q - p);
  const Vec3 x = across(axis);
  const Vec3 y = glm::cross(axis, x);
  const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
  for (int j = 0; j <= rings; ++j) {
    const double v = share(j, rings);
    for (int i = 0; i <= segments; ++i) {
      const double angle = kTurn * share(i % segments, segments);
      const Vec3 radial = x * std::cos(angle) + y * std::sin(angle);
      vertex(p + (q - p) * v + radial * (p_radius_m + (q_radius_m - p_radius_m) * v), radial, {share(i, segments), 1.0 - v});
    }
  }
  grid(first, segments, rings);
}

void MeshBuilder::surface(const std::function<Vec3(double, double)>& point, int nu, int nv, const UvRect& uv) {
  constexpr double kStep = 1e-4;
  const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
  for (int j = 0; j <= nv; ++j) {
    for (int i = 0; i <= nu; ++i) {
      const double u = share(i, nu);
      const double v = share(j, nv);
      const Vec3 du = point(u + kStep, v) - point(u - kStep, v);
      const Vec3 dv = point(u, v + kStep) - point(u, v - kStep);
      vertex(point(u, v), unit_or_up(glm::cross(du, dv)), lerp(uv, u, v));
    }
  }
  grid(first, nu, nv);
}

void MeshBuilder::card(const Vec3& centre, const Vec3& half_u, const Vec3& half_v, const Vec3& normal) {
  const auto first = vertex(centre - half_u - half_v, normal, {0.0, 1.0});
  vertex(centre + half_u - half_v, normal, {1.0, 1.0});
  vertex(centre - half_u + half_v, normal, {0.0, 0.0});
  vertex(centre + half_u + half_v, normal, {1.0, 0.0});
  grid(first, 1, 1);
}

Mesh MeshBuilder::finish(const std::string& name) {
  mesh_.name = name;
  return std::move(mesh_);
}

Mesh refined(const Mesh& mesh) {
  Mesh result = mesh;
  result.indices.clear();
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints;
  const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
    const auto [place, fresh] = midpoints.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(result.positions.size()));
    if (fresh) {
      result.positions.push_back(0.5F * (mesh.positions[a] + mesh.positions[b]));
      result.normals.emplace_back(unit_or_up(Vec3(mesh.normals[a]) + Vec3(mesh.normals[b])));
      if (!mesh.uvs.empty()) result.uvs.push_back(0.5F * (mesh.uvs[a] + mesh.uvs[b]));
    }
    return place->second;
  };
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const std::uint32_t a = mesh.indices[i];
    const std::uint32_t b = mesh.indices[i + 1];
    const std::uint32_t c = mesh.indices[i + 2];
    const std::uint32_t ab = midpoint(a, b);
    const std::uint32_t bc = midpoint(b, c);
    const std::uint32_t ca = midpoint(c, a);
    for (const std::uint32_t k : {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca}) result.indices.push_back(k);
  }
  return result;
}

}  // namespace standin
