#include "render/scene/object_levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "render/base/parallel.h"
#include "render/scene/import.h"
#include "render/scene/simplify_mesh.h"
#include "render/scene/surface_deviation.h"

namespace standin {
namespace {

// A level of an object must save this share of the next finer one's triangles.
constexpr double kLeastSaving = 0.2;
// Accuracy of the error of levels whose author says nothing about it.
constexpr std::uint64_t kAuthoredPieces = 200;  // per triangle
constexpr double kAuthoredSlack = 1e-4;         // of the object's diagonal

using Range = std::pair<std::uint32_t, std::uint32_t>;

std::uint64_t place_key(const glm::vec3& p) {
  std::array<std::uint32_t, 3> bits{};
  const glm::vec3 positive = p + 0.0F;  // -0 is 0
  std::memcpy(bits.data(), &positive, sizeof(bits));
  std::uint64_t key = 0xcbf29ce484222325U;
  for (const std::uint32_t b : bits) key = (key ^ b) * 0x100000001b3U + (key >> 29);
  return key;
}

/// Places that more than one mesh has a vertex at, sorted.
std::vector<std::uint64_t> shared_places(const Scene& scene, const std::vector<std::uint32_t>& meshes) {
  std::vector<std::uint64_t> all;
  for (const std::uint32_t m : meshes) {
    std::vector<std::uint64_t> places;
    for (const glm::vec3& position : scene.meshes[m].positions) places.push_back(place_key(position));
    std::ranges::sort(places);
    places.erase(std::unique(places.begin(), places.end()), places.end());
    all.insert(all.end(), places.begin(), places.end());
  }
  std::ranges::sort(all);
  std::vector<std::uint64_t> shared;
  for (std::size_t i = 1; i < all.size(); ++i)
    if (all[i] == all[i - 1] && (shared.empty() || shared.back() != all[i])) shared.push_back(all[i]);
  return shared;
}

/// Whether an open edge of the mesh ends at a place of another: parts of one object, or pieces of a split one, that meet there.
bool meets_another(const Mesh& mesh, const std::vector<std::uint64_t>& shared) {
  std::vector<std::uint64_t> place(mesh.positions.size());
  for (std::size_t v = 0; v < place.size(); ++v) place[v] = place_key(mesh.positions[v]);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> edges;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto [a, b] = std::minmax(place[mesh.indices[i + c]], place[mesh.indices[i + (c + 1) % 3]]);
      edges.emplace_back(a, b);
    }
  std::ranges::sort(edges);
  const auto is_shared = [&](std::uint64_t p) { return std::ranges::binary_search(shared, p); };
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i;
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if (end == i + 1 && (is_shared(edges[i].first) || is_shared(edges[i].second))) return true;
    i = end;
  }
  return false;
}

/// The most by which a transform stretches any direction.
double greatest_stretch(const Mat4& transform) {
  const Mat3 m(transform);
  const Mat3 gram = glm::transpose(m) * m;
  double uniform = 0.0, off = 0.0;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) (c == r ? uniform : off) = std::max(c == r ? uniform : off, std::abs(gram[c][r]));
  // Gershgorin: no eigenvalue is farther from the diagonal than the row's other entries add up to.
  return std::sqrt(uniform + 2.0 * off);
}

/// A mesh's simpler forms, as meshes of the scene.
struct MeshLevel {
  std::uint32_t mesh = 0;
  double error_m = 0.0;
};

/// A level of a range of parts, in mesh space.
struct RangeLevel {
  std::uint32_t first_part = 0;
  std::uint64_t triangle_count = 0;
  double error_m = 0.0;
};

class LevelMaker {
 public:
  LevelMaker(Scene& scene, const LevelOptions& options, const WorkBudget& budget) : scene_(scene), options_(options), budget_(budget) {}

  LevelSummary run() {
    simplify_meshes();
    std::map<Range, std::vector<RangeLevel>> of_range;
    for (Object& object : scene_.objects) {
      if (!object.levels.empty()) {
        take_authored(object);
        continue;
      }
      const Range range{object.first_part, object.part_count};
      const auto [known, fresh] = of_range.try_emplace(range);
      if (fresh) known->second = levels_of(range);
      take(known->second, object);
    }
    for (const Object& object : scene_.objects) summary_.objects += object.levels.empty() ? 0 : 1;
    return summary_;
  }

 private:
  void simplify_meshes() {
    std::set<std::uint32_t> used;
    for (const Object& object : scene_.objects)
      for (std::uint32_t p = 0; object.levels.empty() && p < object.part_count; ++p) used.insert(scene_.parts[object.first_part + p].mesh);
    const std::vector<std::uint32_t> meshes(used.begin(), used.end());
    const std::vector<std::uint64_t> shared = shared_places(scene_, meshes);
    std::vector<std::vector<SimplifiedMesh>> simple(meshes.size());
    parallel_for(meshes.size(), options_.threads, budget_, [&](std::size_t i) {
      SimplifyOptions options;
      options.measure = options_.measure;
      options.lock_border = meets_another(scene_.meshes[meshes[i]], shared);
      simple[i] = simplified(scene_.meshes[meshes[i]], options);
    });
    for (std::size_t i = 0; i < meshes.size(); ++i) add_meshes(meshes[i], simple[i]);
  }

  void add_meshes(std::uint32_t mesh, std::vector<SimplifiedMesh>& simple) {
    if (!simple.empty()) ++summary_.simplified_meshes;
    for (SimplifiedMesh& one : simple) {
      summary_.pieces += one.pieces;
      mesh_levels_[mesh].push_back({static_cast<std::uint32_t>(scene_.meshes.size()), one.error_m});
      one.mesh.simplified_from = static_cast<std::int32_t>(mesh);
      scene_.meshes.push_back(std::move(one.mesh));
    }
  }

  /// For each error that some part has a form of: each part's coarsest form of no greater error.
  std::vector<RangeLevel> levels_of(const Range& range) {
    std::set<double> errors;
    for (std::uint32_t p = 0; p < range.second; ++p)
      for (const MeshLevel& level : mesh_levels_[scene_.parts[range.first + p].mesh]) errors.insert(level.error_m);
    std::vector<RangeLevel> levels;
    std::uint64_t fewest = triangles_of(range);
    for (const double error_m : errors) {
      const std::vector<Part> parts = parts_within(range, error_m);
      std::uint64_t triangles = 0;
      for (const Part& part : parts) triangles += scene_.meshes[part.mesh].triangle_count();
      if (static_cast<double>(triangles) > (1.0 - kLeastSaving) * static_cast<double>(fewest)) continue;
      fewest = triangles;
      levels.push_back({static_cast<std::uint32_t>(scene_.parts.size()), triangles, error_m});
      scene_.parts.insert(scene_.parts.end(), parts.begin(), parts.end());
    }
    return levels;
  }

  [[nodiscard]] std::vector<Part> parts_within(const Range& range, double error_m) {
    std::vector<Part> parts;
    for (std::uint32_t p = 0; p < range.second; ++p) {
      Part part = scene_.parts[range.first + p];
      for (const MeshLevel& level : mesh_levels_[scene_.parts[range.first + p].mesh])
        if (level.error_m <= error_m) part.mesh = level.mesh;
      parts.push_back(part);
    }
    return parts;
  }

  [[nodiscard]] std::uint64_t triangles_of(const Range& range) const {
    std::uint64_t sum = 0;
    for (std::uint32_t p = 0; p < range.second; ++p) sum += scene_.meshes[scene_.parts[range.first + p].mesh].triangle_count();
    return sum;
  }

  void take(const std::vector<RangeLevel>& levels, Object& object) const {
    const double stretch = greatest_stretch(object.world_from_object);
    for (const RangeLevel& level : levels) {
      const double error_m = stretch * level.error_m;
      object.levels.push_back({level.first_part, object.part_count, level.triangle_count, error_m, -1.0, error_m / options_.error_m_per_m});
    }
  }

  /// Those that are simpler than what comes before them, from where their author or their error says.
  void take_authored(Object& object) {
    std::vector<ObjectLevel> kept;
    std::uint64_t fewest = object.triangle_count;
    std::uint32_t fewest_parts = object.part_count;
    for (ObjectLevel level : object.levels) {
      level.triangle_count = triangles_of({level.first_part, level.part_count});
      if (level.triangle_count >= fewest || level.part_count > fewest_parts) continue;
      if (level.screen_coverage < 0.0) level.error_m = authored_error_m(object, level);
      level.least_distance_m = level.screen_coverage >= 0.0 ? coverage_distance_m(object, level) : level.error_m / options_.error_m_per_m;
      while (!kept.empty() && kept.back().least_distance_m >= level.least_distance_m) kept.pop_back();
      fewest = level.triangle_count;
      fewest_parts = level.part_count;
      kept.push_back(level);
    }
    object.levels = std::move(kept);
    if (!object.levels.empty()) ++summary_.authored_objects;
  }

  [[nodiscard]] double coverage_distance_m(const Object& object, const ObjectLevel& level) const {
    return 0.5 * object.bounds.diagonal() * options_.whole_image_distance / std::sqrt(std::max(level.screen_coverage, 1e-12));
  }

  /// By place alone: texture coordinates of other meshes mean something else.
  [[nodiscard]] double authored_error_m(const Object& object, const ObjectLevel& level) {
    const Surface own = surface({object.first_part, object.part_count});
    const Surface other = surface({level.first_part, level.part_count});
    const double stretch = greatest_stretch(object.world_from_object);
    DeviationLimits limits;
    limits.absolute_m = kAuthoredSlack * object.bounds.diagonal() / stretch;
    limits.pieces = kAuthoredPieces * (own.triangles.size() + other.triangles.size());
    const Deviation there = deviation(own, SurfaceTree(other), limits);
    const Deviation back = deviation(other, SurfaceTree(own), limits);
    summary_.pieces += there.pieces + back.pieces;
    return stretch * std::max(there.bound_m, back.bound_m);
  }

  [[nodiscard]] Surface surface(const Range& range) const {
    Surface all;
    for (std::uint32_t p = 0; p < range.second; ++p) {
      const Surface one = surface_of(scene_.meshes[scene_.parts[range.first + p].mesh], 0.0);
      const auto first = static_cast<std::uint32_t>(all.points.size());
      all.points.insert(all.points.end(), one.points.begin(), one.points.end());
      for (const auto& [a, b, c] : one.triangles) all.triangles.push_back({first + a, first + b, first + c});
    }
    return all;
  }

  Scene& scene_;
  const LevelOptions& options_;
  const WorkBudget& budget_;
  LevelSummary summary_;
  std::map<std::uint32_t, std::vector<MeshLevel>> mesh_levels_;
};

}  // namespace

namespace {

bool is_simplified(const Scene& scene, const ObjectLevel& level) {
  for (std::uint32_t p = level.first_part; p < level.first_part + level.part_count; ++p)
    if (scene.meshes[scene.parts[p].mesh].simplified_from >= 0) return true;
  return false;
}

}  // namespace

void remove_simplified_levels(Scene& scene) {
  std::size_t parts = scene.parts.size();
  for (Object& object : scene.objects)
    std::erase_if(object.levels, [&](const ObjectLevel& level) {
      if (!is_simplified(scene, level)) return false;
      parts = std::min<std::size_t>(parts, level.first_part);
      return true;
    });
  scene.parts.resize(parts);
  while (!scene.meshes.empty() && scene.meshes.back().simplified_from >= 0) scene.meshes.pop_back();
}

void remove_all_levels(Scene& scene) {
  remove_simplified_levels(scene);
  for (Object& object : scene.objects) object.levels.clear();
}

LevelNumbers number_levels(const Scene& scene) {
  LevelNumbers numbers;
  for (const Object& object : scene.objects)
    for (const ObjectLevel& level : object.levels)
      numbers.try_emplace({level.first_part, level.part_count}, static_cast<std::uint32_t>(numbers.size()));
  return numbers;
}

Scene scene_of_levels(const Scene& scene) {
  const LevelNumbers numbers = number_levels(scene);
  Scene result;
  result.materials = scene.materials;
  result.textures = scene.textures;
  result.objects.resize(numbers.size());
  std::map<std::uint32_t, std::uint32_t> meshes;
  for (const auto& [range, number] : numbers) {
    Object& object = result.objects[number];
    object.name = "lod_" + std::to_string(number);
    object.first_part = static_cast<std::uint32_t>(result.parts.size());
    object.part_count = range.second;
    for (std::uint32_t p = range.first; p < range.first + range.second; ++p) {
      const auto [place, fresh] = meshes.try_emplace(scene.parts[p].mesh, static_cast<std::uint32_t>(result.meshes.size()));
      if (fresh) result.meshes.emplace_back(scene.meshes[scene.parts[p].mesh]).simplified_from = -1;
      result.parts.push_back({place->second, scene.parts[p].material});
    }
  }
  prune(result);
  return result;
}

std::vector<std::uint8_t> levels_from(const Scene& scene, std::span<const std::uint32_t> objects, const Box& cell) {
  std::vector<std::uint8_t> levels;
  bool any = false;
  for (const std::uint32_t object : objects) {
    levels.push_back(static_cast<std::uint8_t>(level_from(scene.objects[object], cell)));
    any = any || levels.back() > 0;
  }
  return any ? levels : std::vector<std::uint8_t>();
}

LevelSummary add_object_levels(Scene& scene, const LevelOptions& options, const WorkBudget& budget) {
  return LevelMaker(scene, options, budget).run();
}

}  // namespace standin
