#include "estimation/feature_table.h"

#include <algorithm>
#include <cmath>

#include "render/base/error.h"

namespace standin {
namespace {

constexpr std::uint32_t kSamplesPerMesh = 64;
constexpr std::array<Term, kPixelKindCount> kPixelTerm = {Term::kPlainPixels, Term::kTexturedPixels, Term::kMaskedPixels};

PartStyle style_of(const Scene& scene, const Part& part) {
  return {pixel_kind(scene, part), scene.materials[part.material].double_sided};
}

/// What samples show in one image; their pixels go into its coverage, too.
struct ImageSum {
  const Camera& camera;
  Projection projection;
  ScreenCoverage& coverage;
  PartSum sum;

  void add(const std::vector<SurfaceSample>& samples, const PlacedMesh& mesh, const PartStyle& style) {
    for (const SurfaceSample& sample : samples) {
      const Patch patch = mesh.place(sample);
      if (!style.double_sided && !(glm::dot(patch.vector_area_m2, patch.centre) < 0.0)) continue;
      for_each_small_part(patch, [&](const Patch& part) {
        if (projection.sees(part.centre)) add(part, style.kind);
      });
    }
  }

 private:
  void add(const Patch& part, PixelKind kind) {
    const double pixels = projection.pixels(part.centre, part.vector_area_m2);
    sum.triangles += part.triangles;
    sum.edge_pixels += std::min(projection.edge_pixels(part), most_edge_pixels(kind) * part.triangles);
    sum.pixels += pixels;
    const Vec2 place = Vec2(part.centre.x, -part.centre.y) * (projection.focal_px / -part.centre.z);
    coverage.add(kind, place.x + 0.5 * camera.width, place.y + 0.5 * camera.height, -part.centre.z, pixels);
  }
};

/// The most that samples may show to any eye in a box.
PartSum most_from_box(const std::vector<SurfaceSample>& samples, const PlacedMesh& mesh, const PartStyle& style,
                      const ProjectionFromBox& projection) {
  PartSum sum;
  for (const SurfaceSample& sample : samples) {
    const MostInImage most = projection.most(mesh.place(sample), style.double_sided);
    if (!most.faces) continue;
    sum.triangles += sample.triangles;
    sum.edge_pixels += std::min(most.edge_pixels(), most_edge_pixels(style.kind) * sample.triangles);
    sum.pixels += most.pixels();
  }
  return sum;
}

void add_part(PartSum most, PixelKind kind, double slenderness, double most_passed_pixels, Features& sum) {
  most.limit_edges(slenderness, most_passed_pixels);
  sum[Term::kOnScreenTriangles] += most.triangles;
  sum[Term::kEdgePixels] += most.edge_pixels;
  sum[kPixelTerm[static_cast<std::size_t>(kind)]] += most.pixels;
}

void cap_pixels(double most_passed_pixels, Features& features) {
  for (const Term term : kPixelTerm) features[term] = std::min(features[term], most_passed_pixels);
}

void add_passed(const ScreenCoverage& coverage, Features& sum) {
  const auto passed = coverage.passed();
  for (std::size_t kind = 0; kind < kPixelKindCount; ++kind) sum[kPixelTerm[kind]] += passed[kind];
}

}  // namespace

PixelKind pixel_kind(const Scene& scene, const Part& part) {
  const Material& material = scene.materials[part.material];
  if (material.texture < 0 || scene.meshes[part.mesh].uvs.empty()) return PixelKind::kPlain;
  return material.alpha_mode == AlphaMode::kMask ? PixelKind::kMasked : PixelKind::kTextured;
}

FeatureTable::FeatureTable(const Scene& scene, const Camera& camera)
    : scene_(&scene), camera_(camera), most_passed_pixels_(kOverdraw * camera.width * camera.height) {
  samples_.reserve(scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) samples_.push_back(samples_of(mesh));
  shapes_.reserve(scene.objects.size());
  for (const Object& object : scene.objects) shapes_.push_back(shape_of(object));
  for (std::size_t kind = 0; kind < kPixelKindCount; ++kind)
    if (std::any_of(scene.parts.begin(), scene.parts.end(),
                    [&](const Part& part) { return pixel_kind(scene, part) == static_cast<PixelKind>(kind); }))
      pixel_terms_.push_back(kPixelTerm[kind]);
}

// Simpler forms of a mesh follow each other in the scene, from fine to coarse.
SurfaceSamples FeatureTable::samples_of(const Mesh& mesh) const {
  if (mesh.simplified_from < 0) return sample_surface(mesh, kSamplesPerMesh);
  const std::size_t before = samples_.size() - 1;
  const bool first = scene_->meshes[before].simplified_from != mesh.simplified_from;
  return simplified_samples(samples_[first ? static_cast<std::size_t>(mesh.simplified_from) : before], mesh);
}

FeatureTable::ObjectShape FeatureTable::shape_of(const Object& object) const {
  ObjectShape shape;
  shape.radius_m = 0.5 * object.bounds.diagonal();
  for (std::uint32_t level = 0; level <= object.levels.size(); ++level) {
    const LevelParts parts = parts_of(object, level);
    Features& counts = shape.counts.emplace_back();
    counts[Term::kDraws] = parts.part_count;
    for (std::uint32_t p = parts.first_part; p < parts.first_part + parts.part_count; ++p)
      counts[Term::kTriangles] += static_cast<double>(scene_->meshes[scene_->parts[p].mesh].triangle_count());
  }
  return shape;
}

void FeatureTable::add(std::uint32_t object, std::uint32_t level, const PreparedView& view, Features& sum, ScreenCoverage& coverage) const {
  const Object& drawn = scene_->objects[object];
  if (!may_intersect(view.frustum, drawn.bounds)) return;
  sum += shapes_[object].counts[level];
  const LevelParts parts = parts_of(drawn, level);
  const PlacedMesh mesh(drawn.world_from_object, view.eye_from_world, view.position);
  const bool near = distance(view.position, drawn.bounds) < shapes_[object].radius_m;
  for (std::uint32_t p = parts.first_part; p < parts.first_part + parts.part_count; ++p) {
    const Part& part = scene_->parts[p];
    const SurfaceSamples& samples = samples_[part.mesh];
    ImageSum image{camera_, Projection(camera_), coverage, {}};
    image.add(near ? samples.near_samples : samples.samples, mesh, style_of(*scene_, part));
    image.sum.limit_edges(samples.slenderness, most_passed_pixels_);
    sum[Term::kOnScreenTriangles] += image.sum.triangles;
    sum[Term::kEdgePixels] += image.sum.edge_pixels;
  }
}

Features FeatureTable::estimate(std::uint32_t object, const PreparedView& view, std::uint32_t level) const {
  Features features;
  ScreenCoverage coverage(camera_);
  add(object, level, view, features, coverage);
  add_passed(coverage, features);
  return features;
}

const Features& FeatureTable::counts_from(std::uint32_t object, const Box& eyes) const {
  return shapes_[object].counts[level_from(scene_->objects[object], eyes)];
}

template <class Visit>
void FeatureTable::for_each_part(std::uint32_t object, const Box& eyes, Visit&& visit) const {
  if (eyes.empty()) throw Failure(ErrorWord::kInternal, "features of object " + std::to_string(object) + ": no eyes");
  const Object& drawn = scene_->objects[object];
  const PlacedMesh mesh(drawn.world_from_object, Mat3(1.0), Vec3(0.0));
  const bool maybe_near = distance(eyes, drawn.bounds) < shapes_[object].radius_m;
  const LevelParts parts = parts_of(drawn, level_from(drawn, eyes));
  for (std::uint32_t p = parts.first_part; p < parts.first_part + parts.part_count; ++p) {
    const Part& part = scene_->parts[p];
    visit(samples_[part.mesh], mesh, style_of(*scene_, part), maybe_near);
  }
}

Features FeatureTable::bound(std::uint32_t object, const Box& eyes) const {
  const ProjectionFromBox projection(camera_, eyes);
  Features features = counts_from(object, eyes);
  for_each_part(object, eyes, [&](const SurfaceSamples& samples, const PlacedMesh& mesh, const PartStyle& style, bool maybe_near) {
    PartSum most = most_from_box(samples.samples, mesh, style, projection);
    if (maybe_near) most = larger(most, most_from_box(samples.near_samples, mesh, style, projection));
    add_part(most, style.kind, samples.slenderness, most_passed_pixels_, features);
  });
  cap_pixels(most_passed_pixels_, features);
  return features;
}

ObjectFromBox FeatureTable::from_box(std::uint32_t object, const EyeBoxes& from) const {
  const ProjectionFromBox projection(camera_, from.eyes);
  ObjectFromBox result{counts_from(object, from.eyes), {}};
  for_each_part(object, from.eyes, [&](const SurfaceSamples& samples, const PlacedMesh& mesh, const PartStyle& style, bool maybe_near) {
    const auto blocks = [&](std::span<const SurfaceSample> of) { return facing_blocks(of, mesh, style, projection, from); };
    result.parts.push_back({style.kind, samples.slenderness, blocks(samples.samples), {}});
    if (maybe_near) result.parts.back().near_samples = blocks(samples.near_samples);
  });
  return result;
}

Features FeatureTable::bound(const ObjectFromBox& object, const Gaze& gaze) const {
  const double cos_corner = std::cos(camera_.half_diagonal_rad());
  Features features = object.counts;
  for (const ObjectFromBox::Part& part : object.parts) {
    const PartSum most = larger(most_in_gaze(part.samples, gaze, cos_corner), most_in_gaze(part.near_samples, gaze, cos_corner));
    add_part(most, part.kind, part.slenderness, most_passed_pixels_, features);
  }
  cap_pixels(most_passed_pixels_, features);
  return features;
}

Features FeatureTable::frame(std::span<const std::uint32_t> objects, const View& view, std::span<const std::uint8_t> levels) const {
  const PreparedView prepared(view, camera_);
  Features sum = frame_features();
  ScreenCoverage coverage(camera_);
  for (std::size_t i = 0; i < objects.size(); ++i) add(objects[i], levels.empty() ? 0U : levels[i], prepared, sum, coverage);
  add_passed(coverage, sum);
  return sum;
}

}  // namespace standin
