// What visible sets cost and miss, against sets of uniform rays alone that stop at the same certificate. Results: visibility.md.
//
//   visibility SCENE [CELLS [FRAMES [TEXTURE_FOLDER]]]
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <span>
#include <string>

#include "placement/view_space/cell_boxes.h"
#include "placement/view_space/cell_locator.h"
#include "render/base/parallel.h"
#include "render/visibility/certificate.h"
#include "render/visibility/region_rays.h"
#include "render/visibility/visible_set.h"
#include "server/job/world.h"

namespace {

using namespace standin;

constexpr std::uint64_t kCleanRays = 46'050;  // none misses: 1e-4 at 99 %, were there one test only
constexpr std::array kBuildingRays = {std::uint64_t{3'000}, std::uint64_t{100'000}, std::uint64_t{300'000}};
constexpr std::uint64_t kMostUniformRays = 100'000'000;
constexpr std::uint64_t kFreshRays = 1'000'000;  // per cell, that judge both sets
constexpr int kFramesPerRun = 10;

// Of this thread alone: the machine may be busy.
double seconds_now() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// What both ways came to in one cell.
struct Figures {
  double rays = 0.0;
  double seconds = 0.0;
  double bound = 0.0;
  double missed = 0.0;        // of the fresh rays
  double lost_objects = 0.0;  // of those that either way or a fresh ray saw
  double lost_triangles = 0.0;
  double objects = 0.0;
};

class Bench {
 public:
  explicit Bench(const World& world) : world_(world), cells_(world.view_space) {}

  void compare(std::size_t count) const;
  void walk(std::size_t frames) const;

 private:
  [[nodiscard]] std::vector<bool> members_of(const VisibleSet& set) const {
    std::vector<bool> members(world_.scene.objects.size());
    for (const std::uint32_t object : set.objects) members[object] = true;
    return members;
  }
  [[nodiscard]] std::vector<Figures> compare_in_cell(std::uint64_t ordinal) const;
  void judge(const Box& region, const std::vector<VisibleSet>& sets, std::span<Figures> figures, Rng& rng) const;
  void count_lost(const std::vector<bool>& truth, const std::vector<bool>& members, Figures& figures) const;
  [[nodiscard]] std::size_t wrong_pixels(const View& view, const VisibleSet& set) const;
  [[nodiscard]] std::vector<View> run(Rng& rng) const;

  const World& world_;
  CellBoxes cells_;
};

// What uniform rays alone come to.
class UniformSampler {
 public:
  UniformSampler(const World& world, const Box& region, Rng& rng)
      : world_(world), region_(region), cap_(region, world.scene.bounds), rng_(rng) {
    for (const Object& object : world.scene.objects) seen_.push_back(!intersection(region, object.bounds).empty());
  }

  /// Until as many rays as a test needs have met nothing new: it begins anew with every find. Not corrected for the number of tests.
  [[nodiscard]] VisibleSet until_clean() {
    for (std::uint64_t clean = 0; clean < kCleanRays && rays_ < kMostUniformRays; ++clean)
      if (shoot()) clean = 0;
    return set(1e-4);
  }
  /// So many rays, then until our own certificate states 1e-4.
  [[nodiscard]] VisibleSet until_certified(std::uint64_t building_rays) {
    while (rays_ < building_rays) static_cast<void>(shoot());
    MissCertificate certificate(kVisibilityConfidence, 1e-4);
    do certificate.add(shoot());
    while ((rays_ % 64 != 0 || certificate.upper_bound() > 1e-4) && rays_ < kMostUniformRays);
    return set(certificate.upper_bound());
  }

 private:
  // Returns whether it saw something new.
  bool shoot() {
    ++rays_;
    const Vec3 position = random_point(rng_, region_);
    const auto hit = world_.raytracer->nearest(position, cap_.random_direction(rng_));
    if (!hit || seen_[hit->object]) return false;
    return seen_[hit->object] = true;
  }
  [[nodiscard]] VisibleSet set(double bound) const {
    VisibleSet result;
    for (std::uint32_t object = 0; object < seen_.size(); ++object)
      if (seen_[object]) result.objects.push_back(object);
    result.missed_share_bound = bound;
    result.rays = rays_;
    return result;
  }

  const World& world_;
  const Box& region_;
  DirectionCap cap_;
  Rng& rng_;
  std::vector<bool> seen_;
  std::uint64_t rays_ = 0;
};

void print(const std::string& name, const std::vector<Figures>& all) {
  Figures sum;
  double worst_bound = 0.0, worst_missed = 0.0;
  for (const Figures& one : all) {
    sum.rays += one.rays, sum.seconds += one.seconds, sum.missed += one.missed, sum.objects += one.objects;
    sum.lost_objects += one.lost_objects, sum.lost_triangles += one.lost_triangles;
    worst_bound = std::max(worst_bound, one.bound), worst_missed = std::max(worst_missed, one.missed);
  }
  const auto n = static_cast<double>(all.size());
  std::printf("| %s | %.0f | %.4f | %.2g | %.2g | %.2g | %.0f | %.1f | %.2f %% |\n", name.c_str(), sum.rays / n, sum.seconds / n,
              worst_bound, sum.missed / n, worst_missed, sum.objects / n, sum.lost_objects / n, 100.0 * sum.lost_triangles / n);
}

// Fresh rays that count for `figures`, one for each of `sets`.
void Bench::judge(const Box& region, const std::vector<VisibleSet>& sets, std::span<Figures> figures, Rng& rng) const {
  std::vector<std::vector<bool>> members;
  for (const VisibleSet& set : sets) members.push_back(members_of(set));
  std::vector<bool> truth(world_.scene.objects.size());
  for (const VisibleSet& set : sets)
    for (const std::uint32_t object : set.objects) truth[object] = true;
  const DirectionCap cap(region, world_.scene.bounds);
  for (std::uint64_t ray = 0; ray < kFreshRays; ++ray) {
    const Vec3 position = random_point(rng, region);
    const auto hit = world_.raytracer->nearest(position, cap.random_direction(rng));
    if (!hit) continue;
    truth[hit->object] = true;
    for (std::size_t k = 0; k < sets.size(); ++k)
      if (!members[k][hit->object]) figures[k].missed += cap.share_of_sphere() / kFreshRays;
  }
  for (std::size_t k = 0; k < sets.size(); ++k) count_lost(truth, members[k], figures[k]);
}

void Bench::count_lost(const std::vector<bool>& truth, const std::vector<bool>& members, Figures& figures) const {
  double all = 0.0;
  for (std::uint32_t object = 0; object < truth.size(); ++object) {
    const auto triangles = static_cast<double>(world_.scene.objects[object].triangle_count);
    if (truth[object]) all += triangles;
    if (truth[object] && !members[object]) figures.lost_objects += 1.0, figures.lost_triangles += triangles;
  }
  if (all > 0.0) figures.lost_triangles /= all;
}

std::vector<Figures> Bench::compare_in_cell(std::uint64_t ordinal) const {
  Rng rng(17, ordinal);
  const Box region = cells_.cell_box(cells_.leaves()[rng.below(cells_.leaves().size())]);
  std::vector<VisibleSet> sets;
  std::vector<Figures> figures;
  const auto time = [&](const auto& make) {
    const double start = seconds_now();
    sets.push_back(make());
    figures.push_back({.rays = static_cast<double>(sets.back().rays),
                       .seconds = seconds_now() - start,
                       .bound = sets.back().missed_share_bound,
                       .objects = static_cast<double>(sets.back().objects.size())});
  };
  time([&] { return sample_visible_sets(world_.scene, *world_.raytracer, {region}, {.seed = 17 + ordinal}, 1, WorkBudget{}).front(); });
  time([&] { return UniformSampler(world_, region, rng).until_clean(); });
  for (const std::uint64_t building : kBuildingRays) time([&] { return UniformSampler(world_, region, rng).until_certified(building); });
  judge(region, sets, figures, rng);
  return figures;
}

void Bench::compare(std::size_t count) const {
  std::vector<std::vector<Figures>> found(count);
  parallel_for(count, world_.threads, WorkBudget{}, [&](std::size_t i) { found[i] = compare_in_cell(i); });
  std::vector<std::string> names = {"ours", "uniform, until 46,050 in a row find nothing"};
  for (const std::uint64_t rays : kBuildingRays) names.push_back("uniform, " + std::to_string(rays / 1000) + ",000, then our certificate");
  std::printf(
      "| %zu cells | rays | seconds | highest bound | missed | highest missed | objects | lost | triangles lost "
      "|\n|---|---|---|---|---|---|---|---|---|\n",
      count);
  for (std::size_t k = 0; count > 0 && k < found.front().size(); ++k) {
    std::vector<Figures> of_one;
    for (const auto& cell : found) of_one.push_back(cell[k]);
    print(names[k], of_one);
  }
}

std::vector<View> Bench::run(Rng& rng) const {
  const Vec3 start = world_.view_space.sample_position(rng);
  Vec3 end = world_.view_space.sample_position(rng);
  for (int i = 1; i < 16; ++i) {
    const Vec3 other = world_.view_space.sample_position(rng);
    if (glm::distance(start, other) < glm::distance(start, end)) end = other;
  }
  std::vector<View> views;
  for (int i = 0; i < kFramesPerRun; ++i) views.push_back({start + (i + 0.5) / kFramesPerRun * (end - start), glm::normalize(end - start)});
  return views;
}

std::size_t Bench::wrong_pixels(const View& view, const VisibleSet& set) const {
  const std::vector<bool> members = members_of(set);
  const Mat3 world_from_eye = world_from_eye_rotation(view.direction);
  const Camera& camera = world_.camera;
  std::size_t wrong = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Vec3 pixel((2.0 * (x + 0.5) / camera.width - 1.0) * camera.tan_half_x(),
                       (2.0 * (y + 0.5) / camera.height - 1.0) * camera.tan_half_y(), -1.0);
      const auto hit = world_.raytracer->nearest(view.position, glm::normalize(world_from_eye * pixel));
      if (hit && !members[hit->object]) ++wrong;
    }
  return wrong;
}

void Bench::walk(std::size_t frames) const {
  Rng rng(18);
  std::vector<Box> boxes;
  for (const CellKey& key : cells_.leaves()) boxes.push_back(cells_.cell_box(key));
  const CellLocator locator(world_.view_space.grid(), cells_.leaves(), boxes);
  std::vector<std::pair<View, std::uint32_t>> shown;
  std::map<std::uint32_t, VisibleSet> sets;
  for (int attempt = 0; shown.size() < frames && attempt < 100'000; ++attempt)
    for (const View& view : run(rng))
      if (const auto cell = locator.find(view.position); cell && shown.size() < frames) shown.emplace_back(view, *cell), sets[*cell];
  std::vector<std::uint32_t> ids;
  for (const auto& entry : sets) ids.push_back(entry.first);
  parallel_for(ids.size(), world_.threads, WorkBudget{}, [&](std::size_t i) {
    sets.at(ids[i]) = sample_visible_sets(world_.scene, *world_.raytracer, {boxes[ids[i]]}, {.seed = ids[i]}, 1, WorkBudget{}).front();
  });
  std::vector<std::size_t> wrong(shown.size());
  parallel_for(shown.size(), world_.threads, WorkBudget{},
               [&](std::size_t i) { wrong[i] = wrong_pixels(shown[i].first, sets.at(shown[i].second)); });
  std::size_t sum = 0, affected = 0;
  for (const std::size_t one : wrong) sum += one, affected += one > 0 ? 1 : 0;
  const double pixels = static_cast<double>(world_.camera.width) * world_.camera.height;
  std::printf("| %zu frames of %.0f pixels in %zu cells | wrong pixels: %zu (%.2g of all), in %zu frames, %zu in the worst |\n",
              shown.size(), pixels, sets.size(), sum, static_cast<double>(sum) / (pixels * static_cast<double>(shown.size())), affected,
              wrong.empty() ? 0 : *std::max_element(wrong.begin(), wrong.end()));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: visibility SCENE [CELLS [FRAMES [TEXTURE_FOLDER]]]\n"), 2;
  JobSpec spec;
  spec.lods = "off";  // objects as the scene has them
  if (argc > 4) spec.texture_folders = {argv[4]};
  spec.view_space = "walk";
  spec.visibility = "off";
  const WorkBudget budget;
  StageClock clock(budget);
  World world;
  build_world(argv[1], spec, clock, budget, world);
  const Bench bench(world);
  bench.compare(argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 100);
  bench.walk(argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 500);
}
