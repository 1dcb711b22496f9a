// Files that the program wrote once and anybody may have changed since: the first byte of the input says which reader is meant.
#include "estimation/samples_file.h"
#include "estimation/time_model.h"
#include "placement/runtime/placement.h"
#include "render/base/json_text.h"
#include "render/scene/level_file.h"
#include "server/files/placement_json.h"
#include "server/sweep/acceptance.h"
#include "server/sweep/baseline.h"
#include "server/verify/glb_quads.h"
#include "server/verify/shipped_impostors.h"
#include "tests/fuzz/input_file.h"
#include "tests/fuzz/mutation.h"
#include "tests/fuzz/scene_promises.h"
#include "tests/server/verify_views/small_placement.h"

namespace standin::fuzz {
namespace {

const test::SmallPlacement& small() {
  static const test::SmallPlacement placement;
  return placement;
}

// As verify uses it: the lookup of some views, and what they show.
void look_around(const Placement& placement, std::size_t objects) {
  const PlacementIndex index(placement);
  for (const double x : {-1.0, 0.0, 0.5, 4.0, 1e300})
    for (const Vec3& direction : {Vec3(1.0, 0.0, 0.0), Vec3(-0.3, 0.1, -1.0), Vec3(0.0)}) {
      const Lookup lookup = index.find(Vec3(x, 0.1 * x, -x), direction);
      for (const std::uint32_t object : content_of(placement, lookup, static_cast<std::uint32_t>(objects)).objects)
        require(object < objects, "what a view shows is there");
    }
}

void read_placement(std::string_view text) {
  PlacementFile file;
  std::size_t objects = 0;
  const bool good = read_or_refused([&] {
    const nlohmann::json object = parse_json(text, "placement.json");
    file = placement_from_json(object, "placement.json");
    objects = object["scene"]["objects"].size();
  });
  if (!good) return;
  (void)read_or_refused([&] { look_around(file.placement, objects); });
  (void)read_or_refused([&] { (void)read_shipped_impostors(small().glb, file.placement); });
}

void read_impostors(std::string_view bytes) {
  (void)read_or_refused([&] {
    const GlbQuads quads = read_glb_quads(std::string(bytes));
    (void)shipped_impostors(quads, small().placement);
  });
}

// Of a scene of the file that the levels are of, and of one that is no glTF.
void read_level_file(std::string_view bytes) {
  for (const bool is_gltf : {true, false}) {
    Scene scene = small().scene;
    for (std::size_t p = 0; p < scene.parts.size(); ++p) scene.parts[p].gltf_mesh = is_gltf ? static_cast<std::int32_t>(p) : -1;
    const std::vector<StatedLevel> stated = {{0, "lod_0", 50.0, 0.1, 2}, {0, "lod_1", 100.0, -1.0, 1}};
    if (read_or_refused([&] { (void)read_levels(stated, std::string(bytes), scene); })) check_scene(scene);
  }
}

void read_target_file(std::string_view text) {
  const auto file = input_folder().write("target.json", text);
  (void)read_or_refused([&] {
    const Target target = read_target(file);
    write_target(target, input_folder().path() / "again.json");
    require(read_target(input_folder().path() / "again.json").id == target.id, "a target file survives being written");
  });
}

void read_by(char kind, std::string_view bytes) {
  if (kind == 'p') return read_placement(bytes);
  if (kind == 'i') return read_impostors(bytes);
  if (kind == 'l') return read_level_file(bytes);
  if (kind == 't') return read_target_file(bytes);
  const auto file = input_folder().write("file", bytes);
  if (kind == 's') (void)read_or_refused([&] { (void)read_samples(file); });
  if (kind == 'b') (void)read_or_refused([&] { (void)read_baseline(file); });
  if (kind == 'a') (void)read_or_refused([&] { (void)read_acceptance(file); });
}

}  // namespace
}  // namespace standin::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 0) standin::fuzz::read_by(static_cast<char>(data[0]), standin::fuzz::view_of(data + 1, size - 1));
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most_bytes, unsigned seed) {
  using namespace standin::fuzz;
  const bool is_glb = size > 0 && (data[0] == 'i' || data[0] == 'l');
  return mutate({data, size, most_bytes}, seed, is_glb ? mutated_glb : mutated_json, 1);
}
