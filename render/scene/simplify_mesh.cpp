#include "render/scene/simplify_mesh.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "render/scene/textured_surface.h"

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
  std::vector<std::uint32_t> indices;  // without triangles that have become flat, and those that are kept
  std::vector<std::uint32_t> kept;     // indices of triangles that every simpler form must hold as they are
};

Joined join(const Mesh& mesh, const std::vector<bool>& kept) {
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
    auto& to = kept[i / 3] ? joined.kept : joined.indices;
    if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0]) to.insert(to.end(), c.begin(), c.end());
  }
  return joined;
}

struct Collapsed {
  std::vector<std::uint32_t> indices;
  double estimated_error_m = 0.0;
};

/// Where triangles are kept, the others are simplified within their borders with these.
Collapsed collapsed(const Joined& joined, double error_m, bool lock_border) {
  const float* positions = &joined.positions[0].x;
  const float scale = meshopt_simplifyScale(positions, joined.positions.size(), sizeof(glm::vec3));
  const unsigned int options = lock_border || !joined.kept.empty() ? static_cast<unsigned int>(meshopt_SimplifyLockBorder) : 0U;
  Collapsed result{std::vector<std::uint32_t>(joined.indices.size()), 0.0};
  float relative = 0.0F;
  result.indices.resize(meshopt_simplify(result.indices.data(), joined.indices.data(), joined.indices.size(), positions,
                                         joined.positions.size(), sizeof(glm::vec3), 0, static_cast<float>(error_m) / scale, options,
                                         &relative));
  result.indices.insert(result.indices.end(), joined.kept.begin(), joined.kept.end());
  result.estimated_error_m = static_cast<double>(relative * scale);
  return result;
}

/// A coarser form with no greater error makes a finer one useless.
void drop_dominated(std::vector<SimplifiedMesh>& levels) {
  std::vector<SimplifiedMesh> kept;
  for (auto level = levels.rbegin(); level != levels.rend(); ++level)
    if (kept.empty() || level->error_m < kept.back().error_m) kept.push_back(std::move(*level));
  levels.assign(std::make_move_iterator(kept.rbegin()), std::make_move_iterator(kept.rend()));
}

void measure(const TexturedSurface& original, const SimplifyOptions& options, double absolute_m, SimplifiedMesh& level) {
  DeviationLimits limits;
  limits.absolute_m = absolute_m;
  limits.budget = options.budget;
  const Deviation off = original.deviation_of(level.mesh, limits, options.pieces_per_triangle);
  level.error_m = off.bound_m;
  level.error_found_m = off.found_m;
  level.pieces = off.pieces;
}

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
  std::vector<std::uint32_t> place(mesh.positions.size(), 0xFFFFFFFFU), source, indices;
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    const auto corner = [&](std::size_t c) { return Vec3(mesh.positions[members[corners[i + c]].front()]); };
    const Vec3 normal = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t v = best_member(mesh, members[corners[i + c]], normal);
      if (place[v] == 0xFFFFFFFFU) {
        place[v] = static_cast<std::uint32_t>(source.size());
        source.push_back(v);
      }
      indices.push_back(place[v]);
    }
  }
  return mesh_of_vertices(mesh, std::move(source), std::move(indices));
}

Mesh mesh_of_vertices(const Mesh& mesh, std::vector<std::uint32_t> source, std::vector<std::uint32_t> indices) {
  Mesh result;
  result.name = mesh.name;
  for (const std::uint32_t v : source) {
    result.positions.push_back(mesh.positions[v]);
    result.normals.push_back(mesh.normals[v]);
    if (!mesh.uvs.empty()) result.uvs.push_back(mesh.uvs[v]);
  }
  result.source = std::move(source);
  result.indices = std::move(indices);
  update_derived(result);
  return result;
}

bool may_be_simplified(const Mesh& mesh) {
  return mesh.triangle_count() >= kFewestTriangles;
}

std::vector<SimplifiedMesh> simplified(const Mesh& mesh, const SimplifyOptions& options) {
  std::vector<SimplifiedMesh> levels;
  if (!may_be_simplified(mesh)) return levels;
  const TexturedSurface original(mesh, options.textured);
  const Joined joined = join(mesh, original.kept());
  if (joined.indices.empty()) return levels;
  std::size_t fewest = mesh.triangle_count();
  for (int k = kFinest; k >= kCoarsest; --k) {
    const double aim_m = mesh.bounds.diagonal() * std::ldexp(1.0, -k);
    const Collapsed simple = collapsed(joined, aim_m, options.lock_border);
    const std::size_t triangles = simple.indices.size() / 3;
    if (triangles == 0) break;
    if (static_cast<double>(triangles) > (1.0 - options.least_saving) * static_cast<double>(fewest)) continue;
    SimplifiedMesh level{mesh_over(mesh, joined.members, simple.indices), simple.estimated_error_m, simple.estimated_error_m, 0};
    if (options.measure) measure(original, options, kSlack * aim_m, level);
    if (!std::isfinite(level.error_m)) continue;
    fewest = triangles;
    levels.push_back(std::move(level));
  }
  drop_dominated(levels);
  return levels;
}

}  // namespace standin
