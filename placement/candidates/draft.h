// One candidate from a cluster and the cells it is to serve.
//
// The impostor stands for the node's objects that are visible from a served cell, no others: what is never seen needs no texels. Its shaft
// starts at their centre and is tight around the cells (tight_shaft.h). A candidate and the reachable times come from the same draft, so
// what reachable_times() promises is what generate_candidates() offers.
//
// The same cluster and view cell is offered once per technique that has something of its own to offer. Where one layer is enough, meshes
// are that layer's quads, and a planar impostor is the layered one: they are drafted there only if layered impostors are not. Where more
// are needed a planar one is impossible. What an earlier technique of the enumeration beats in bytes and in fixed cost is left out.
#pragma once

#include <optional>

#include "placement/candidates/candidates.h"
#include "placement/candidates/cell_index.h"
#include "placement/candidates/cell_sets.h"
#include "placement/candidates/outlines.h"
#include "placement/candidates/size_model.h"

namespace standin {

/// All that drafting needs; nothing is owned.
struct DraftContext {
  const Scene& scene;
  const Hierarchy& hierarchy;
  const Subdivision& subdivision;
  const CellIndex& index;
  const ObjectOutlines& outlines;
  const TimeModel& model;
  const SizeModels& sizes;
  const Camera& camera;
  const BakeQuality& quality;
  CellShape shape;
};

struct Draft {
  Candidate candidate;
  Cost cost;  // of drawing it, with the size model's margins
  SizeInput input;
};

/// Predicted milliseconds in the linear form of a CPV.
[[nodiscard]] inline double in_form(const Cost& cost, const Cpv& cpv) {
  return cpv.pixels_capped ? cost.fixed_ms : cost.fixed_ms + cost.pixel_ms;
}

/// By technique, in the order of the enumeration. `cells`: ascending, at least one, each sees some object of the node. Empty when no
/// impostor is possible.
[[nodiscard]] std::vector<Draft> draft_candidates(const DraftContext& context, std::uint32_t node, const CellSet& cells);
/// The same with a view cell that encloses the cells, whatever its shape.
[[nodiscard]] std::vector<Draft> draft_candidates(const DraftContext& context, std::uint32_t node, const CellSet& cells,
                                                  const ViewCell& view_cell);

/// A planar one, beside whatever else is offered. Nothing where one layer is not enough.
[[nodiscard]] std::optional<Draft> draft_planar(const DraftContext& context, std::uint32_t node, const CellSet& cells);

/// Whether all objects visible from the cells lie in one child of the node: then the child's candidate is the same.
[[nodiscard]] bool belongs_to_child(const DraftContext& context, std::uint32_t node, const CellSet& cells);

}  // namespace standin
