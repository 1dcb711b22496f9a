// Frames of a placement beside frames of the same scene made simpler everywhere: what each takes and how far each is from the original
// (simplified_walk.md holds results; thesis 1.3 sets impostors against geometric simplification).
//
//     simplified_walk export PLACED SCENE OUT.glb [--texture-folder DIR]
//     simplified_walk measure PLACED SCENE TARGET.json NAME=FILE.glb... [--views 24] [--repeats 3] [--texture-folder DIR]
//
// `export` writes the scene as it was placed, one node per object, named after its id. `measure` draws the same seeded views of each file
// NAME, of the original and of the original with its impostors, and prints a line of CSV per view and variant; simplified_walk.mjs makes
// the files with gltfpack and the table from the lines. Nodes that keep their names are culled by the placement's visible sets as the
// originals are.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "estimation/time_model.h"
#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/staged_file.h"
#include "render/device/frame_timer.h"
#include "render/device/renderer.h"
#include "render/scene/load.h"
#include "server/files/placement_json.h"
#include "server/job/metrics.h"
#include "server/job/target_device.h"
#include "server/job/world.h"
#include "server/verify/frame_pictures.h"
#include "server/verify/shipped_impostors.h"
#include "server/verify/view_sampling.h"

namespace standin {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct NamedFile {
  std::string name;
  fs::path file;
};

struct Arguments {
  std::vector<std::string> words;
  std::vector<NamedFile> simplified;
  std::vector<fs::path> texture_folders;
  std::uint32_t views = 24;  // of each kind
  int repeats = 3;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto equals = word.find('=');
    if (word.starts_with("--")) {
      if (i + 1 == argc) throw Failure(ErrorWord::kBadUsage, word + " needs a value");
      const std::string value = argv[++i];
      if (word == "--views") arguments.views = static_cast<std::uint32_t>(std::stoul(value));
      if (word == "--repeats") arguments.repeats = std::stoi(value);
      if (word == "--texture-folder") arguments.texture_folders.emplace_back(value);
    } else if (equals != std::string::npos) {
      arguments.simplified.push_back({word.substr(0, equals), word.substr(equals + 1)});
    } else {
      arguments.words.push_back(word);
    }
  }
  return arguments;
}

json read_json(const fs::path& file) {
  return json::parse(read_file(file));
}

/// A result folder of `standin place` and the scene that it was made for.
struct Placed {
  PlacementFile file;
  LoadOptions options;
  Scene scene;
};

Placed open(const fs::path& folder, const fs::path& scene_file, const Arguments& arguments) {
  const fs::path file = folder / "placement.json";
  Placed placed{placement_from_json(read_json(file), file.string()), {}, {}};
  placed.file.spec.texture_folders = {arguments.texture_folders.begin(), arguments.texture_folders.end()};
  placed.options = load_options(placed.file.spec);
  placed.scene = load_scene(scene_file, placed.options);
  if (placed.scene.sha256 != placed.file.scene_sha256) throw Failure(ErrorWord::kBadUsage, "the placement is for another scene");
  return placed;
}

std::string node_name(std::size_t object) {
  return "object_" + std::to_string(object);
}

int export_scene(const Arguments& arguments) {
  Placed placed = open(arguments.words.at(1), arguments.words.at(2), arguments);
  for (std::size_t id = 0; id < placed.scene.objects.size(); ++id) placed.scene.objects[id].name = node_name(id);
  write_scene_glb(placed.scene, arguments.words.at(3));
  return 0;
}

struct WalkView {
  View view;
  std::string kind;
  DrawList original;
  DrawList with_impostors;
};

/// What the view draws, before and after placement.
WalkView looked_up(const Placed& placed, const View& view, const char* kind) {
  const Lookup lookup = PlacementIndex(placed.file.placement).find(view.position, view.direction);
  const auto count = static_cast<std::uint32_t>(placed.scene.objects.size());
  ViewContent before = content_of(placed.file.placement, {lookup.cell, std::nullopt}, count);
  ViewContent after = content_of(placed.file.placement, lookup, count);
  return {view, kind, {std::move(before.objects), {}}, {std::move(after.objects), std::move(after.impostors)}};
}

/// As many as asked for of each kind: straight runs as a camera takes them, views in regions over budget (random ones, corners, borders,
/// and those whose bound is closest to the budget), and the slowest that the survey found, which may be fewer.
std::vector<WalkView> choose_views(const Placed& placed, const std::vector<View>& surveyed, std::uint32_t count) {
  constexpr std::uint32_t kSampledPerView = 8;  // every eighth of the sampler's is of a run
  std::uint32_t runs = 0, regions = 0;
  std::vector<WalkView> views;
  for (const VerifiedView& sampled : sample_views(placed.file.placement, placed.file.view_space, kSampledPerView * count, 1)) {
    const bool run = sampled.origin == ViewOrigin::kPath;
    if ((run ? runs : regions) == count) continue;
    WalkView view = looked_up(placed, sampled.view, run ? "walk" : "region");
    if (!run && view.with_impostors.impostors.empty()) continue;
    ++(run ? runs : regions);
    views.push_back(std::move(view));
  }
  for (std::size_t i = 0; i < std::min<std::size_t>(count, surveyed.size()); ++i)
    views.push_back(looked_up(placed, surveyed[i], "surveyed"));
  return views;
}

/// A way to draw the scene.
struct Variant {
  std::string name;
  std::uint64_t triangles = 0;
  std::unique_ptr<Scene> scene;  // none: the original's
  std::shared_ptr<Renderer> renderer;
  std::vector<DrawList> lists;  // per view
};

/// Per object of a simplified scene, which original it was made from; -1: merged from several, or unknown.
std::vector<std::int64_t> originals_of(const Scene& simplified, std::size_t original_count) {
  std::vector<std::int64_t> originals;
  const std::string prefix = "object_";
  for (const Object& object : simplified.objects) {
    const std::string& name = object.gltf_node;
    const std::int64_t id = name.starts_with(prefix) ? std::atoll(name.c_str() + prefix.size()) : -1;
    originals.push_back(id < static_cast<std::int64_t>(original_count) ? id : -1);
  }
  return originals;
}

DrawList visible_list(const std::vector<std::int64_t>& originals, const std::vector<std::uint32_t>& visible) {
  DrawList list;
  for (std::uint32_t id = 0; id < originals.size(); ++id)
    if (originals[id] < 0 || std::binary_search(visible.begin(), visible.end(), static_cast<std::uint32_t>(originals[id])))
      list.objects.push_back(id);
  return list;
}

Variant simplified_variant(const NamedFile& named, const Placed& placed, const std::vector<WalkView>& views, Context& context) {
  LoadOptions options = placed.options;
  options.placing = {};
  Variant variant{named.name, 0, std::make_unique<Scene>(load_scene(named.file, options)), nullptr, {}};
  variant.triangles = variant.scene->triangle_count();
  variant.renderer = std::make_shared<Renderer>(context, *variant.scene, placed.file.camera);
  const auto originals = originals_of(*variant.scene, placed.scene.objects.size());
  for (const WalkView& view : views) variant.lists.push_back(visible_list(originals, view.original.objects));
  return variant;
}

/// The original, the original with impostors, and the simplified ones, in this order.
std::vector<Variant> make_variants(const Placed& placed, const std::string& impostor_glb, const Arguments& arguments,
                                   const std::vector<WalkView>& views, Context& context) {
  const auto renderer = std::make_shared<Renderer>(context, placed.scene, placed.file.camera);
  renderer->upload(read_shipped_impostors(impostor_glb, placed.file.placement));
  std::vector<Variant> variants(2);
  variants[0].name = "original";
  variants[1].name = "impostors";
  for (Variant& variant : variants) {
    variant.renderer = renderer;
    variant.triangles = placed.scene.triangle_count();
  }
  for (const WalkView& view : views) {
    variants[0].lists.push_back(view.original);
    variants[1].lists.push_back(view.with_impostors);
  }
  for (const NamedFile& named : arguments.simplified) variants.push_back(simplified_variant(named, placed, views, context));
  return variants;
}

/// Against the original, per variant.
std::vector<PictureError> errors_of(const std::vector<Variant>& variants, const View& view, std::size_t index) {
  std::vector<Texture> pictures;
  for (const Variant& variant : variants) {
    variant.renderer->draw(view, variant.lists[index]);
    pictures.push_back(variant.renderer->read_pixels());
  }
  std::vector<PictureError> errors(variants.size());
  parallel_for(variants.size(), 2, {}, [&](std::size_t v) { errors[v] = error_of({pictures.front(), pictures[v]}); });
  return errors;
}

/// Median over rounds of all variants, so that a slower spell of the machine meets them all. Every state has been drawn by errors_of.
std::vector<double> times_of(FrameTimer& timer, const std::vector<Variant>& variants, const View& view, std::size_t index, int repeats) {
  std::vector<std::vector<double>> times(variants.size());
  for (int round = 0; round < repeats; ++round)
    for (std::size_t v = 0; v < variants.size(); ++v)
      times[v].push_back(timer.time(*variants[v].renderer, view, variants[v].lists[index]).milliseconds);
  std::vector<double> medians;
  for (auto& of_variant : times) {
    std::sort(of_variant.begin(), of_variant.end());
    medians.push_back(of_variant[of_variant.size() / 2]);
  }
  return medians;
}

/// The lock is held while frames are timed, not while pictures are compared, which takes longer.
std::vector<std::vector<double>> time_views(Context& context, const Target& target, const std::vector<Variant>& variants,
                                            const std::vector<WalkView>& views, int repeats) {
  TimingProtocol protocol{.warm_up = 0, .repeats = 1, .reference_ms = target.machine.reference_ms};
  protocol.clock = clock_named(target.machine.clock);
  const TimingLock lock{WorkBudget()};
  const auto timer = make_frame_timer(context, protocol);
  std::vector<std::vector<double>> times_ms;
  for (std::size_t i = 0; i < views.size(); ++i) times_ms.push_back(times_of(*timer, variants, views[i].view, i, repeats));
  return times_ms;
}

void print_lines(const std::vector<Variant>& variants, const WalkView& view, std::size_t index, const std::vector<double>& times_ms,
                 const std::vector<PictureError>& errors) {
  for (std::size_t v = 0; v < variants.size(); ++v)
    std::printf("%s,%llu,%zu,%s,%zu,%.4f,%.7f,%.7f\n", variants[v].name.c_str(), static_cast<unsigned long long>(variants[v].triangles),
                index, view.kind.c_str(), view.with_impostors.impostors.size(), times_ms[v], errors[v].mean_error, errors[v].mean_flip);
}

int measure(const Arguments& arguments) {
  const fs::path folder = arguments.words.at(1);
  const Placed placed = open(folder, arguments.words.at(2), arguments);
  const Target target = read_target(arguments.words.at(3));
  const json survey = read_json(folder / "metrics.json").at("survey");
  const auto views = choose_views(placed, slow_views_from_json(survey.value("worst_views", json::array())), arguments.views);
  const auto context = make_context(device_kind(target), placed.file.camera.width, placed.file.camera.height);
  const auto variants = make_variants(placed, read_file(folder / "impostors.glb"), arguments, views, *context);

  std::vector<std::vector<PictureError>> errors;
  for (std::size_t i = 0; i < views.size(); ++i) errors.push_back(errors_of(variants, views[i].view, i));
  const auto times_ms = time_views(*context, target, variants, views, arguments.repeats);
  std::puts("variant,triangles,view,kind,impostors,ms,mean_error,flip");
  for (std::size_t i = 0; i < views.size(); ++i) print_lines(variants, views[i], i, times_ms[i], errors[i]);
  return 0;
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  try {
    const auto arguments = standin::parse(argc, argv);
    if (arguments.words.size() == 4 && arguments.words[0] == "export") return standin::export_scene(arguments);
    if (arguments.words.size() == 4 && arguments.words[0] == "measure") return standin::measure(arguments);
    std::cerr << "export PLACED SCENE OUT.glb | measure PLACED SCENE TARGET.json NAME=FILE.glb...\n";
  } catch (const standin::Failure& failure) {
    std::cerr << failure.what() << "\n";
  }
  return 2;
}
