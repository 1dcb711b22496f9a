#include "render/device/impostor_drawer.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>
#include <tuple>
#include <utility>

namespace standin {
namespace {

// Corners in the order (0,0) (1,0) (1,1) (0,1) of texel coordinates.
void append_quad(const Impostor& impostor, const Quad& quad, const AtlasSlot& slot, const Texture& page, Box& bounds,
                 std::vector<DeviceVertex>& vertices, std::vector<std::uint32_t>& indices) {
  const double distance_m = impostor.layers.at(quad.layer).distance_m;
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (const auto& [right, down] : {std::pair{0U, 0U}, {1U, 0U}, {1U, 1U}, {0U, 1U}}) {
    const std::uint32_t dx = right * quad.width;
    const std::uint32_t dy = down * quad.height;
    const Vec3 world = layer_point(impostor.frame, distance_m, quad.x + dx, quad.y + dy);
    bounds.extend(world);
    const Vec2 uv{static_cast<double>(slot.x + dx) / page.width, static_cast<double>(slot.y + dy) / page.height};
    vertices.push_back({.position = glm::vec3(world - impostor.frame.reference_viewpoint), .normal = glm::vec3(0.0F), .uv = glm::vec2(uv)});
  }
  for (const std::uint32_t corner : {0U, 1U, 2U, 0U, 2U, 3U}) indices.push_back(first + corner);
}

std::vector<std::uint32_t> quads_by_page(const std::vector<AtlasSlot>& slots) {
  std::vector<std::uint32_t> quads(slots.size());
  std::iota(quads.begin(), quads.end(), 0U);
  std::stable_sort(quads.begin(), quads.end(), [&](std::uint32_t a, std::uint32_t b) { return slots[a].page < slots[b].page; });
  return quads;
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
  Box& bounds = bounds_.emplace_back();
  for (const std::uint32_t quad : quads_by_page(slots)) {
    const AtlasSlot& slot = slots[quad];
    if (pieces_.size() == first_piece || pieces_.back().page != slot.page)
      pieces_.push_back({.page = slot.page,
                         .impostor = id,
                         .range = {.vertex_array = 0, .base_vertex = 0, .first_index = indices.size(), .index_count = 0}});
    append_quad(impostor, impostor.quads.at(quad), slot, set.pages.at(slot.page), bounds, vertices, indices);
    pieces_.back().range.index_count += 6;
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
