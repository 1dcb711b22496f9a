#include "render/impostor/sprite_contraction.h"

#include <algorithm>
#include <queue>
#include <tuple>

#include "render/impostor/sprite_error.h"

namespace standin {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;
// Of alpha, for points that are not right along the ray from the reference viewpoint: there the outline moves, or a hole opens between two.
constexpr double kOffRayShare = 0.25;
constexpr double kLeastTurn = 0.2;  // cosine between a triangle's normals before and after

struct JudgedPoint {
  Vec3 place{0.0};
  double surely_within_m = 0.0;  // nothing this near appears alpha away from it to anyone
};

Vec3 vector_area(const std::array<Vec3, 3>& t) {
  return glm::cross(t[1] - t[0], t[2] - t[0]);
}

class Contraction {
 public:
  Contraction(const SpriteMesh& mesh, std::span<const Vec3> points, std::span<const Vec3> viewpoints, double alpha_rad)
      : mesh_(mesh),
        viewpoints_(viewpoints),
        alpha_rad_(alpha_rad),
        alive_(mesh.triangles.size(), 1),
        of_vertex_(mesh.vertices.size()),
        points_of_(mesh.triangles.size()) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      for (const std::uint32_t v : mesh.triangles[t]) of_vertex_[v].push_back(t);
    const TriangleTree tree(corners_of(mesh));
    for (const Vec3& point : points) {
      double nearest_m = std::numeric_limits<double>::infinity();
      for (const Vec3& viewpoint : viewpoints) nearest_m = std::min(nearest_m, glm::length(point - viewpoint));
      const auto own = tree.nearest(point, std::numeric_limits<double>::infinity());
      points_of_[own->triangle].push_back(static_cast<std::uint32_t>(points_.size()));
      points_.push_back({point, 0.99 * std::sin(std::min(alpha_rad, 1.5)) * nearest_m});
    }
  }

  void run(const WorkBudget& budget) {
    for (std::uint32_t v = 0; v < of_vertex_.size(); ++v) push_edges_of(v);
    for (std::uint32_t step = 0; !queue_.empty(); ++step) {
      if (step % 4096 == 0) budget.check();
      const auto [length2, a, b] = queue_.top();
      queue_.pop();
      if (of_vertex_[a].empty() || of_vertex_[b].empty() || !joined(a, b)) continue;
      if (!contract(a, b)) contract(b, a);
    }
  }

  /// Takes loose parts away that others stand for as well, the smallest first.
  void absorb_parts(const WorkBudget& budget) {
    const std::vector<std::uint32_t> part_of = parts();
    std::vector<std::vector<std::uint32_t>> members(mesh_.triangles.size());
    for (std::uint32_t t = 0; t < part_of.size(); ++t)
      if (alive_[t] != 0) members[part_of[t]].push_back(t);
    std::stable_sort(members.begin(), members.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    const TriangleTree tree(corners_of(mesh_));
    for (const auto& part : members) {
      budget.check();
      if (!part.empty() && find_places_elsewhere(part, part_of, tree)) carry_over(part);
    }
  }

  [[nodiscard]] SpriteMesh take() const {
    SpriteMesh result;
    std::vector<std::uint32_t> place(mesh_.vertices.size(), 0);  // + 1
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (alive_[t] == 0) continue;
      TriangleCorners triangle = mesh_.triangles[t];
      for (std::uint32_t& corner : triangle) {
        if (place[corner] == 0) {
          result.vertices.push_back(mesh_.vertices[corner]);
          place[corner] = static_cast<std::uint32_t>(result.vertices.size());
        }
        corner = place[corner] - 1;
      }
      result.triangles.push_back(triangle);
    }
    return result;
  }

 private:
  using Edge = std::tuple<double, std::uint32_t, std::uint32_t>;  // squared length, lower id, higher id
  struct NewTriangle {
    std::uint32_t triangle = 0;
    std::array<Vec3, 3> corners{Vec3(0.0), Vec3(0.0), Vec3(0.0)};
  };

  /// The lowest triangle that each one hangs together with.
  [[nodiscard]] std::vector<std::uint32_t> parts() const {
    std::vector<std::uint32_t> part_of(mesh_.triangles.size(), kNone), open;
    for (std::uint32_t seed = 0; seed < part_of.size(); ++seed) {
      if (alive_[seed] == 0 || part_of[seed] != kNone) continue;
      part_of[seed] = seed;
      for (open = {seed}; !open.empty();) {
        const std::uint32_t t = open.back();
        open.pop_back();
        for (const std::uint32_t v : mesh_.triangles[t])
          for (const std::uint32_t next : of_vertex_[v])
            if (part_of[next] == kNone) {
              part_of[next] = seed;
              open.push_back(next);
            }
      }
    }
    return part_of;
  }

  /// A triangle of another part for each point that this one shows.
  bool find_places_elsewhere(const std::vector<std::uint32_t>& part, const std::vector<std::uint32_t>& part_of, const TriangleTree& tree) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const auto penalty = [&](std::uint32_t t) { return alive_[t] == 0 || part_of[t] == part_of[part.front()] ? kNever : 0.0; };
    moved_.clear();
    for (const std::uint32_t t : part)
      for (const std::uint32_t point : points_of_[t]) {
        const JudgedPoint& judged = points_[point];
        const auto nearest = tree.nearest(judged.place, 2.0 * judged.surely_within_m, penalty);
        if (!nearest || !appears_within(viewpoints_, judged.place, nearest->point, kOffRayShare * alpha_rad_)) return false;
        moved_.emplace_back(point, nearest->triangle);
      }
    return true;
  }

  void carry_over(const std::vector<std::uint32_t>& part) {
    for (const std::uint32_t t : part) {
      remove(t, kNone);
      points_of_[t].clear();
    }
    for (const auto& [point, triangle] : moved_) points_of_[triangle].push_back(point);
  }

  void push_edges_of(std::uint32_t v) {
    for (const std::uint32_t t : of_vertex_[v])
      for (const std::uint32_t other : mesh_.triangles[t])
        if (other != v) {
          const Vec3 way = mesh_.vertices[other] - mesh_.vertices[v];
          queue_.push({glm::dot(way, way), std::min(v, other), std::max(v, other)});
        }
  }

  [[nodiscard]] bool has(std::uint32_t t, std::uint32_t v) const {
    return std::find(mesh_.triangles[t].begin(), mesh_.triangles[t].end(), v) != mesh_.triangles[t].end();
  }
  [[nodiscard]] bool joined(std::uint32_t a, std::uint32_t b) const {
    return std::any_of(of_vertex_[a].begin(), of_vertex_[a].end(), [&](std::uint32_t t) { return has(t, b); });
  }
  [[nodiscard]] std::array<Vec3, 3> corners(std::uint32_t t) const {
    const TriangleCorners& c = mesh_.triangles[t];
    return {mesh_.vertices[c[0]], mesh_.vertices[c[1]], mesh_.vertices[c[2]]};
  }

  /// Takes `removed` into `kept` if that may be.
  bool contract(std::uint32_t removed, std::uint32_t kept) {
    ring_.clear();
    for (const std::uint32_t t : of_vertex_[removed]) {
      if (has(t, kept)) continue;
      NewTriangle changed{t, corners(t)};
      const Vec3 before = vector_area(changed.corners);
      for (std::size_t k = 0; k < 3; ++k)
        if (mesh_.triangles[t][k] == removed) changed.corners[k] = mesh_.vertices[kept];
      const Vec3 after = vector_area(changed.corners);
      if (!(glm::dot(before, after) > kLeastTurn * glm::length(before) * glm::length(after))) return false;
      ring_.push_back(changed);
    }
    for (const std::uint32_t t : of_vertex_[kept])
      if (!has(t, removed)) ring_.push_back({t, corners(t)});
    if (ring_.empty() || !find_new_places(removed)) return false;
    carry_out(removed, kept);
    return true;
  }

  /// A triangle of the ring for each point that the end's triangles show.
  bool find_new_places(std::uint32_t removed) {
    moved_.clear();
    for (const std::uint32_t t : of_vertex_[removed])
      for (const std::uint32_t point : points_of_[t]) {
        const auto place = place_of(points_[point]);
        if (!place) return false;
        moved_.emplace_back(point, *place);
      }
    return true;
  }

  [[nodiscard]] std::optional<std::uint32_t> place_of(const JudgedPoint& point) const {
    double least = std::numeric_limits<double>::infinity();
    const NewTriangle* nearest = nullptr;
    for (const NewTriangle& candidate : ring_) {
      const Vec3 at = point_at(candidate.corners, nearest_barycentric(candidate.corners, point.place));
      const double distance = glm::length(at - point.place);
      if (distance < kOffRayShare * point.surely_within_m) return candidate.triangle;
      if (distance < least && appears_within(viewpoints_, point.place, at, kOffRayShare * alpha_rad_)) {
        least = distance;
        nearest = &candidate;
      }
    }
    if (nearest != nullptr) return nearest->triangle;
    for (const NewTriangle& candidate : ring_)
      if (const auto share = ray_meets(candidate.corners, point.place);
          share && appears_within(viewpoints_, point.place, *share * point.place, alpha_rad_))
        return candidate.triangle;
    return std::nullopt;
  }

  void carry_out(std::uint32_t removed, std::uint32_t kept) {
    for (const std::uint32_t t : of_vertex_[removed]) {
      points_of_[t].clear();
      if (has(t, kept)) {
        remove(t, removed);
        continue;
      }
      std::replace(mesh_.triangles[t].begin(), mesh_.triangles[t].end(), removed, kept);
      of_vertex_[kept].push_back(t);
    }
    of_vertex_[removed].clear();
    for (const auto& [point, triangle] : moved_) points_of_[triangle].push_back(point);
    drop_doubles(kept);
    push_edges_of(kept);
  }

  /// From all lists but that of `but`.
  void remove(std::uint32_t t, std::uint32_t but) {
    alive_[t] = 0;
    for (const std::uint32_t v : mesh_.triangles[t])
      if (v != but) std::erase(of_vertex_[v], t);
  }

  /// Of triangles with the same corners one is enough, if they face the same way.
  void drop_doubles(std::uint32_t kept) {
    const std::vector<std::uint32_t> triangles = of_vertex_[kept];
    for (std::size_t i = 0; i < triangles.size(); ++i)
      for (std::size_t j = i + 1; j < triangles.size() && alive_[triangles[i]] != 0; ++j) {
        if (alive_[triangles[j]] == 0 || !same_corners(triangles[i], triangles[j])) continue;
        auto& points = points_of_[triangles[i]];
        points.insert(points.end(), points_of_[triangles[j]].begin(), points_of_[triangles[j]].end());
        points_of_[triangles[j]].clear();
        remove(triangles[j], kNone);
      }
  }

  [[nodiscard]] bool same_corners(std::uint32_t s, std::uint32_t t) const {
    return std::all_of(mesh_.triangles[s].begin(), mesh_.triangles[s].end(), [&](std::uint32_t v) { return has(t, v); });
  }

  SpriteMesh mesh_;
  std::span<const Vec3> viewpoints_;
  double alpha_rad_;
  std::vector<std::uint8_t> alive_;                    // triangles
  std::vector<std::vector<std::uint32_t>> of_vertex_;  // live triangles
  std::vector<std::vector<std::uint32_t>> points_of_;  // of a triangle
  std::vector<JudgedPoint> points_;
  std::priority_queue<Edge, std::vector<Edge>, std::greater<>> queue_;
  // The contraction at hand:
  std::vector<NewTriangle> ring_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> moved_;  // point, triangle
};

}  // namespace

SpriteMesh contracted(const SpriteMesh& mesh, std::span<const Vec3> points, std::span<const Vec3> viewpoints, double alpha_rad,
                      const WorkBudget& budget) {
  if (mesh.triangles.empty()) return mesh;
  Contraction contraction(mesh, points, viewpoints, alpha_rad);
  contraction.absorb_parts(budget);
  contraction.run(budget);
  contraction.absorb_parts(budget);
  return contraction.take();
}

}  // namespace standin
