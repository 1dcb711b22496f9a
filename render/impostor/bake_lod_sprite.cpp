#include "render/impostor/bake_lod_sprite.h"

#include <cmath>

#include "render/impostor/chart_texels.h"
#include "render/impostor/recorder.h"
#include "render/impostor/recording.h"
#include "render/impostor/slab_piece.h"
#include "render/impostor/sprite_colours.h"
#include "render/impostor/sprite_mesh.h"
#include "render/impostor/sprite_palette.h"
#include "render/impostor/visible_surface.h"

namespace standin {
namespace {

constexpr std::uint32_t kMaxChartSide = 2048;

/// The whole depth range as one layer: an ordinary image with depths.
Layer one_layer(const std::vector<Layer>& layers) {
  return {layers.front().distance_m, layers.front().near_m, layers.back().far_m};
}

/// Charts are laid out on the lattice of depth meshes. Its third axis is logarithmic in depth here, so that one step is about a texel of
/// the image in all three directions, at any depth.
SimplifiedDepthMesh on_lattice(const SpriteMesh& mesh, const ImpostorFrame& frame, double near_m) {
  const auto half_steps = [](double texels) { return static_cast<std::int32_t>(std::lround(2.0 * texels)); };
  SimplifiedDepthMesh result;
  result.triangles = mesh.triangles;
  for (const Vec3& offset : mesh.vertices) {
    const double depth = glm::dot(offset, frame.forward);
    const Vec2 texel = texel_from_slope(frame, Vec2(glm::dot(offset, frame.right), glm::dot(offset, frame.up)) / depth) - 0.25;
    result.vertices.push_back({half_steps(texel.x), half_steps(texel.y), half_steps(std::log(depth / near_m) / frame.slope_step.x)});
  }
  return result;
}

/// Least distance of the surface from the view cell's corners.
double nearest_m(const std::vector<SurfaceTriangle>& surface, std::span<const Vec3> viewpoints, const Vec3& forward) {
  double border = -std::numeric_limits<double>::infinity(), nearest = std::numeric_limits<double>::infinity();
  for (const Vec3& viewpoint : viewpoints) border = std::max(border, glm::dot(viewpoint, forward));
  for (const SurfaceTriangle& triangle : surface)
    for (const Vec3& corner : triangle.corners) nearest = std::min(nearest, glm::dot(corner, forward) - border);
  return nearest;
}

/// The triangles that have no colour of their own in the palette.
SpriteMesh charted(const SpriteMesh& mesh, std::span<const PlainColour> plain) {
  SpriteMesh rest{mesh.vertices, {}};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (!plain[t]) rest.triangles.push_back(mesh.triangles[t]);
  return rest;
}

void texture(const SpriteMesh& mesh, const ImpostorFrame& frame, double near_m, const SampleColour& colour, const WorkBudget& budget,
             Impostor& impostor) {
  const std::vector<PlainColour> plain = plain_colours(mesh, on_lattice(mesh, frame, near_m), colour, budget);
  append_palette(mesh, plain, impostor.mesh, impostor.texels);
  for (const ChartDraft& draft : charts_of(on_lattice(charted(mesh, plain), frame, near_m), 1.0, kMaxChartSide)) {
    budget.check();
    append_chart(draft, mesh.vertices, colour, impostor.mesh, impostor.texels);
  }
}

}  // namespace

Impostor bake_lod_sprite(const Scene& scene, const TexturePyramids& textures, const BakeRequest& request, const Camera& camera,
                         const BakeQuality& quality, const WorkBudget& budget) {
  const ImpostorPlan plan = plan_request(scene, request, camera, quality);
  const ImpostorFrame& frame = plan.frame;
  Impostor impostor{request.objects, request.view_cell, frame, plan.layers, {}, {}, {}, Technique::kLodSprite};
  const std::vector<SurfaceTriangle> surface =
      visible_surface(scene, cluster_surface(scene, request, frame.reference_viewpoint), request.view_cell, frame, budget);
  std::vector<Vec3> viewpoints = corner_viewpoints(request.view_cell, frame.reference_viewpoint);
  viewpoints.emplace_back(0.0);
  const double alpha_rad = quality.alpha_scale * camera.pixel_angle_rad();
  const SpriteMesh mesh = sprite_mesh(surface, frame.forward, viewpoints, alpha_rad, nearest_m(surface, viewpoints, frame.forward), budget);

  const Layer layer = one_layer(plan.layers);
  const auto images = record_layers(scene, textures, request.objects, frame, {&layer, 1}, Coverage::kClosed, budget);
  const SpriteColours colours(scene, textures, surface, frame, images.front(), layer, viewpoints, alpha_rad);
  const SampleColour colour = [&](const SurfaceSample& sample) { return colours.at(sample.offset, sample.normal); };
  texture(mesh, frame, layer.near_m, colour, budget, impostor);
  return impostor;
}

}  // namespace standin
