// Impostors per second where it counts: all impostors of a placement, baked again on 1, 2, ... threads (recording.md holds results).
//
//     plan_throughput PLACEMENT_FOLDER SCENE [impostors at most] [threads]
//
// Thread counts take turns on each half of the plan (more parts would each end with one thread waiting). Impostors come in a shuffled
// order, fewer than all are a sample.
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <numeric>
#include <utility>

#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/rng.h"
#include "render/impostor/technique.h"
#include "render/impostor/texture_pyramid.h"
#include "server/files/placement_json.h"
#include "server/job/world.h"

namespace standin {
namespace {

constexpr std::size_t kParts = 2;

struct Sum {
  double wall_s = 0.0, processor_s = 0.0;
  std::uint64_t layers = 0, texels = 0;
};

class Plan {
 public:
  Plan(const std::string& folder, const std::string& scene)
      : file_(placement_from_json(nlohmann::json::parse(std::ifstream(folder + "/placement.json")), folder)),
        scene_(load_scene(scene, load_options(file_.spec))),
        textures_(scene_),
        quality_(quality_of(file_.spec, file_.view_space.kind)) {
    if (scene_.sha256 != file_.scene_sha256) throw Failure(ErrorWord::kFileBroken, "the placement is of another scene");
    order_.resize(file_.placement.impostors.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    Rng rng(1);
    for (std::size_t i = order_.size(); i > 1; --i) std::swap(order_[i - 1], order_[rng.below(i)]);
  }

  [[nodiscard]] std::size_t size() const { return order_.size(); }

  void bake(std::size_t begin, std::size_t end, int threads, Sum& sum) const {
    std::vector<std::array<std::uint64_t, 2>> sizes(end - begin);
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t processor = std::clock();
    parallel_for(sizes.size(), threads, {}, [&](std::size_t i) {
      const PlacementImpostor& placed = file_.placement.impostors[order_[begin + i]];
      const Impostor impostor = bake_impostor(scene_, textures_, technique_named(placed.technique).value(),
                                              {placed.objects, placed.view_cell}, file_.camera, quality_);
      sizes[i] = {impostor.layers.size(), impostor.texel_count()};
    });
    sum.processor_s += static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
    sum.wall_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const auto& [layers, texels] : sizes) {
      sum.layers += layers;
      sum.texels += texels;
    }
  }

 private:
  PlacementFile file_;
  Scene scene_;
  TexturePyramids textures_;
  BakeQuality quality_;
  std::vector<std::size_t> order_;
};

void run(const std::string& folder, const std::string& scene, std::size_t most, int max_threads) {
  const Plan plan(folder, scene);
  const std::size_t count = std::min(most, plan.size());
  std::vector<Sum> sums(static_cast<std::size_t>(max_threads));
  for (std::size_t part = 0; part < kParts; ++part)
    for (int turn = 0; turn < max_threads; ++turn) {
      const int threads = 1 + static_cast<int>((part + static_cast<std::size_t>(turn)) % sums.size());
      plan.bake(count * part / kParts, count * (part + 1) / kParts, threads, sums[static_cast<std::size_t>(threads - 1)]);
    }
  const auto n = static_cast<double>(count);
  std::printf("%zu of %zu impostors, mean %.1f layers and %.0f texels\n\n", count, plan.size(), static_cast<double>(sums[0].layers) / n,
              static_cast<double>(sums[0].texels) / n);
  std::printf("| threads | wall, s | processor, s | impostors per second | over one thread |\n|---|---|---|---|---|\n");
  for (int threads = 1; threads <= max_threads; ++threads) {
    const Sum& sum = sums[static_cast<std::size_t>(threads - 1)];
    std::printf("| %d | %.1f | %.1f | %.1f | %.2f |\n", threads, sum.wall_s, sum.processor_s, n / sum.wall_s, sums[0].wall_s / sum.wall_s);
  }
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  try {
    if (argc < 3) throw standin::Failure(standin::ErrorWord::kBadUsage, "plan_throughput FOLDER SCENE [impostors at most] [threads]");
    const std::size_t most = argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 1'000'000;
    standin::run(argv[1], argv[2], most, argc > 4 ? std::atoi(argv[4]) : 2);
  } catch (const standin::Failure& failure) {
    std::cerr << failure.what() << "\n";
    return 2;
  }
}
