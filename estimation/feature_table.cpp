#include "estimation/feature_table.h"

#include <algorithm>
#include <cmath>

#include "render/base/error.h"

namespace standin {
namespace {

constexpr std::uint32_t kSamplesPerMesh = 64;
constexpr std::array<Term, kPixelKindCount> kPixelTerm = {Term::kPlainPixels, Term::kTexturedPixels, Term::kMaskedPixels};

/// The matrix that takes vector areas where `m` takes points.
Mat3 cofactor(const Mat3& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

struct MeshInEye {
  MeshInEye(const Mat3& eye_from_mesh_, const Vec3& origin_, double winding_)
      : eye_from_mesh(eye_from_mesh_), eye_area_from_mesh(winding_ * cofactor(eye_from_mesh_)), origin(origin_) {}
  Mat3 eye_from_mesh;
  Mat3 eye_area_from_mesh;  // keeps front sides front under a mirroring transform, as the renderer does
  Vec3 origin;              // of mesh space, in eye space

  [[nodiscard]] double pixels(const SurfacePatch& patch, const Vec3& eye_point, const Projection& projection, bool double_sided) const {
    const Vec3 vector_area_m2 = eye_area_from_mesh * patch.vector_area_m2;
    if (!double_sided && !(glm::dot(vector_area_m2, eye_point) < 0.0)) return 0.0;
    return projection.pixels(eye_point, vector_area_m2);
  }
};

struct PartOnScreen {
  double pixels = 0.0;
  double triangles = 0.0;
  double covering_triangles = 0.0;
};

PartOnScreen part_on_screen(const SurfaceSamples& samples, bool near, const MeshInEye& mesh, const Projection& projection,
                            bool double_sided) {
  PartOnScreen seen;
  for (const SurfacePatch& patch : near ? samples.near_patches : samples.patches) {
    const Vec3 point = mesh.eye_from_mesh * patch.point + mesh.origin;
    if (projection.sees(point)) seen.pixels += mesh.pixels(patch, point, projection, double_sided);
  }
  for (const SurfacePatch& triangle : samples.triangles) {
    const Vec3 point = mesh.eye_from_mesh * triangle.point + mesh.origin;
    if (!projection.sees(point)) continue;
    seen.triangles += samples.triangles_per_sample;
    seen.covering_triangles += samples.triangles_per_sample * std::min(1.0, mesh.pixels(triangle, point, projection, double_sided));
  }
  return seen;
}

/// A mesh where it stands in the world, seen from a box of eyes.
struct MeshFromBox {
  MeshFromBox(const Mat4& world_from_mesh_, const ProjectionFromBox& projection_)
      : world_from_mesh(world_from_mesh_),
        world_area_from_mesh((glm::determinant(world_from_mesh) < 0.0 ? -1.0 : 1.0) * cofactor(world_from_mesh)),
        origin(world_from_mesh_[3]),
        projection(projection_) {}
  Mat3 world_from_mesh;
  Mat3 world_area_from_mesh;
  Vec3 origin;
  const ProjectionFromBox& projection;

  [[nodiscard]] double most_pixels(const SurfacePatch& patch, bool double_sided) const {
    return projection.most_pixels(world_from_mesh * patch.point + origin, world_area_from_mesh * patch.vector_area_m2, double_sided);
  }
  [[nodiscard]] double most_pixels(const std::vector<SurfacePatch>& patches, bool double_sided) const {
    double sum = 0.0;
    for (const SurfacePatch& patch : patches) sum += most_pixels(patch, double_sided);
    return sum;
  }
  [[nodiscard]] double most_covering_triangles(const SurfaceSamples& samples, bool double_sided) const {
    double sum = 0.0;
    for (const SurfacePatch& triangle : samples.triangles) sum += std::min(1.0, most_pixels(triangle, double_sided));
    return samples.triangles_per_sample * sum;
  }
};

}  // namespace

PixelKind pixel_kind(const Scene& scene, const Part& part) {
  const Material& material = scene.materials[part.material];
  if (material.texture < 0 || scene.meshes[part.mesh].uvs.empty()) return PixelKind::kPlain;
  return material.alpha_mode == AlphaMode::kMask ? PixelKind::kMasked : PixelKind::kTextured;
}

FeatureTable::FeatureTable(const Scene& scene, const Camera& camera)
    : scene_(&scene), camera_(camera), screen_pixels_(static_cast<double>(camera.width) * camera.height) {
  samples_.reserve(scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) samples_.push_back(sample_surface(mesh, kSamplesPerMesh));
  shapes_.reserve(scene.objects.size());
  for (const Object& object : scene.objects) shapes_.push_back(shape_of(object));
}

FeatureTable::ObjectShape FeatureTable::shape_of(const Object& object) const {
  ObjectShape shape;
  shape.radius_m = 0.5 * object.bounds.diagonal();
  for (std::uint32_t p = object.first_part; p < object.first_part + object.part_count; ++p) {
    const Part& part = scene_->parts[p];
    shape.counts[Term::kDraws] += 1.0;
    shape.counts[Term::kTextureSwitches] += pixel_kind(*scene_, part) == PixelKind::kPlain ? 0.0 : 1.0;
    shape.counts[Term::kTriangles] += static_cast<double>(scene_->meshes[part.mesh].triangle_count());
  }
  return shape;
}

Features FeatureTable::estimate(std::uint32_t object, const PreparedView& view) const {
  const Object& drawn = scene_->objects[object];
  if (!may_intersect(view.frustum, drawn.bounds)) return {};
  const Mat3 world_from_mesh(drawn.world_from_object);
  const MeshInEye mesh{view.eye_from_world * world_from_mesh, view.eye_from_world * (Vec3(drawn.world_from_object[3]) - view.position),
                       glm::determinant(world_from_mesh) < 0.0 ? -1.0 : 1.0};
  const bool near = distance(view.position, drawn.bounds) < shapes_[object].radius_m;
  Features features = shapes_[object].counts;
  for (std::uint32_t p = drawn.first_part; p < drawn.first_part + drawn.part_count; ++p) {
    const Part& part = scene_->parts[p];
    const PartOnScreen seen =
        part_on_screen(samples_[part.mesh], near, mesh, Projection(camera_), scene_->materials[part.material].double_sided);
    features[kPixelTerm[static_cast<std::size_t>(pixel_kind(*scene_, part))]] += seen.pixels;
    features[Term::kOnScreenTriangles] += seen.triangles;
    features[Term::kCoveringTriangles] += seen.covering_triangles;
  }
  for (const Term term : kPixelTerm) features[term] = std::min(features[term], kMaxScreensPerObject * screen_pixels_);
  return features;
}

Features FeatureTable::bound(std::uint32_t object, const Box& eyes) const {
  if (eyes.empty()) throw Failure(ErrorWord::kInternal, "features of object " + std::to_string(object) + ": no eyes");
  const Object& drawn = scene_->objects[object];
  const ProjectionFromBox projection(camera_, eyes);
  const MeshFromBox mesh(drawn.world_from_object, projection);
  const bool maybe_near = distance(eyes, drawn.bounds) < shapes_[object].radius_m;
  Features features = shapes_[object].counts;
  for (std::uint32_t p = drawn.first_part; p < drawn.first_part + drawn.part_count; ++p) {
    const Part& part = scene_->parts[p];
    const SurfaceSamples& samples = samples_[part.mesh];
    const bool double_sided = scene_->materials[part.material].double_sided;
    const double far_pixels = mesh.most_pixels(samples.patches, double_sided);
    const double near_pixels = maybe_near ? mesh.most_pixels(samples.near_patches, double_sided) : 0.0;
    features[kPixelTerm[static_cast<std::size_t>(pixel_kind(*scene_, part))]] += std::max(far_pixels, near_pixels);
    features[Term::kCoveringTriangles] += mesh.most_covering_triangles(samples, double_sided);
  }
  for (const Term term : kPixelTerm) features[term] = std::min(features[term], kMaxScreensPerObject * screen_pixels_);
  features[Term::kOnScreenTriangles] = features[Term::kTriangles];
  features[Term::kCoveringTriangles] = std::min(features[Term::kCoveringTriangles], features[Term::kTriangles]);
  return features;
}

Features FeatureTable::frame(std::span<const std::uint32_t> objects, const View& view) const {
  const PreparedView prepared(view, camera_);
  Features sum = frame_features();
  for (const std::uint32_t object : objects) sum += estimate(object, prepared);
  return sum;
}

}  // namespace standin
