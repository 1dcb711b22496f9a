// glTF and GLB, by our own reader: a scene that keeps all its promises, or a refusal.
#include "render/scene/hierarchy.h"
#include "render/scene/load.h"
#include "tests/fuzz/input_file.h"
#include "tests/fuzz/mutation.h"
#include "tests/fuzz/scene_promises.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace standin;
  const auto file = fuzz::input_folder().write("scene.gltf", fuzz::view_of(data, size));
  LoadOptions options;
  options.split_triangles = 20;
  options.max_triangles = 100'000;
  options.max_texels = 1 << 20;
  Scene scene;
  if (!fuzz::read_or_refused([&] { scene = load_scene(file, options); })) return 0;
  fuzz::check_scene(scene);
  fuzz::require(build_hierarchy(scene).rank.size() == scene.objects.size(), "each object is in the hierarchy");
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most_bytes, unsigned seed) {
  return standin::fuzz::mutate({data, size, most_bytes}, seed, standin::fuzz::mutated_glb);
}
