#include "server/job/place_at_budget.h"

#include "render/impostor/atlas.h"
#include "render/impostor/impostor_glb.h"
#include "server/job/left_out.h"

namespace standin {
namespace {

void choose_and_bake(const Surveyed& job, const JobSpec& spec, Placed& placed, BakeMemory* bakes, StageClock& clock,
                     const WorkBudget& budget) {
  const World& world = job.world;
  const TimeModel& model = job.target.model;
  placed.candidates = clock.run("candidates", [&] {
    return generate_candidates(world.scene, world.hierarchy, placed.subdivision, model, job.sizes, world.camera, world.quality,
                               job.candidate_options, budget);
  });
  name_directions_left_out(world, placed.candidates, spec, clock);
  name_texturing_left_out(world.scene, spec, clock);
  placed.selected =
      select_and_bake(world, placed.subdivision, placed.candidates, job.sizes, model, spec.budget_ms, spec, bakes, clock, budget);
  name_culling_left_out(placed.selected.impostors, spec, clock);
}

}  // namespace

void place_at_budget(const Surveyed& job, const JobSpec& spec, Placed& placed, BakeMemory* bakes, StageClock& clock,
                     const WorkBudget& budget) {
  const World& world = job.world;
  const TimeModel& model = job.target.model;
  if (placed.subdivision.cpvs.empty() && !forced(spec, "candidates")) {
    for (const char* stage : {"candidates", "select", "bake"}) clock.skip(stage, kNoProblemViews);
    placed.selected.atlas_pages = 1;  // as a selection of nothing has it
  } else {
    choose_and_bake(job, spec, placed, bakes, clock, budget);
  }
  clock.run("assemble", [&] {
    std::vector<std::uint32_t> kept;
    placed.placement = assemble_placement(placed.subdivision, world.view_space, placed.selected.baked, placed.selected.assigned, model,
                                          world.camera, spec.budget_ms, placed.selected.page_switch_ms, kept);
    if (placed.shows_levels) placed.placement.levels = placement_levels(world.scene);
    std::vector<Impostor> impostors;
    for (const auto old : kept) impostors.push_back(std::move(placed.selected.impostors[old]));
    placed.set = pack_atlas(std::move(impostors));
    placed.glb = encode_impostor_glb(placed.set);
  });
}

PlacementFile placement_file(const Surveyed& job, const Placed& placed, const JobSpec& spec) {
  return {spec,
          job.world.scene.name,
          job.world.scene.sha256,
          job.target.id,
          job.target.sha256,
          job.target.model.coverage,
          job.world.camera,
          job.world.view_space,
          placed.selected.atlas_pages,
          placed.placement,
          placed.shows_levels ? job.world.lods.sha256 : ""};
}

}  // namespace standin
