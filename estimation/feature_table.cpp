#include "estimation/feature_table.h"

#include <algorithm>
#include <cmath>

#include "render/base/error.h"

namespace standin {
namespace {

constexpr std::uint32_t kSamplesPerMesh = 64;
// Bounds stand this much higher, since an estimate adds the same terms in another order and from transformed points.
constexpr double kRounding = 1e-9;

constexpr std::array<Term, kPixelKindCount> kPixelTerm = {Term::kPlainPixels, Term::kTexturedPixels, Term::kMaskedPixels};

/// The matrix that takes vector areas where `m` takes points.
Mat3 cofactor(const Mat3& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

/// Largest eigenvalue of a symmetric positive semidefinite 3x3 matrix, from above: the infinity norm of M^16 bounds the 16th power.
double largest_eigenvalue_bound(Mat3 m) {
  const double trace = m[0][0] + m[1][1] + m[2][2];
  if (!(trace > 0.0)) return 0.0;
  m /= trace;
  for (int squaring = 0; squaring < 4; ++squaring) m = m * m;
  double norm = 0.0;
  for (int row = 0; row < 3; ++row) norm = std::max(norm, std::abs(m[0][row]) + std::abs(m[1][row]) + std::abs(m[2][row]));
  return trace * std::min(1.0, std::pow(norm, 1.0 / 16.0));
}

/// Area in total and the most of it that faces any one direction: for `patches` moved by `world_area_from_mesh`.
struct PatchSum {
  double area_m2 = 0.0;
  Vec3 vector_area_m2{0.0};
  Mat3 moments{0.0};  // sum of a a^T / |a|

  void add(const Vec3& vector_area) {
    const double area = glm::length(vector_area);
    if (!(area > 0.0)) return;
    area_m2 += area;
    vector_area_m2 += vector_area;
    moments += glm::outerProduct(vector_area, vector_area / area);
  }
  /// sum |a.w| <= root; of that, back-face culling leaves sum max(a.w, 0) = (sum |a.w| + (sum a).w) / 2, half where the surface is closed.
  [[nodiscard]] double facing_m2(bool double_sided) const {
    const double both_sides_m2 = std::sqrt(area_m2 * largest_eigenvalue_bound(moments));
    return double_sided ? both_sides_m2 : 0.5 * (both_sides_m2 + glm::length(vector_area_m2));
  }
};

PatchSum patch_sum(const std::vector<SurfacePatch>& patches, const Mat3& world_area_from_mesh) {
  PatchSum sum;
  for (const SurfacePatch& patch : patches) sum.add(world_area_from_mesh * patch.vector_area_m2);
  return sum;
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

}  // namespace

PixelKind pixel_kind(const Scene& scene, const Part& part) {
  const Material& material = scene.materials[part.material];
  if (material.texture < 0 || scene.meshes[part.mesh].uvs.empty()) return PixelKind::kPlain;
  return material.alpha_mode == AlphaMode::kMask ? PixelKind::kMasked : PixelKind::kTextured;
}

FeatureTable::FeatureTable(const Scene& scene, const Camera& camera)
    : scene_(&scene),
      camera_(camera),
      screen_pixels_(static_cast<double>(camera.width) * camera.height),
      pixels_per_m2_at_1m_((1.0 + kRounding) * greatest_pixels_per_m2_at_1m(camera)) {
  samples_.reserve(scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) samples_.push_back(sample_surface(mesh, kSamplesPerMesh));
  shapes_.reserve(scene.objects.size());
  for (const Object& object : scene.objects) shapes_.push_back(shape_of(object));
}

FeatureTable::ObjectShape FeatureTable::shape_of(const Object& object) {
  ObjectShape shape;
  shape.radius_m = 0.5 * object.bounds.diagonal();
  const Vec3 size = object.bounds.size();
  shape.half_extent_m = object.bounds.empty() ? 0.0 : 0.5 * std::min({size.x, size.y, size.z});
  const Mat3 world_area_from_mesh = cofactor(Mat3(object.world_from_object));
  std::vector<std::array<double, 2>> covering;
  for (std::uint32_t p = object.first_part; p < object.first_part + object.part_count; ++p) {
    const Part& part = scene_->parts[p];
    const SurfaceSamples& samples = samples_[part.mesh];
    const PixelKind kind = pixel_kind(*scene_, part);
    shape.counts[Term::kDraws] += 1.0;
    shape.counts[Term::kTextureSwitches] += kind == PixelKind::kPlain ? 0.0 : 1.0;
    shape.counts[Term::kTriangles] += static_cast<double>(scene_->meshes[part.mesh].triangle_count());
    const PatchSum far = patch_sum(samples.patches, world_area_from_mesh);
    const PatchSum near = patch_sum(samples.near_patches, world_area_from_mesh);
    FacingArea& area = shape.area[static_cast<std::size_t>(kind)];
    const bool double_sided = scene_->materials[part.material].double_sided;
    area.total_m2 += std::max(far.area_m2, near.area_m2);
    area.facing_m2 += std::max(far.facing_m2(double_sided), near.facing_m2(double_sided));
    for (const SurfacePatch& triangle : samples.triangles)
      covering.push_back({glm::length(world_area_from_mesh * triangle.vector_area_m2), samples.triangles_per_sample});
  }
  add_covering(shape, std::move(covering));
  return shape;
}

void FeatureTable::add_covering(ObjectShape& shape, std::vector<std::array<double, 2>> areas_and_counts) {
  std::sort(areas_and_counts.begin(), areas_and_counts.end());
  shape.first_covering = covering_.size();
  double area_before_m2 = 0.0;
  for (const auto& [area_m2, count] : areas_and_counts) {
    covering_.push_back({area_m2, area_before_m2, 0.0});
    area_before_m2 += area_m2 * count;
  }
  covering_.push_back({std::numeric_limits<double>::infinity(), area_before_m2, 0.0});
  shape.last_covering = covering_.size();
  double triangles_from = 0.0;
  for (std::size_t i = areas_and_counts.size(); i-- > 0;)
    covering_[shape.first_covering + i].triangles_from = triangles_from += areas_and_counts[i][1];
}

double FeatureTable::covering_triangles(const ObjectShape& shape, double pixels_per_m2) const {
  const auto first = covering_.begin() + static_cast<std::ptrdiff_t>(shape.first_covering);
  const auto last = covering_.begin() + static_cast<std::ptrdiff_t>(shape.last_covering);
  const auto covered = std::partition_point(first, last - 1, [=](const CoveringStep& s) { return s.area_m2 * pixels_per_m2 < 1.0; });
  return covered->area_before_m2 * pixels_per_m2 + covered->triangles_from;
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

Features FeatureTable::bound(std::uint32_t object, double nearest_m) const {
  if (!(nearest_m >= 0.0)) throw Failure(ErrorWord::kInternal, "features of object " + std::to_string(object) + ": negative distance");
  const ObjectShape& shape = shapes_[object];
  Features features = shape.counts;
  const double distance_m = std::max(nearest_m, camera_.near_m);  // no pixel lies nearer than the near plane
  const double pixels_per_m2 = pixels_per_m2_at_1m_ / (distance_m * distance_m);
  // Directions to points of the bounds differ from the one to their centre by a chord of at most this length.
  const double sine = std::min(1.0, shape.radius_m / std::max(nearest_m + shape.half_extent_m, shape.radius_m));
  const double chord = std::sqrt(2.0 - 2.0 * std::sqrt(1.0 - sine * sine));
  for (std::size_t kind = 0; kind < kPixelKindCount; ++kind) {
    const FacingArea& area = shape.area[kind];
    const double facing_m2 = std::min(area.total_m2, area.facing_m2 + chord * area.total_m2);
    features[kPixelTerm[kind]] = std::min(facing_m2 * pixels_per_m2, kMaxScreensPerObject * screen_pixels_);
  }
  features[Term::kOnScreenTriangles] = features[Term::kTriangles];
  features[Term::kCoveringTriangles] = std::min(covering_triangles(shape, pixels_per_m2), features[Term::kTriangles]);
  return features;
}

Features FeatureTable::frame(std::span<const std::uint32_t> objects, const View& view) const {
  const PreparedView prepared(view, camera_);
  Features sum = frame_features();
  for (const std::uint32_t object : objects) sum += estimate(object, prepared);
  return sum;
}

}  // namespace standin
