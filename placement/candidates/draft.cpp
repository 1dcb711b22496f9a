#include "placement/candidates/draft.h"

#include <algorithm>
#include <cmath>

#include "placement/candidates/size_model.h"
#include "placement/candidates/tight_shaft.h"

namespace standin {
namespace {

std::vector<std::uint32_t> visible_objects(const DraftContext& context, std::uint32_t node, const CellSet& cells) {
  std::vector<std::uint32_t> objects;
  for (const std::uint32_t cell : cells)
    for (const std::uint32_t rank : context.index.visible_in(cell, node)) objects.push_back(context.hierarchy.order[rank]);
  std::sort(objects.begin(), objects.end());
  objects.erase(std::unique(objects.begin(), objects.end()), objects.end());
  objects.shrink_to_fit();  // candidates are millions, and most cells of a set see the same objects
  return objects;
}

std::optional<ViewCell> view_cell_around(const DraftContext& context, const Box& object_bounds, const CellSet& cells) {
  std::vector<Box> boxes;
  Box all;
  for (const std::uint32_t cell : cells) {
    boxes.push_back(context.subdivision.cells[cell].box);
    all.extend(boxes.back());
    if (distance(boxes.back(), object_bounds) <= 0.0) return std::nullopt;
  }
  if (context.shape == CellShape::kBox) return all;
  return tight_shaft(object_bounds.centre(), boxes);
}

// The sketch's number of layers may be off by a few: near the limit only the full plan knows, and what is selected must be bakeable.
bool can_be_baked(const DraftContext& context, const Box& object_bounds, std::span<const Vec3> points, const ViewCell& view_cell,
                  const ImpostorSketch& sketch) {
  constexpr double kSure = 0.9;
  if (!std::isfinite(sketch.layers)) return false;
  return sketch.layers <= kSure * context.quality.max_layers ||
         plan_impostor(object_bounds, points, view_cell, context.camera, context.quality).possible;
}

/// Bytes and drawing cost by the technique's size model.
void weigh(const DraftContext& context, Draft& draft) {
  const SizeModel& sizes = context.sizes.of(draft.candidate.technique);
  const SizeEstimate size = estimate_size(sizes, draft.input);
  draft.candidate.bytes = size.bytes;
  // Texels are chosen so that the nearest layer is not magnified from the nearest point of the view cell.
  draft.candidate.cost = {size.quads, size.texels, context.quality.texel_scale / context.camera.focal_px()};
  ImpostorCost cautious = draft.candidate.cost;
  cautious.quads *= sizes.quads_margin;
  cautious.texels *= sizes.texels_margin;
  draft.cost = context.model.cost(impostor_features_bound(cautious, context.camera));
}

}  // namespace

std::optional<Draft> draft_candidate(const DraftContext& context, std::uint32_t node, const CellSet& cells) {
  std::vector<std::uint32_t> objects = visible_objects(context, node, cells);
  Box bounds;
  for (const std::uint32_t object : objects) bounds.extend(context.scene.objects[object].bounds);
  const auto view_cell = view_cell_around(context, bounds, cells);
  if (!view_cell) return std::nullopt;
  const std::vector<Vec3> points = context.outlines.of(objects);
  const ImpostorSketch sketch = sketch_impostor(bounds, points, *view_cell, context.camera, context.quality);
  if (!can_be_baked(context, bounds, points, *view_cell, sketch)) return std::nullopt;

  Draft draft{{node, *view_cell, cells, std::move(objects), 0.0, {}, Technique::kLayered}, {}, {}};
  draft.input = size_input(context.scene, context.outlines, draft.candidate.objects, sketch);
  weigh(context, draft);
  return draft;
}

std::optional<Draft> as_depth_mesh(const DraftContext& context, const Draft& layered) {
  if (!context.sizes.depth_mesh || !(layered.input.layers > 1.5)) return std::nullopt;
  Draft draft = layered;
  draft.candidate.technique = Technique::kDepthMesh;
  weigh(context, draft);
  const bool faster = draft.cost.fixed_ms < layered.cost.fixed_ms;
  if (draft.candidate.bytes >= layered.candidate.bytes && !faster) return std::nullopt;
  return draft;
}

bool belongs_to_child(const DraftContext& context, std::uint32_t node, const CellSet& cells) {
  const HierarchyNode& parent = context.hierarchy.nodes[node];
  if (parent.left < 0) return false;
  const auto left = static_cast<std::uint32_t>(parent.left);
  const auto right = static_cast<std::uint32_t>(parent.right);
  const auto none_in = [&](std::uint32_t child) {
    return std::all_of(cells.begin(), cells.end(), [&](std::uint32_t cell) { return context.index.visible_in(cell, child).empty(); });
  };
  return none_in(left) || none_in(right);
}

}  // namespace standin
