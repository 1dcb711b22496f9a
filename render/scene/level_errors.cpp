#include "render/scene/level_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "render/base/parallel.h"
#include "render/scene/textured_surface.h"

namespace standin {
namespace {

// Sums may differ in their last bits from those of the build that stated them.
constexpr double kRounding = 1e-9;
// Pieces of surface per triangle before an error counts as unproven: several times what finding it took.
constexpr double kMostPieces = 400.0;

/// Two surfaces, and how near to each other they are said to lie, in the space of their meshes.
struct Claim {
  double error_m = std::numeric_limits<double>::infinity();
  std::uint32_t object = 0;  // the first that states this
  std::size_t level = 0;
};

/// What is held against each other: a mesh and its simpler form, or, of an author's level, two ranges of parts.
struct Pair {
  bool by_place_alone = false;
  std::uint32_t original = 0, simple = 0;              // meshes, or first parts
  std::uint32_t original_count = 0, simple_count = 0;  // of parts
  friend auto operator<=>(const Pair&, const Pair&) = default;
};

std::string metres(double value) {
  return std::to_string(value) + " m";
}

class LevelJudge {
 public:
  LevelJudge(const Scene& scene, const LevelOptions& options, const WorkBudget& budget)
      : scene_(scene), options_(options), budget_(budget), textured_(worn_with_texture(scene)) {}

  std::vector<LevelFault> run() {
    for (std::uint32_t id = 0; id < scene_.objects.size(); ++id)
      for (std::size_t k = 0; k < scene_.objects[id].levels.size(); ++k) hear(id, k);
    const std::vector<std::pair<Pair, Claim>> claims(claims_.begin(), claims_.end());
    std::vector<double> bounds_m(claims.size());
    parallel_for(claims.size(), options_.threads, budget_,
                 [&](std::size_t i) { bounds_m[i] = bound_m(claims[i].first, claims[i].second); });
    for (std::size_t i = 0; i < claims.size(); ++i)
      if (const auto& [pair, claim] = claims[i]; !(bounds_m[i] <= claim.error_m))
        report(claim.object, claim.level,
               "its surface lies within " + metres(bounds_m[i]) + " of the original's, stated are " + metres(claim.error_m));
    std::ranges::stable_sort(faults_, {}, &LevelFault::object);
    return std::move(faults_);
  }

 private:
  void report(std::uint32_t object, std::size_t level, const std::string& what) {
    faults_.push_back({object, "object " + std::to_string(object) + ": level " + std::to_string(level + 1) + ": " + what});
  }

  void hear(std::uint32_t id, std::size_t k) {
    const Object& object = scene_.objects[id];
    const ObjectLevel& level = object.levels[k];
    const bool by_coverage = level.error_m < 0.0;
    const double least_m =
        by_coverage ? coverage_distance_m(object, std::max(0.0, level.screen_coverage), options_) : level.error_m / options_.error_m_per_m;
    if (by_coverage && level.screen_coverage < 0.0) return report(id, k, "states no error, and its author no coverage");
    if (!(level.least_distance_m >= least_m * (1.0 - kRounding)))
      report(id, k, "is shown from " + metres(level.least_distance_m) + ", recomputed " + metres(least_m));
    const std::uint64_t finer = k == 0 ? object.triangle_count : object.levels[k - 1].triangle_count;
    if (level.triangle_count >= finer) report(id, k, "has no fewer triangles than what it stands for");
    if (!by_coverage) add_claims(id, k, level.error_m * (1.0 + kRounding) / greatest_stretch(object.world_from_object));
  }

  void add_claims(std::uint32_t id, std::size_t k, double error_m) {
    const Object& object = scene_.objects[id];
    const ObjectLevel& level = object.levels[k];
    if (level.part_count != object.part_count || is_authored(object, level))
      return claim({true, object.first_part, level.first_part, object.part_count, level.part_count}, {error_m, id, k});
    for (std::uint32_t p = 0; p < level.part_count; ++p) {
      const std::uint32_t own = scene_.parts[object.first_part + p].mesh, shown = scene_.parts[level.first_part + p].mesh;
      if (own != shown) claim({false, own, shown}, {error_m, id, k});
    }
  }

  /// Simplified meshes know what they stand for; anything else must be held against the object as a whole.
  [[nodiscard]] bool is_authored(const Object& object, const ObjectLevel& level) const {
    for (std::uint32_t p = 0; p < level.part_count; ++p) {
      const std::uint32_t own = scene_.parts[object.first_part + p].mesh, shown = scene_.parts[level.first_part + p].mesh;
      if (own != shown && scene_.meshes[shown].simplified_from != static_cast<std::int32_t>(own)) return true;
    }
    return false;
  }

  void claim(const Pair& pair, const Claim& stated) {
    Claim& strictest = claims_.try_emplace(pair, stated).first->second;
    if (stated.error_m < strictest.error_m) strictest = stated;
  }

  [[nodiscard]] double bound_m(const Pair& pair, const Claim& claim) const {
    DeviationLimits limits;
    limits.relative = 0.0;
    limits.absolute_m = claim.error_m;
    limits.refuted_m = claim.error_m;
    limits.budget = &budget_;
    if (!pair.by_place_alone)
      return TexturedSurface(scene_.meshes[pair.original], textured_[pair.original])
          .deviation_of(scene_.meshes[pair.simple], limits, kMostPieces)
          .bound_m;
    return deviation_by_place(scene_, {pair.original, pair.original_count}, {pair.simple, pair.simple_count}, limits, kMostPieces).bound_m;
  }

  const Scene& scene_;
  const LevelOptions& options_;
  const WorkBudget& budget_;
  std::vector<bool> textured_;  // per mesh
  std::map<Pair, Claim> claims_;
  std::vector<LevelFault> faults_;
};

}  // namespace

double greatest_stretch(const Mat4& transform) {
  const Mat3 m(transform);
  const Mat3 gram = glm::transpose(m) * m;
  double uniform = 0.0, off = 0.0;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) (c == r ? uniform : off) = std::max(c == r ? uniform : off, std::abs(gram[c][r]));
  // Gershgorin: no eigenvalue is farther from the diagonal than the row's other entries add up to.
  return std::sqrt(uniform + 2.0 * off);
}

double coverage_distance_m(const Object& object, double screen_coverage, const LevelOptions& options) {
  return 0.5 * object.bounds.diagonal() * options.whole_image_distance / std::sqrt(std::max(screen_coverage, 1e-12));
}

Surface surface_of_parts(const Scene& scene, PartRange parts) {
  Surface all;
  for (std::uint32_t p = 0; p < parts.count; ++p) {
    const Surface one = surface_of(scene.meshes[scene.parts[parts.first + p].mesh], 0.0);
    const auto first = static_cast<std::uint32_t>(all.points.size());
    all.points.insert(all.points.end(), one.points.begin(), one.points.end());
    for (const auto& [a, b, c] : one.triangles) all.triangles.push_back({first + a, first + b, first + c});
  }
  return all;
}

Deviation deviation_by_place(const Scene& scene, PartRange a, PartRange b, DeviationLimits limits, double pieces_per_triangle) {
  const ComparedSurface one(surface_of_parts(scene, a)), other(surface_of_parts(scene, b));
  limits.pieces = static_cast<std::uint64_t>(pieces_per_triangle * static_cast<double>(one.triangle_count() + other.triangle_count()));
  return one.deviation_both_ways(other, limits);
}

std::vector<LevelFault> level_faults(const Scene& scene, const LevelOptions& options, const WorkBudget& budget) {
  return LevelJudge(scene, options, budget).run();
}

}  // namespace standin
