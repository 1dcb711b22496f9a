// Simpler forms of a mesh, each with a proven bound on how far it lies from the original (thesis 5.5.1 and 5.2.3 use geometric levels of
// detail beside impostors, and take them as given).
//
// meshoptimizer collapses edges; what it returns is measured anew (textured_surface.h), both ways and with the texture's slip: levels
// differ from the original by no more than their error in any point, and none is given whose error has no bound. Triangles are over the
// mesh's own vertices. Vertices are joined where place and texture coordinates agree, so that flat shading, which gives each triangle
// vertices of its own, does not keep a mesh from being simplified; a corner then takes, of the normals at its place, the one nearest to its
// triangle's.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "render/base/work.h"
#include "render/scene/scene.h"

namespace standin {

struct SimplifiedMesh {
  Mesh mesh;
  double error_m = 0.0;        // mesh space: no point of either surface is farther from the other
  double error_found_m = 0.0;  // some point is as far
  std::uint64_t pieces = 0;    // of surface that the bound took
};

struct SimplifyOptions {
  bool textured = true;                // some part wears the mesh with a texture: its coordinates count
  bool lock_border = false;            // open edges stay as they are: where another mesh goes on, no crack opens
  bool measure = true;                 // false: meshoptimizer's own estimate instead of a bound, a fifth of the time
  double least_saving = 0.2;           // of the triangles of the next finer form; less is not worth a level
  double pieces_per_triangle = 20.0;   // work for the bound, at most
  const WorkBudget* budget = nullptr;  // asked now and then, where there is one
};

/// Triangles over a mesh's own vertices: three `corners` each, of which each may be any of `members[corner]`, all at one place.
[[nodiscard]] Mesh mesh_over(const Mesh& mesh, const std::vector<std::vector<std::uint32_t>>& members,
                             const std::vector<std::uint32_t>& corners);

/// The vertices `source` of a mesh (numbers below that of its positions), with three `indices` into them for each triangle; derived values
/// are up to date.
[[nodiscard]] Mesh mesh_of_vertices(const Mesh& mesh, std::vector<std::uint32_t> source, std::vector<std::uint32_t> indices);

/// False for a mesh of so few triangles that simplified() gives no form of it.
[[nodiscard]] bool may_be_simplified(const Mesh& mesh);

/// From fine to coarse, ever fewer triangles and ever greater errors; none for a mesh of few triangles. Derived values are up to date.
[[nodiscard]] std::vector<SimplifiedMesh> simplified(const Mesh& mesh, const SimplifyOptions& options);

/// simplified(), or what knows its results.
using Simplify = std::function<std::vector<SimplifiedMesh>(const Mesh& mesh, const SimplifyOptions& options)>;

}  // namespace standin
