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
  if (context.shape == CellShape::kBox || context.shape == CellShape::kCell) return all;
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

/// What all techniques share of a candidate.
struct Cluster {
  std::vector<std::uint32_t> objects;
  Box bounds;
  std::vector<Vec3> points;
  ViewCell view_cell;
  ImpostorSketch sketch;
};

/// `given`: the view cell; none: what fits the cells.
std::optional<Cluster> cluster_seen_from(const DraftContext& context, std::uint32_t node, const CellSet& cells, const ViewCell* given) {
  Cluster cluster;
  cluster.objects = visible_objects(context, node, cells);
  for (const std::uint32_t object : cluster.objects) cluster.bounds.extend(context.scene.objects[object].bounds);
  auto view_cell = view_cell_around(context, cluster.bounds, cells);
  if (!view_cell) return std::nullopt;
  if (given != nullptr) view_cell = *given;
  cluster.view_cell = *view_cell;
  cluster.points = context.outlines.of(cluster.objects);
  cluster.sketch = sketch_impostor(cluster.bounds, cluster.points, *view_cell, context.camera, context.quality);
  if (!can_be_baked(context, cluster.bounds, cluster.points, *view_cell, cluster.sketch)) return std::nullopt;
  return cluster;
}

/// By the full plan, since the sketch does not tell one layer from two.
bool one_layer_is_enough(const DraftContext& context, const Cluster& cluster) {
  constexpr double kSurelyMore = 4.0;
  if (cluster.sketch.layers > kSurelyMore) return false;
  BakeQuality planar = context.quality;
  planar.max_layers = 1;
  return plan_impostor(cluster.bounds, cluster.points, cluster.view_cell, context.camera, planar).possible;
}

bool has_masked_surfaces(const Scene& scene, std::span<const std::uint32_t> objects) {
  const auto masked = [&](const Part& part) { return scene.materials[part.material].alpha_mode == AlphaMode::kMask; };
  return std::any_of(objects.begin(), objects.end(), [&](std::uint32_t id) {
    const Object& object = scene.objects[id];
    return std::ranges::any_of(std::span(scene.parts).subspan(object.first_part, object.part_count), masked);
  });
}

/// See draft.h.
bool has_its_own_to_offer(const DraftContext& context, const Cluster& cluster, Technique technique) {
  constexpr double kSomeDepth = 1.5;  // layers, as sketched
  const bool layered_too = context.sizes.offers(Technique::kLayered);
  switch (technique) {
    case Technique::kPlanar:
      return !layered_too && one_layer_is_enough(context, cluster);
    case Technique::kDepthMesh:
      return !layered_too || cluster.sketch.layers > kSomeDepth;
    case Technique::kLodSprite:
      return (!layered_too || cluster.sketch.layers > kSomeDepth) && !has_masked_surfaces(context.scene, cluster.objects);
    case Technique::kLayered:
      break;
  }
  return true;
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

Draft draft_of(const DraftContext& context, std::uint32_t node, const CellSet& cells, const Cluster& cluster, Technique technique) {
  Draft draft{{node, cluster.view_cell, cells, cluster.objects, 0.0, {}, technique}, {}, {}};
  draft.input = size_input(context.scene, context.outlines, cluster.objects, cluster.sketch);
  weigh(context, draft);
  return draft;
}

bool beats(const Draft& known, const Draft& draft) {
  return known.candidate.bytes <= draft.candidate.bytes && known.cost.fixed_ms <= draft.cost.fixed_ms;
}

std::vector<Draft> drafts_of(const DraftContext& context, std::uint32_t node, const CellSet& cells, const std::optional<Cluster>& cluster) {
  std::vector<Draft> drafts;
  if (!cluster) return drafts;
  for (std::size_t i = 0; i < kTechniqueCount; ++i) {
    const auto technique = static_cast<Technique>(i);
    if (!context.sizes.offers(technique) || !has_its_own_to_offer(context, *cluster, technique)) continue;
    Draft draft = draft_of(context, node, cells, *cluster, technique);
    const bool beaten = std::any_of(drafts.begin(), drafts.end(), [&](const Draft& known) { return beats(known, draft); });
    if (!beaten) drafts.push_back(std::move(draft));
  }
  return drafts;
}

}  // namespace

std::vector<Draft> draft_candidates(const DraftContext& context, std::uint32_t node, const CellSet& cells) {
  return drafts_of(context, node, cells, cluster_seen_from(context, node, cells, nullptr));
}

std::vector<Draft> draft_candidates(const DraftContext& context, std::uint32_t node, const CellSet& cells, const ViewCell& view_cell) {
  return drafts_of(context, node, cells, cluster_seen_from(context, node, cells, &view_cell));
}

std::optional<Draft> draft_planar(const DraftContext& context, std::uint32_t node, const CellSet& cells) {
  const auto cluster = cluster_seen_from(context, node, cells, nullptr);
  if (!cluster || !one_layer_is_enough(context, *cluster)) return std::nullopt;
  return draft_of(context, node, cells, *cluster, Technique::kPlanar);
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
