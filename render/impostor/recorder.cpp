#include "render/impostor/recorder.h"

#include <cmath>
#include <optional>

#include "render/impostor/coverage.h"
#include "render/impostor/outer_rims.h"
#include "render/impostor/slab_piece.h"
#include "render/impostor/surface.h"

namespace standin {
namespace {

constexpr float kShiftOnly = 4.0F;  // added to the order of surfaces that only rays beside the reference viewpoint meet in the texel
constexpr float kTouchOnly = 2.0F;  // added to the order of surfaces that miss the texel's centre; depths within a layer are in [0,1]

/// A triangle's interior over the image: barycentric coordinates and depth at any texel coordinate, without dividing per corner. Along the
/// ray of a texel, corner i has the weight dot(ray, p_j x p_k), which is linear in the texel coordinates.
class TrianglePlane {
 public:
  TrianglePlane(const FrameTriangle& p, const ImpostorFrame& frame) {
    const std::array<Vec3, 3> normals{glm::cross(p[1].position, p[2].position), glm::cross(p[2].position, p[0].position),
                                      glm::cross(p[0].position, p[1].position)};
    volume_ = glm::dot(p[0].position, normals[0]);
    const double sign = volume_ < 0.0 ? -1.0 : 1.0;
    volume_ *= sign;
    for (int i = 0; i < 3; ++i) {
      const Vec3& normal = normals[static_cast<std::size_t>(i)];
      along_x_[i] = sign * normal.x * frame.slope_step.x;
      along_y_[i] = -sign * normal.y * frame.slope_step.y;
      origin_[i] = sign * (normal.x * frame.slope_min.x + normal.y * frame.slope_min.y + normal.z);
    }
  }

  /// Weights whose sum is volume / depth; all >= 0 inside.
  [[nodiscard]] Vec3 weights(const Vec2& texel) const { return origin_ + texel.x * along_x_ + texel.y * along_y_; }
  [[nodiscard]] double volume() const { return volume_; }

  /// Texels of a texture of `size` that one texel of the impostor spans at most, squared (the level-of-detail rule of OpenGL).
  [[nodiscard]] double texels_squared(const TriangleAttributes& attributes, const Vec2& size, const Vec2& uv, double weight_sum) const {
    const auto slope = [&](const Vec3& along) {
      const Vec2 change = attributes.uv_at(along) - uv * (along.x + along.y + along.z);
      const Vec2 texels = size * change / weight_sum;
      return glm::dot(texels, texels);
    };
    return std::max(slope(along_x_), slope(along_y_));
  }

 private:
  Vec3 along_x_{0.0}, along_y_{0.0}, origin_{0.0};
  double volume_ = 0.0;  // 0: seen edge-on
};

/// One white texel: changes no colour, and passes every mask.
const TexturePyramid& white_texel() {
  static const Texture texture{"white", 1, 1, {255, 255, 255, 255}};
  static const TexturePyramid pyramid(texture, 0);
  return pyramid;
}

bool holds_centre(const RecordedTexel& texel) {
  return texel.opaque() && texel.order < kTouchOnly;
}

/// A point of a surface that stands for a texel.
struct SurfacePoint {
  Vec3 barycentric{0.0};
  double depth = 0.0;
};

class Recorder {
 public:
  Recorder(const Scene& scene, const TexturePyramids& textures, const ImpostorFrame& frame, std::span<const Layer> layers,
           Coverage coverage, Texturing texturing, const ShiftBound* shifts)
      : scene_(scene),
        textures_(textures),
        frame_(frame),
        layers_(layers),
        coverage_(coverage),
        texture_all_(texturing == Texturing::kEverywhere),
        shifts_(shifts),
        rows_(frame.width, frame.height),
        images_(layers.size(), LayerImage(frame.width, frame.height)) {}

  void draw_object(const Object& object, const WorkBudget& budget) {
    for (std::uint32_t i = 0; i < object.part_count; ++i) draw_part(object, scene_.parts[object.first_part + i], budget);
  }

  [[nodiscard]] std::vector<LayerImage> take() {
    if (shifts_ != nullptr) remove_outer_rims(images_, kShiftOnly);
    return std::move(images_);
  }

 private:
  struct Triangle {
    FrameTriangle corners;
    TriangleAttributes attributes;
  };

  void draw_part(const Object& object, const Part& part, const WorkBudget& budget) {
    const Mesh& mesh = scene_.meshes[part.mesh];
    const TexturePyramid* texture = mesh.uvs.empty() ? nullptr : textures_.of_material(part.material);
    const Surface surface(scene_.materials[part.material], texture != nullptr ? texture : stand_in_texture(part.material));
    if (!surface.ever_opaque()) return;
    transform(object, mesh);
    const Mat3 m(object.world_from_object);
    const Mat3 world_from_normal(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      if (i % 49152 == 0) budget.check();
      Triangle triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = mesh.indices[i + k];
        triangle.corners[k] = vertices_[vertex];
        triangle.attributes.normal[k] = world_from_normal * Vec3(mesh.normals[vertex]);
        if (texture != nullptr) triangle.attributes.uv[k] = Vec2(mesh.uvs[vertex]);
      }
      draw_triangle(triangle, surface);
    }
  }

  [[nodiscard]] const TexturePyramid* stand_in_texture(std::uint32_t material) const {
    return texture_all_ && scene_.materials[material].alpha_mode != AlphaMode::kMask ? &white_texel() : nullptr;
  }

  void transform(const Object& object, const Mesh& mesh) {
    const Mat3 frame_from_world = glm::transpose(Mat3(frame_.right, frame_.up, frame_.forward));
    const Mat3 frame_from_mesh = frame_from_world * Mat3(object.world_from_object);
    const Vec3 origin = frame_from_world * (Vec3(object.world_from_object[3]) - frame_.reference_viewpoint);
    vertices_.resize(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
      vertices_[i] = frame_vertex(frame_, frame_from_mesh * Vec3(mesh.positions[i]) + origin);
  }

  void draw_triangle(const Triangle& triangle, const Surface& surface) {
    const auto& p = triangle.corners;
    if (glm::cross(p[1].position - p[0].position, p[2].position - p[0].position) == Vec3(0.0)) return;  // no ray ever hits it
    const TrianglePlane plane(p, frame_);
    const double nearest = std::min({p[0].position.z, p[1].position.z, p[2].position.z});
    const double farthest = std::max({p[0].position.z, p[1].position.z, p[2].position.z});
    for (std::size_t layer = first_layer_beyond(nearest); layer < layers_.size(); ++layer) {
      const bool last = layer + 1 == layers_.size();
      draw_piece(slab_piece(p, frame_, layer == 0 ? 0.0 : layers_[layer].near_m, last ? kInfinity : layers_[layer].far_m), layer, plane,
                 triangle, surface);
      if (layers_[layer].far_m >= farthest) break;
    }
  }

  /// The first layer that ends behind `depth`. A surface in the plane between two layers goes to the nearer one.
  [[nodiscard]] std::size_t first_layer_beyond(double depth) const {
    const auto found = std::partition_point(layers_.begin(), layers_.end(), [&](const Layer& layer) { return layer.far_m < depth; });
    return std::min(static_cast<std::size_t>(found - layers_.begin()), layers_.size() - 1);
  }

  void draw_piece(const Piece& piece, std::size_t layer, const TrianglePlane& plane, const Triangle& triangle, const Surface& surface) {
    rows_.for_each_row(piece, [&](std::uint32_t y, std::uint32_t first, std::uint32_t last) {
      for (std::uint32_t x = first; x <= last; ++x) draw_texel(x, y, piece, layer, plane, triangle, surface);
    });
    if (shifts_ == nullptr || !draws_outline(surface)) return;
    const Vec2 margin = most_shift(piece, layers_[layer].distance_m);
    rows_.for_each_row(piece, margin, [&](std::uint32_t y, std::uint32_t first, std::uint32_t last) {
      for (std::uint32_t x = first; x <= last; ++x) draw_shifted_texel(x, y, piece, margin, layer, plane, triangle, surface);
    });
  }

  [[nodiscard]] Vec2 most_shift(const Piece& piece, double layer_m) const {
    double least = kInfinity, most = 0.0;
    for (std::size_t i = 0; i < piece.count; ++i) {
      least = std::min(least, piece.vertices[i].inverse_depth);
      most = std::max(most, piece.vertices[i].inverse_depth);
    }
    return glm::max(shifts_->texels(1.0 / most, layer_m), shifts_->texels(1.0 / least, layer_m));
  }

  void draw_shifted_texel(std::uint32_t x, std::uint32_t y, const Piece& piece, const Vec2& margin, std::size_t layer,
                          const TrianglePlane& plane, const Triangle& triangle, const Surface& surface) {
    const RecordedTexel drawn = images_[layer].get(x, y);
    if (drawn.opaque() && drawn.order < kShiftOnly) return;
    const Vec2 centre(x + 0.5, y + 0.5);
    const std::optional<SurfacePoint> inside = point_at(centre, layer, plane);
    const SurfacePoint found = inside ? *inside : outline_point(centre, piece);
    const TexturePyramid* mask = surface.mask();
    if (mask != nullptr && !mask_may_pass(x, y, margin, piece, triangle.attributes, *mask, found)) return;
    const float order = depth_in(layers_[layer], found.depth) + kShiftOnly;
    if (drawn.opaque() && drawn.order <= order) return;
    RecordedTexel& texel = images_[layer].at(x, y);
    texel.order = order;
    texel.rgba = surface.colour(triangle.attributes, found.barycentric, level_of_detail(plane, triangle.attributes, surface, found));
  }

  void draw_texel(std::uint32_t x, std::uint32_t y, const Piece& piece, std::size_t layer, const TrianglePlane& plane,
                  const Triangle& triangle, const Surface& surface) {
    const Vec2 centre(x + 0.5, y + 0.5);
    std::optional<SurfacePoint> found = point_at(centre, layer, plane);
    bool at_centre = found.has_value();
    const TexturePyramid* mask = surface.mask();
    if (at_centre && mask != nullptr) at_centre = mask->passes(triangle.attributes.uv_at(found->barycentric));
    if (!at_centre && (!draws_outline(surface) || holds_centre(images_[layer].get(x, y)))) return;
    if (!found) found = outline_point(centre, piece);
    if (!at_centre && mask != nullptr && !mask_may_pass(x, y, Vec2(0.0), piece, triangle.attributes, *mask, *found)) return;

    const float order = depth_in(layers_[layer], found->depth) + (at_centre ? 0.0F : kTouchOnly);
    RecordedTexel& texel = images_[layer].at(x, y);
    if (texel.opaque() && texel.order <= order) return;
    texel.order = order;
    texel.rgba = surface.colour(triangle.attributes, found->barycentric, level_of_detail(plane, triangle.attributes, surface, *found));
  }

  /// Whether texels count that the surface only touches.
  [[nodiscard]] bool draws_outline(const Surface& surface) const {
    return coverage_ == Coverage::kClosed || (coverage_ == Coverage::kFuzzy && surface.mask() == nullptr);
  }

  /// The surface at the texel's centre, if the triangle and the layer hold it.
  [[nodiscard]] std::optional<SurfacePoint> point_at(const Vec2& centre, std::size_t layer, const TrianglePlane& plane) const {
    const Vec3 weights = plane.weights(centre);
    const double sum = weights.x + weights.y + weights.z;
    if (weights.x < 0.0 || weights.y < 0.0 || weights.z < 0.0 || !(sum > 0.0)) return std::nullopt;
    const double depth = plane.volume() / sum;
    if ((layer > 0 && depth < layers_[layer].near_m) || (layer + 1 < layers_.size() && depth > layers_[layer].far_m)) return std::nullopt;
    return SurfacePoint{weights / sum, depth};
  }

  [[nodiscard]] static SurfacePoint outline_point(const Vec2& centre, const Piece& piece) {
    const PieceVertex nearest = nearest_on_outline(piece, centre);
    return {nearest.barycentric(), 1.0 / nearest.inverse_depth};
  }

  /// Place of a depth within its layer, 0 (near) to 1.
  [[nodiscard]] static float depth_in(const Layer& layer, double depth) {
    const double thickness = layer.far_m - layer.near_m;
    return thickness > 0.0 ? static_cast<float>(std::clamp((depth - layer.near_m) / thickness, 0.0, 1.0)) : 0.0F;
  }

  /// Whether the mask has an opaque texel anywhere in what the piece shows within impostor texel (x, y) with a margin.
  [[nodiscard]] static bool mask_may_pass(std::uint32_t x, std::uint32_t y, const Vec2& margin, const Piece& piece,
                                          const TriangleAttributes& attributes, const TexturePyramid& mask, const SurfacePoint& point) {
    Vec2 uv_min = attributes.uv_at(point.barycentric), uv_max = uv_min;
    const Piece inside = texel_piece(piece, x, y, margin);
    for (std::size_t i = 0; i < inside.count; ++i) {
      const Vec2 uv = attributes.uv_at(inside.vertices[i].barycentric());
      uv_min = glm::min(uv_min, uv);
      uv_max = glm::max(uv_max, uv);
    }
    return mask.any_passes(uv_min, uv_max);
  }

  [[nodiscard]] static double level_of_detail(const TrianglePlane& plane, const TriangleAttributes& attributes, const Surface& surface,
                                              const SurfacePoint& point) {
    if (surface.texture() == nullptr) return 0.0;
    const Vec2 size(surface.texture()->width(), surface.texture()->height());
    const double weight_sum = plane.volume() / point.depth;
    const double texels2 = plane.texels_squared(attributes, size, attributes.uv_at(point.barycentric), weight_sum);
    if (texels2 <= 1.0) return 0.0;
    return texels2 < 1e12 ? 0.5 * std::log2(texels2) : surface.texture()->coarsest_level();  // also where seen edge-on (NaN)
  }

  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  const Scene& scene_;
  const TexturePyramids& textures_;
  const ImpostorFrame& frame_;
  std::span<const Layer> layers_;
  Coverage coverage_;
  bool texture_all_;
  const ShiftBound* shifts_;
  ClosedCoverage rows_;
  std::vector<LayerImage> images_;
  std::vector<FrameVertex> vertices_;  // of the part
};

}  // namespace

std::vector<LayerImage> record_layers(const Scene& scene, const TexturePyramids& textures, std::span<const std::uint32_t> objects,
                                      const ImpostorFrame& frame, std::span<const Layer> layers, Coverage coverage,
                                      const WorkBudget& budget, Texturing texturing, const ShiftBound* shifts) {
  Recorder recorder(scene, textures, frame, layers, coverage, texturing, shifts);
  for (const std::uint32_t id : objects) {
    budget.check();
    recorder.draw_object(scene.objects.at(id), budget);
  }
  return recorder.take();
}

double depth_m(const RecordedTexel& texel, const Layer& layer) {
  const double share = std::fmod(texel.order, kTouchOnly);  // the tiers are its multiples, depths within a layer at most 1
  return share > 0.0 ? layer.near_m + share * (layer.far_m - layer.near_m) : layer.near_m;
}

}  // namespace standin
