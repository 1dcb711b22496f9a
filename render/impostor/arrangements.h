// Layered impostors without a placement: all around a view cell, or all around an object (thesis 3.8.1 and 3.8.2).
//
// The thesis compares its placement with environment maps of layers about every cell of a grid (5.9, test 15: 40 times the memory); both
// arrangements are kept as baselines for that comparison. They are lists of bake requests, nothing more: each is planned, baked, judged and
// counted as any other, and keeps the same promise.
//
// We differ from the thesis in two points. Its environment maps cut geometry at the cube's edges; here each object goes whole to the face
// it lies farthest beyond, so that no seam runs through it. Its view-independent impostors use one image for opposite directions, with
// layers equally spaced, and promise nothing; here each direction has its own shaft.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/impostor/bake.h"

namespace standin {

/// Requests for everything at least `far_field_m` away from the cell, at most six: along -x +x -y +y -z +z, those without objects left out.
/// far_field_m > 0. Objects nearer than that are in none.
[[nodiscard]] std::vector<BakeRequest> environment_map_requests(const Scene& scene, const Box& cell, double far_field_m);
/// The same for some of the objects (ascending), those that are visible from the cell.
[[nodiscard]] std::vector<BakeRequest> environment_map_requests(const Scene& scene, std::span<const std::uint32_t> objects, const Box& cell,
                                                                double far_field_m);

/// 6 * per_face_side^2 shafts about the centre of the objects' bounds, one for each patch of a cube's faces in equal angles. Every
/// viewpoint at least `distance_m` from that centre lies in one of them. per_face_side >= 1, objects ascending and at least one.
[[nodiscard]] std::vector<BakeRequest> view_independent_requests(const Scene& scene, const std::vector<std::uint32_t>& objects,
                                                                 double distance_m, std::uint32_t per_face_side);

}  // namespace standin
