// Repair of imported meshes: after this every index is in range, every value finite and every triangle has an area.

#include <cmath>
#include <limits>

#include "render/base/error.h"
#include "render/scene/import.h"

namespace standin {
namespace {

using Kind = LoadNote::Kind;

bool finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

struct Dropped {
  std::uint64_t out_of_range = 0;
  std::uint64_t not_finite = 0;
  std::uint64_t flat = 0;
  [[nodiscard]] bool any() const { return out_of_range + not_finite + flat > 0; }
};

// Less than this share of the longest edge squared is rounding, not area.
constexpr double kNoArea = 1e-12;

bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 bc = c - b;
  const Vec3 normal = glm::cross(ab, ac);
  const double longest2 = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
  return glm::dot(normal, normal) > kNoArea * kNoArea * longest2 * longest2;
}

// Keeps the good triangles, in order.
Dropped drop_triangles(Mesh& mesh) {
  Dropped dropped;
  std::size_t kept = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const std::uint32_t a = mesh.indices[i];
    const std::uint32_t b = mesh.indices[i + 1];
    const std::uint32_t c = mesh.indices[i + 2];
    if (std::max({a, b, c}) >= mesh.positions.size()) {
      ++dropped.out_of_range;
    } else if (!finite(mesh.positions[a]) || !finite(mesh.positions[b]) || !finite(mesh.positions[c])) {
      ++dropped.not_finite;
    } else if (!has_area(mesh.positions[a], mesh.positions[b], mesh.positions[c])) {
      ++dropped.flat;
    } else {
      mesh.indices[kept] = a;
      mesh.indices[kept + 1] = b;
      mesh.indices[kept + 2] = c;
      kept += 3;
    }
  }
  mesh.indices.resize(kept);
  return dropped;
}

template <typename T>
void gather(std::vector<T>& values, const std::vector<std::uint32_t>& kept) {
  if (values.empty()) return;
  std::vector<T> result;
  result.reserve(kept.size());
  for (const std::uint32_t k : kept) result.push_back(values[k]);
  values = std::move(result);
}

void keep_vertices(Mesh& mesh, const std::vector<std::uint32_t>& kept) {
  gather(mesh.positions, kept);
  gather(mesh.normals, kept);
  gather(mesh.uvs, kept);
  if (mesh.source.empty())
    mesh.source = kept;
  else
    gather(mesh.source, kept);
}

// Vertices no triangle uses would widen the bounds.
void drop_unused_vertices(Mesh& mesh) {
  constexpr auto kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> place(mesh.positions.size(), kUnused);
  for (const std::uint32_t i : mesh.indices) place[i] = 0;
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < place.size(); ++i) {
    if (place[i] == kUnused) continue;
    place[i] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(i);
  }
  if (kept.size() == mesh.positions.size()) return;
  for (std::uint32_t& i : mesh.indices) i = place[i];
  keep_vertices(mesh, kept);
}

glm::vec3 face_normal(const Mesh& mesh, std::size_t triangle) {
  const Vec3 a = mesh.positions[mesh.indices[3 * triangle]];
  const Vec3 b = mesh.positions[mesh.indices[3 * triangle + 1]];
  const Vec3 c = mesh.positions[mesh.indices[3 * triangle + 2]];
  return glm::normalize(glm::cross(b - a, c - a));
}

// Three vertices of its own for each triangle.
void make_flat_normals(Mesh& mesh) {
  const std::vector<std::uint32_t> corners = std::move(mesh.indices);
  keep_vertices(mesh, corners);
  mesh.indices.resize(corners.size());
  mesh.normals.resize(corners.size());
  for (std::uint32_t i = 0; i < mesh.indices.size(); ++i) mesh.indices[i] = i;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) mesh.normals[i] = face_normal(mesh, i / 3);
}

// A normal that is not finite or zero becomes that of a triangle at the vertex; one of another length becomes a unit vector.
std::uint64_t repair_normals(Mesh& mesh) {
  std::uint64_t repaired = 0;
  std::vector<bool> bad(mesh.normals.size(), false);
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    const double length2 = glm::dot(Vec3(mesh.normals[i]), Vec3(mesh.normals[i]));
    bad[i] = !(length2 > 1e-12 && std::isfinite(length2));
    if (bad[i]) ++repaired;
    if (!bad[i] && std::abs(length2 - 1.0) > 1e-5) mesh.normals[i] = glm::vec3(Vec3(mesh.normals[i]) / std::sqrt(length2));
  }
  if (repaired == 0) return 0;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    if (bad[mesh.indices[i]]) mesh.normals[mesh.indices[i]] = face_normal(mesh, i / 3);
  }
  return repaired;
}

std::uint64_t repair_uvs(Mesh& mesh) {
  std::uint64_t repaired = 0;
  for (glm::vec2& uv : mesh.uvs) {
    if (std::isfinite(uv.x) && std::isfinite(uv.y)) continue;
    uv = glm::vec2(0.0F);
    ++repaired;
  }
  return repaired;
}

}  // namespace

std::int32_t add_texture(Import& import, Texture texture) {
  std::vector<Texture>& textures = import.scene.textures;
  textures.push_back(std::move(texture));
  import.texels += static_cast<std::uint64_t>(textures.back().width) * static_cast<std::uint64_t>(textures.back().height);
  if (import.texels > import.options.max_texels)
    throw Failure(ErrorWord::kTooLarge, "texture " + textures.back().name + " brings the scene to " + std::to_string(import.texels) +
                                            " texels, more than the " + std::to_string(import.options.max_texels) + " allowed");
  return static_cast<std::int32_t>(textures.size() - 1);
}

void add_note(Scene& scene, LoadNote::Kind kind, const std::string& what, std::uint64_t count, const std::string& why) {
  if (count == 0) return;
  for (LoadNote& note : scene.notes) {
    if (note.kind != kind || note.what != what || note.why != why) continue;
    note.count += count;
    return;
  }
  scene.notes.push_back({kind, what, count, why});
}

bool clean(Mesh& mesh, Scene& scene) {
  add_note(scene, Kind::kDropped, "indices", mesh.indices.size() % 3, "left over after the last whole triangle");
  mesh.indices.resize(mesh.indices.size() / 3 * 3);
  const Dropped dropped = drop_triangles(mesh);
  add_note(scene, Kind::kDropped, "triangles", dropped.out_of_range, "index out of range");
  add_note(scene, Kind::kDropped, "triangles", dropped.not_finite, "position not finite");
  add_note(scene, Kind::kDropped, "triangles", dropped.flat, "no area");
  if (mesh.indices.empty()) return false;
  if (mesh.normals.size() != mesh.positions.size()) mesh.normals.clear();
  if (mesh.uvs.size() != mesh.positions.size()) mesh.uvs.clear();
  drop_unused_vertices(mesh);
  if (mesh.normals.empty()) {
    add_note(scene, Kind::kRepaired, "meshes", 1, "no normals; flat ones made");
    make_flat_normals(mesh);
  }
  add_note(scene, Kind::kRepaired, "normals", repair_normals(mesh), "not finite or zero; taken from a triangle");
  add_note(scene, Kind::kRepaired, "texture coordinates", repair_uvs(mesh), "not finite; set to 0");
  return true;
}

bool has_holes(const Texture& texture) {
  for (std::size_t i = 3; i < texture.rgba.size(); i += 4) {
    if (texture.rgba[i] < 128) return true;
  }
  return false;
}

}  // namespace standin
