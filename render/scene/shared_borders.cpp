#include "render/scene/shared_borders.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "render/base/parallel.h"

namespace standin {
namespace {

// Vertices nearer to each other than this share of their meshes' diagonals are at the same place: floats in mesh space are no more precise.
constexpr double kSamePlace = 1e-6;

std::uint64_t mixed(std::uint64_t key, std::uint64_t value) {
  key = (key ^ value) * 0x9E3779B97F4A7C15U;
  return key ^ (key >> 32);
}

std::uint64_t place_key(const glm::vec3& p) {
  std::array<std::uint32_t, 3> bits{};
  const glm::vec3 positive = p + 0.0F;  // -0 is 0
  std::memcpy(bits.data(), &positive, sizeof(bits));
  std::uint64_t key = 1;
  for (const std::uint32_t b : bits) key = mixed(key, b);
  return key;
}

/// Vertices at the ends of edges that only one triangle has.
std::vector<bool> open_vertices(const Mesh& mesh) {
  std::vector<std::uint64_t> place(mesh.positions.size());
  for (std::size_t v = 0; v < place.size(); ++v) place[v] = place_key(mesh.positions[v]);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> edges;
  edges.reserve(mesh.indices.size());
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    for (std::size_t c = 0; c < 3; ++c) edges.push_back(std::minmax(place[mesh.indices[i + c]], place[mesh.indices[i + (c + 1) % 3]]));
  std::ranges::sort(edges);
  std::vector<std::uint64_t> open_places;
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end] == edges[i]) ++end;
    if (end == i + 1) open_places.insert(open_places.end(), {edges[i].first, edges[i].second});
  }
  std::ranges::sort(open_places);
  std::vector<bool> open(mesh.positions.size());
  for (std::size_t v = 0; v < open.size(); ++v) open[v] = std::ranges::binary_search(open_places, place[v]);
  return open;
}

/// One part of one object.
struct PlacedPart {
  const Object* object = nullptr;
  std::uint32_t mesh = 0;
  Box bounds;  // world
};

Box grown(const Box& box, double by) {
  return {box.min - Vec3(by), box.max + Vec3(by)};
}

class BorderSearch {
 public:
  BorderSearch(const Scene& scene, int threads, const WorkBudget& budget)
      : scene_(scene), budget_(budget), open_(scene.meshes.size()), has_open_(scene.meshes.size(), 0), shared_(scene.meshes.size(), false) {
    for (const Object& object : scene.objects)
      for (std::uint32_t p = 0; p < object.part_count; ++p) add(object, scene.parts[object.first_part + p].mesh);
    std::ranges::stable_sort(parts_, {}, [](const PlacedPart& part) { return part.bounds.min.x; });
    parallel_for(scene.meshes.size(), threads, budget, [&](std::size_t m) {
      open_[m] = open_vertices(scene.meshes[m]);
      has_open_[m] = std::ranges::find(open_[m], true) != open_[m].end() ? 1 : 0;
    });
  }

  std::vector<bool> run() {
    for (std::size_t a = 0; a < parts_.size(); ++a) {
      budget_.check();
      for (std::size_t b = a + 1; b < parts_.size(); ++b) {
        const double near_m = same_place_m(parts_[a], parts_[b]);
        if (parts_[b].bounds.min.x > parts_[a].bounds.max.x + most_m_) break;
        if (distance(parts_[a].bounds, parts_[b].bounds) <= near_m) look(parts_[a], parts_[b], near_m);
      }
    }
    return shared_;
  }

 private:
  void add(const Object& object, std::uint32_t mesh) {
    PlacedPart part{&object, mesh, {}};
    const Box& own = scene_.meshes[mesh].bounds;
    for (int i = 0; i < 8; ++i) part.bounds.extend(Vec3(object.world_from_object * Vec4(own.corner(i), 1.0)));
    most_m_ = std::max(most_m_, 2.0 * kSamePlace * part.bounds.diagonal());
    parts_.push_back(part);
  }

  static double same_place_m(const PlacedPart& a, const PlacedPart& b) { return kSamePlace * (a.bounds.diagonal() + b.bounds.diagonal()); }

  [[nodiscard]] bool may_be_shared(std::uint32_t mesh) const { return has_open_[mesh] != 0 && !shared_[mesh]; }

  void look(const PlacedPart& a, const PlacedPart& b, double near_m) {
    if (may_be_shared(a.mesh) && meets(a, b, near_m)) shared_[a.mesh] = true;
    if (may_be_shared(b.mesh) && meets(b, a, near_m)) shared_[b.mesh] = true;
  }

  /// Vertices that lie within `box`, in the world.
  [[nodiscard]] std::vector<Vec3> places_within(const PlacedPart& part, const Box& box, bool only_open) const {
    std::vector<Vec3> places;
    const Mesh& mesh = scene_.meshes[part.mesh];
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      if (only_open && !open_[part.mesh][v]) continue;
      const Vec3 place(part.object->world_from_object * Vec4(Vec3(mesh.positions[v]), 1.0));
      if (box.contains(place)) places.push_back(place);
    }
    return places;
  }

  /// Whether an open vertex of `part` is at the place of some vertex of `other`.
  [[nodiscard]] bool meets(const PlacedPart& part, const PlacedPart& other, double near_m) const {
    const Box box = intersection(grown(part.bounds, near_m), grown(other.bounds, near_m));
    const std::vector<Vec3> own = places_within(part, box, true);
    if (own.empty()) return false;
    const double cell_m = 4.0 * near_m;
    const auto cell_of = [&](const Vec3& place) { return glm::floor((place - box.min) / cell_m); };
    const auto key_of = [](const Vec3& cell) {
      std::uint64_t key = 1;
      for (int axis = 0; axis < 3; ++axis) key = mixed(key, static_cast<std::uint64_t>(static_cast<std::int64_t>(cell[axis])));
      return key;
    };
    std::unordered_multimap<std::uint64_t, Vec3> places;
    for (const Vec3& place : places_within(other, box, false)) places.emplace(key_of(cell_of(place)), place);
    if (places.empty()) return false;
    for (const Vec3& place : own) {
      const Vec3 first = cell_of(place - Vec3(near_m)), last = cell_of(place + Vec3(near_m));
      Vec3 cell;
      for (cell.x = first.x; cell.x <= last.x; cell.x += 1.0)
        for (cell.y = first.y; cell.y <= last.y; cell.y += 1.0)
          for (cell.z = first.z; cell.z <= last.z; cell.z += 1.0) {
            const auto [begin, end] = places.equal_range(key_of(cell));
            if (std::any_of(begin, end, [&](const auto& at) { return glm::distance(at.second, place) <= near_m; })) return true;
          }
    }
    return false;
  }

  const Scene& scene_;
  const WorkBudget& budget_;
  std::vector<PlacedPart> parts_;  // by the least x of their bounds
  std::vector<std::vector<bool>> open_;
  std::vector<char> has_open_;
  std::vector<bool> shared_;
  double most_m_ = 0.0;  // that two vertices at the same place may be apart
};

}  // namespace

std::vector<bool> borders_shared(const Scene& scene, int threads, const WorkBudget& budget) {
  return BorderSearch(scene, threads, budget).run();
}

}  // namespace standin
