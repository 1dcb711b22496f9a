// Edge contraction that asks the error criterion of LOD-sprite (sprite_error.h) at every step, point by point.
//
// Each original point belongs to a triangle that shows it within alpha along the ray from the reference viewpoint, or within a quarter of
// that beside the ray, where outlines shrink and holes open between neighbours. An edge's end goes into the other if all points of its
// triangles find such a triangle among the new ones and no triangle turns over; shortest edges first, ties by the ends' ids. So the
// criterion holds in the end wherever it held at first, and where the surface is plain it is spent to the full. Edges of any number of
// triangles are contracted alike: models are full of parts that run through each other. Loose parts are taken away, before and after, whose
// every point another part shows as near (window frames on a far wall).
#pragma once

#include <span>

#include "render/base/work.h"
#include "render/impostor/sprite_mesh.h"

namespace standin {

[[nodiscard]] SpriteMesh contracted(const SpriteMesh& mesh, std::span<const Vec3> points, std::span<const Vec3> viewpoints,
                                    double alpha_rad, const WorkBudget& budget = {});

}  // namespace standin
