// Impostor candidates (thesis 5.6): hierarchy nodes x shafts, generated from the problem views they serve.
//
// The blind product of nodes, apex angles, directions and distances has 2.4e8 members; we start from the (node, cell) pairs that can gain
// something and ask which shafts enclose the cell. Each shaft is then tightened: axis, aperture and near plane shrink to the cells served
// (2x less memory for nothing, simulation.md). Candidates with the same node and cells are duplicates; hopeless ones (too many layers, no
// gain) are dropped in O(1) from the closed-form layer count. Every (node, cell) that can gain anything also gets the shaft tight around
// that cell alone, so that the selection can reach what reachable_times() promises (pyramids, a baseline, may fall short of it). A node
// whose visible objects all lie in one child gets none of its own: the child's is the same impostor. Each is offered once per technique
// that has something of its own to offer (draft.h); planar impostors are offered for further, smaller sets of cells (planar_parts.h).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "placement/candidates/size_models.h"
#include "placement/view_space/subdivision.h"
#include "render/impostor/bake.h"
#include "render/scene/hierarchy.h"

namespace standin {

enum class CellShape {
  kShaft,    // tight around the cells served
  kPyramid,  // as the thesis has it: not tightened
  kBox,      // nodes of the view space's grid (thesis test 13)
  kCell,     // of these a leaf cube and what it was halved into alone (thesis test 14)
};

struct CandidateOptions {
  std::vector<double> apex_deg = {11.25, 22.5, 45.0, 90.0};
  double direction_step_deg = 11.25;
  bool every_direction = false;  // for tests: also asks of each cell the directions that cannot hold it
  CellShape shape = CellShape::kShaft;
  int threads = 1;
};

struct Candidate {
  std::uint32_t node = 0;  // of the hierarchy
  ViewCell view_cell;
  std::vector<std::uint32_t> cells;    // served, ascending ids of Subdivision::cells
  std::vector<std::uint32_t> objects;  // of the node, visible from a served cell, ascending
  double bytes = 0.0;                  // estimated texture bytes
  ImpostorCost cost;                   // estimated, without margins
  Technique technique = Technique::kLayered;
};

struct CandidateSet {
  std::vector<Candidate> candidates;  // deterministic order
  std::uint64_t generated = 0;        // before pruning
  std::uint64_t duplicates = 0;
  std::uint64_t impossible = 0;  // too many layers, cluster in the cell
  std::uint64_t hopeless = 0;    // no gain anywhere
};

[[nodiscard]] CandidateSet generate_candidates(const Scene& scene, const Hierarchy& hierarchy, const Subdivision& subdivision,
                                               const TimeModel& model, const SizeModels& sizes, const Camera& camera,
                                               const BakeQuality& quality, const CandidateOptions& options, const WorkBudget& budget);

/// From a candidate to its impostor; nothing where there can be none: the sketch was too hopeful. May be called from several threads.
using BakeCandidate = std::function<std::optional<Impostor>(const Candidate&)>;
/// Bakes. All references must outlive it.
[[nodiscard]] BakeCandidate candidate_baker(const Scene& scene, const TexturePyramids& textures, const Camera& camera,
                                            const BakeQuality& quality, const WorkBudget& budget);

/// Bakes a spread of `count` of the candidates, all of one technique, and fits its size model (deterministic).
[[nodiscard]] SizeModel fit_size_model(const Scene& scene, const std::vector<Candidate>& candidates, const Camera& camera,
                                       const BakeQuality& quality, std::uint32_t count, std::uint64_t seed, int threads,
                                       const WorkBudget& budget, const BakeCandidate& bake);
/// A size model to start from, before anything was baked: fitted on other scenes.
[[nodiscard]] SizeModel default_size_model(Technique technique = Technique::kLayered);

/// Lowest predicted time each CPV can be brought to by any disjoint candidates (tree DP: V(node) = max(best own gain, sum of V(children))),
/// each candidate of whichever offered technique gains most, in a shaft tight around the CPV's own cell. One value per CPV; `blockers`
/// names the objects that make up most of what is left.
struct Reach {
  std::vector<double> predicted_ms;                  // per CPV
  std::vector<std::vector<std::uint32_t>> blockers;  // per CPV, at most 5 objects, largest first
};
[[nodiscard]] Reach reachable_times(const Scene& scene, const Hierarchy& hierarchy, const Subdivision& subdivision, const TimeModel& model,
                                    const SizeModels& sizes, const Camera& camera, const BakeQuality& quality,
                                    const CandidateOptions& options, const WorkBudget& budget);

}  // namespace standin
