// All other formats, by Assimp behind our checks; the first byte of the input chooses which.
//
// Kept apart from fuzz_scene: what crashes inside Assimp is not ours to mend (a job's worker is a process of its own for such reasons).
#include <array>

#include "render/scene/load.h"
#include "tests/fuzz/input_file.h"
#include "tests/fuzz/scene_promises.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace standin;
  static constexpr std::array kNames = {"scene.obj", "scene.ply", "scene.stl", "scene.ac", "scene.acc", "scene.dae"};
  if (size == 0) return 0;
  const auto file = fuzz::input_folder().write(kNames.at(data[0] % kNames.size()), fuzz::view_of(data + 1, size - 1));
  LoadOptions options;
  options.split_triangles = 20;
  options.max_triangles = 100'000;
  options.max_texels = 1 << 20;
  Scene scene;
  if (fuzz::read_or_refused([&] { scene = load_scene(file, options); })) fuzz::check_scene(scene);
  return 0;
}
