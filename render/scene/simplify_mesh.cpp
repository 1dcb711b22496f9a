#include "render/scene/simplify_mesh.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "render/scene/surface_deviation.h"

namespace standin {
namespace {

// Fewer triangles than these cost hardly more than the draw call.
constexpr std::size_t kFewestTriangles = 32;
// Errors aimed at, as shares of the mesh's diagonal: halves, from 1/8 down.
constexpr int kCoarsest = 3;
constexpr int kFinest = 11;
// A level's bound need not be tighter than this share of the error aimed at.
constexpr double kSlack = 0.5;

using Corners = std::array<std::uint32_t, 3>;

/// Vertices joined where place and texture coordinates agree.
struct Joined {
  std::vector<std::uint32_t> id;                    // per vertex of the mesh
  std::vector<std::vector<std::uint32_t>> members;  // per joined vertex
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;  // without triangles that have become flat
};

Joined join(const Mesh& mesh) {
  Joined joined;
  joined.id.resize(mesh.positions.size());
  std::vector<glm::vec3> places;
  for (const glm::vec3& position : mesh.positions) places.push_back(position + 0.0F);  // bits are compared, and -0 is 0
  std::vector<meshopt_Stream> streams{{places.data(), sizeof(glm::vec3), sizeof(glm::vec3)}};
  if (!mesh.uvs.empty()) streams.push_back({mesh.uvs.data(), sizeof(glm::vec2), sizeof(glm::vec2)});
  const std::size_t count = meshopt_generateVertexRemapMulti(joined.id.data(), mesh.indices.data(), mesh.indices.size(),
                                                             mesh.positions.size(), streams.data(), streams.size());
  joined.members.resize(count);
  joined.positions.resize(count);
  for (std::uint32_t v = 0; v < joined.id.size(); ++v) {
    if (joined.id[v] >= count) continue;  // a vertex that no triangle uses
    joined.members[joined.id[v]].push_back(v);
    joined.positions[joined.id[v]] = places[v];
  }
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const Corners c{joined.id[mesh.indices[i]], joined.id[mesh.indices[i + 1]], joined.id[mesh.indices[i + 2]]};
    if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0]) joined.indices.insert(joined.indices.end(), c.begin(), c.end());
  }
  return joined;
}

struct Collapsed {
  std::vector<std::uint32_t> indices;
  double estimated_error_m = 0.0;
};

Collapsed collapsed(const Joined& joined, double error_m, bool lock_border) {
  const float* positions = &joined.positions[0].x;
  const float scale = meshopt_simplifyScale(positions, joined.positions.size(), sizeof(glm::vec3));
  const unsigned int options = lock_border ? static_cast<unsigned int>(meshopt_SimplifyLockBorder) : 0U;
  Collapsed result{std::vector<std::uint32_t>(joined.indices.size()), 0.0};
  float relative = 0.0F;
  result.indices.resize(meshopt_simplify(result.indices.data(), joined.indices.data(), joined.indices.size(), positions,
                                         joined.positions.size(), sizeof(glm::vec3), 0, static_cast<float>(error_m) / scale, options,
                                         &relative));
  result.estimated_error_m = static_cast<double>(relative * scale);
  return result;
}

Corners sorted_corners(const std::vector<std::uint32_t>& indices, std::size_t i) {
  Corners corners{indices[i], indices[i + 1], indices[i + 2]};
  std::ranges::sort(corners);
  return corners;
}

/// A joined mesh as a surface, and its distance from others.
class JoinedSurface {
 public:
  JoinedSurface(const std::vector<SurfacePoint>& points, const std::vector<std::uint32_t>& indices) {
    surface_.points = points;
    for (std::size_t i = 0; i < indices.size(); i += 3) {
      surface_.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
      known_.push_back(sorted_corners(indices, i));
    }
    std::ranges::sort(known_);
    tree_ = std::make_unique<SurfaceTree>(surface_);
  }

  /// Of this surface from `other`; triangles that both have need no look.
  [[nodiscard]] Deviation deviation_from(const JoinedSurface& other, double absolute_m, double pieces_per_triangle) const {
    Surface own{surface_.points, {}};
    for (const Corners& triangle : surface_.triangles) {
      Corners sorted = triangle;
      std::ranges::sort(sorted);
      if (!std::ranges::binary_search(other.known_, sorted)) own.triangles.push_back(triangle);
    }
    DeviationLimits limits;
    limits.absolute_m = absolute_m;
    limits.pieces = static_cast<std::uint64_t>(pieces_per_triangle * static_cast<double>(known_.size() + other.known_.size()));
    return deviation(own, *other.tree_, limits);
  }

 private:
  Surface surface_;
  std::vector<Corners> known_;  // sorted
  std::unique_ptr<SurfaceTree> tree_;
};

std::vector<SurfacePoint> points_of(const Mesh& mesh, const Joined& joined) {
  const Surface surface = surface_of(mesh, metres_per_uv(mesh));
  std::vector<SurfacePoint> points;
  for (const auto& members : joined.members) points.push_back(surface.points[members.front()]);
  return points;
}

/// A coarser form with no greater error makes a finer one useless.
void drop_dominated(std::vector<SimplifiedMesh>& levels) {
  std::vector<SimplifiedMesh> kept;
  for (auto level = levels.rbegin(); level != levels.rend(); ++level)
    if (kept.empty() || level->error_m < kept.back().error_m) kept.push_back(std::move(*level));
  levels.assign(std::make_move_iterator(kept.rbegin()), std::make_move_iterator(kept.rend()));
}

/// The original, to hold its simpler forms against.
class Original {
 public:
  explicit Original(const Mesh& mesh)
      : mesh_(mesh), joined_(join(mesh)), points_(points_of(mesh, joined_)), surface_(points_, joined_.indices) {}

  [[nodiscard]] const Joined& joined() const { return joined_; }

  [[nodiscard]] SimplifiedMesh estimated(const Collapsed& simple) const {
    return {mesh_over(mesh_, joined_.members, simple.indices), simple.estimated_error_m, simple.estimated_error_m, 0};
  }
  [[nodiscard]] SimplifiedMesh measured(const Collapsed& simple, double absolute_m, double pieces_per_triangle) const {
    const JoinedSurface surface(points_, simple.indices);
    const Deviation there = surface_.deviation_from(surface, absolute_m, pieces_per_triangle);
    const Deviation back = surface.deviation_from(surface_, absolute_m, pieces_per_triangle);
    return {mesh_over(mesh_, joined_.members, simple.indices), std::max(there.bound_m, back.bound_m), std::max(there.found_m, back.found_m),
            there.pieces + back.pieces};
  }

 private:
  const Mesh& mesh_;
  Joined joined_;
  std::vector<SurfacePoint> points_;
  JoinedSurface surface_;
};

/// Of the vertices at one place, the one whose normal is nearest to the triangle's; sides do not matter, as shading has none.
std::uint32_t best_member(const Mesh& mesh, const std::vector<std::uint32_t>& members, const Vec3& normal) {
  std::uint32_t best = members.front();
  double most = -1.0;
  for (const std::uint32_t v : members) {
    const double along = std::abs(glm::dot(Vec3(mesh.normals[v]), normal));
    if (along > most) {
      most = along;
      best = v;
    }
  }
  return best;
}

}  // namespace

Mesh mesh_over(const Mesh& mesh, const std::vector<std::vector<std::uint32_t>>& members, const std::vector<std::uint32_t>& corners) {
  Mesh result;
  result.name = mesh.name;
  std::vector<std::uint32_t> place(mesh.positions.size(), 0xFFFFFFFFU);
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const auto corner = [&](std::size_t c) { return Vec3(mesh.positions[members[corners[i + c]].front()]); };
    const Vec3 normal = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t v = best_member(mesh, members[corners[i + c]], normal);
      if (place[v] == 0xFFFFFFFFU) {
        place[v] = static_cast<std::uint32_t>(result.positions.size());
        result.positions.push_back(mesh.positions[v]);
        result.normals.push_back(mesh.normals[v]);
        if (!mesh.uvs.empty()) result.uvs.push_back(mesh.uvs[v]);
        result.source.push_back(v);
      }
      result.indices.push_back(place[v]);
    }
  }
  update_derived(result);
  return result;
}

std::vector<SimplifiedMesh> simplified(const Mesh& mesh, const SimplifyOptions& options) {
  std::vector<SimplifiedMesh> levels;
  if (mesh.triangle_count() < kFewestTriangles) return levels;
  const Original original(mesh);
  if (original.joined().indices.empty()) return levels;
  std::size_t fewest = mesh.triangle_count();
  for (int k = kFinest; k >= kCoarsest; --k) {
    const double aim_m = mesh.bounds.diagonal() * std::ldexp(1.0, -k);
    const Collapsed simple = collapsed(original.joined(), aim_m, options.lock_border);
    const std::size_t triangles = simple.indices.size() / 3;
    if (triangles == 0) break;
    if (static_cast<double>(triangles) > (1.0 - options.least_saving) * static_cast<double>(fewest)) continue;
    fewest = triangles;
    levels.push_back(options.measure ? original.measured(simple, kSlack * aim_m, options.pieces_per_triangle) : original.estimated(simple));
  }
  drop_dominated(levels);
  return levels;
}

}  // namespace standin
