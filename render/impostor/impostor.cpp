#include "render/impostor/impostor.h"

#include <array>
#include <utility>

namespace standin {
namespace {

constexpr std::array<std::string_view, kTechniqueCount> kNames = {"layered", "tdm", "planar", "lod-sprite"};

void append_quad(const Impostor& impostor, const Quad& quad, TexturedMesh& mesh) {
  const auto first_vertex = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto first_index = static_cast<std::uint32_t>(mesh.indices.size());
  const double distance_m = impostor.layers.at(quad.layer).distance_m;
  for (const auto& [right, down] : {std::pair{0U, 0U}, {0U, 1U}, {1U, 1U}, {1U, 0U}}) {
    const std::uint32_t dx = right * quad.width, dy = down * quad.height;
    const Vec3 corner = layer_point(impostor.frame, distance_m, quad.x + dx, quad.y + dy);
    mesh.vertices.push_back({corner - impostor.frame.reference_viewpoint, Vec2(dx, dy)});
  }
  mesh.indices.insert(mesh.indices.end(), {0, 1, 2, 0, 2, 3});
  mesh.charts.push_back({quad.width, quad.height, first_vertex, 4, first_index, 6});
}

}  // namespace

std::string_view technique_name(Technique technique) {
  return kNames[static_cast<std::size_t>(technique)];
}

std::optional<Technique> technique_named(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return static_cast<Technique>(i);
  return std::nullopt;
}

std::span<const std::string_view> technique_names() {
  return kNames;
}

std::string_view guarantee_name(const Impostor& impostor) {
  return impostor.fuzzy || is_mesh(impostor.technique) ? "none" : "nearest";
}

TexturedMesh textured_mesh(const Impostor& impostor) {
  if (is_mesh(impostor.technique)) return impostor.mesh;
  TexturedMesh mesh;
  for (const Quad& quad : impostor.quads) append_quad(impostor, quad, mesh);
  return mesh;
}

}  // namespace standin
