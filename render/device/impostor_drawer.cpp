#include "render/device/impostor_drawer.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>
#include <tuple>
#include <utility>

namespace standin {
namespace {

void append_chart(const TexturedMesh& mesh, const Chart& chart, const AtlasSlot& slot, const Texture& page,
                  std::vector<DeviceVertex>& vertices, std::vector<std::uint32_t>& indices) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (std::uint32_t i = chart.first_vertex; i < chart.first_vertex + chart.vertex_count; ++i) {
    const ImpostorVertex& vertex = mesh.vertices[i];
    const Vec2 uv{(slot.x + vertex.texel.x) / page.width, (slot.y + vertex.texel.y) / page.height};
    vertices.push_back({.position = glm::vec3(vertex.offset), .normal = glm::vec3(0.0F), .uv = glm::vec2(uv)});
  }
  for (std::uint32_t i = chart.first_index; i < chart.first_index + chart.index_count; ++i) indices.push_back(first + mesh.indices[i]);
}

std::vector<std::uint32_t> charts_by_page(const std::vector<AtlasSlot>& slots) {
  std::vector<std::uint32_t> charts(slots.size());
  std::iota(charts.begin(), charts.end(), 0U);
  std::stable_sort(charts.begin(), charts.end(), [&](std::uint32_t a, std::uint32_t b) { return slots[a].page < slots[b].page; });
  return charts;
}

}  // namespace

ImpostorDrawer::ImpostorDrawer(const Gl& gl, const ImpostorSet& set) : pages_(gl, set.pages, Filtering::kNearestClamp) {
  Vertices vertices;
  Indices indices;
  for (std::uint32_t id = 0; id < set.impostors.size(); ++id) add_impostor(set, id, vertices, indices);
  first_piece_.push_back(static_cast<std::uint32_t>(pieces_.size()));
  if (indices.empty()) return;
  array_.emplace_back(gl, vertices, indices);
  for (auto& piece : pieces_) piece.range.vertex_array = array_.front().name();
}

void ImpostorDrawer::add_impostor(const ImpostorSet& set, std::uint32_t id, Vertices& vertices, Indices& indices) {
  const Impostor& impostor = set.impostors[id];
  const auto& slots = set.slots.at(id);
  const auto first_piece = static_cast<std::uint32_t>(pieces_.size());
  first_piece_.push_back(first_piece);
  reference_viewpoints_.push_back(impostor.frame.reference_viewpoint);
  const TexturedMesh mesh = textured_mesh(impostor);
  Box& bounds = bounds_.emplace_back();
  for (const ImpostorVertex& vertex : mesh.vertices) bounds.extend(impostor.frame.reference_viewpoint + vertex.offset);
  for (const std::uint32_t chart : charts_by_page(slots)) {
    const AtlasSlot& slot = slots[chart];
    if (pieces_.size() == first_piece || pieces_.back().page != slot.page)
      pieces_.push_back({.page = slot.page,
                         .impostor = id,
                         .range = {.vertex_array = 0, .base_vertex = 0, .first_index = indices.size(), .index_count = 0}});
    append_chart(mesh, mesh.charts.at(chart), slot, set.pages.at(slot.page), vertices, indices);
    pieces_.back().range.index_count += static_cast<std::int32_t>(mesh.charts[chart].index_count);
  }
}

void ImpostorDrawer::draw(BoundState& state, const Mat4& clip_from_world, std::span<const std::uint32_t> impostors) const {
  std::vector<const Piece*> ordered;
  for (const std::uint32_t id : impostors)
    for (std::uint32_t i = first_piece_[id]; i < first_piece_[id + 1]; ++i) ordered.push_back(&pieces_[i]);
  std::sort(ordered.begin(), ordered.end(),
            [](const Piece* a, const Piece* b) { return std::tie(a->page, a->impostor) < std::tie(b->page, b->impostor); });
  for (const Piece* piece : ordered) {
    state.use(Program::kImpostor);
    state.use(Culling::kNone);
    state.use_texture(pages_.name(piece->page));
    state.draw(piece->range, glm::translate(clip_from_world, reference_viewpoints_[piece->impostor]));
    ++state.counts.impostor_draws;
  }
}

}  // namespace standin
