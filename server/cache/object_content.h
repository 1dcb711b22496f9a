// What objects are, by content: fingerprints that an edit elsewhere in the scene does not change.
//
// Objects, meshes and materials have numbers, and an object that is inserted shifts the numbers of all that follow. So a result is named by
// what the objects that it looked at hold, as far as that stage looks: a ray sees triangles and masks, a time bound no colours, a bake
// everything. One fingerprint per object each, and of meshes alone one that goes with them; names of objects and meshes are in none.
#pragma once

#include <span>
#include <vector>

#include "render/base/fingerprint.h"
#include "render/scene/scene.h"

namespace standin {

/// Positions, normals, texture coordinates and triangles of a mesh alone.
[[nodiscard]] Fingerprint mesh_content(const Mesh& mesh);
/// For rays (render/visibility): place, triangles, and what of them a mask lets through. No levels of detail.
[[nodiscard]] std::vector<Fingerprint> ray_contents(const Scene& scene);
/// For the features of estimation/feature_table.h: place, meshes, how parts are drawn, levels of detail. No colours.
[[nodiscard]] std::vector<Fingerprint> cost_contents(const Scene& scene);
/// For bakes (render/impostor): all that an object's own parts show. No levels of detail.
[[nodiscard]] std::vector<Fingerprint> look_contents(const Scene& scene);

/// Which of the objects' parts share a mesh, a material or a texture, and in which order these lie in the scene, by rank among those used.
/// Stages may tell apart things by number that look alike.
void add_sharing(const Scene& scene, std::span<const std::uint32_t> objects, Fingerprinter& to);

}  // namespace standin
