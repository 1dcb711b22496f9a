// Splitting objects that are too heavy or too long into pieces an impostor can stand for (thesis 1.6: the power plant's triangles are
// clustered by a kd tree).
//
// Instances that need splitting share the pieces: the tree is built once per set of meshes, fine enough for the largest such instance.

#include <algorithm>
#include <cmath>
#include <map>

#include "render/scene/import.h"

namespace standin {
namespace {

// Splitting for length stops where the pieces would be too light to be worth a draw call.
constexpr std::size_t kLightest = 500;

struct Triangle {
  std::uint32_t part = 0;   // within the object
  std::uint32_t index = 0;  // within the part's mesh
  glm::vec3 centroid{0.0F};
  [[nodiscard]] auto key() const { return std::pair(part, index); }
};

// Lengths of the object's own axes in the world.
Vec3 axis_scales(const Object& object) {
  return {glm::length(Vec3(object.world_from_object[0])), glm::length(Vec3(object.world_from_object[1])),
          glm::length(Vec3(object.world_from_object[2]))};
}

double longest_edge(const Vec3& size) {
  return std::max({size.x, size.y, size.z});
}

struct Limits {
  std::uint64_t triangles = 0;  // 0: any number
  double extent_m = 0.0;        // 0: any length

  [[nodiscard]] bool exceeded(std::uint64_t count, const Vec3& size_m) const {
    if (triangles > 0 && count > triangles) return true;
    return extent_m > 0.0 && count >= 2 * kLightest && longest_edge(size_m) > extent_m;
  }
};

class Splitter {
 public:
  Splitter(Scene& scene, const Limits& limits) : scene_(scene), limits_(limits) {}

  void run() {
    std::map<std::pair<std::uint32_t, std::uint32_t>, Vec3> scales;  // per range of parts: the largest of the instances to split
    for (const Object& object : scene_.objects) {
      if (!too_large(object)) continue;
      Vec3& scale = scales.try_emplace({object.first_part, object.part_count}, 0.0).first->second;
      scale = glm::max(scale, axis_scales(object));
    }
    for (const auto& [range, scale] : scales) pieces_[range] = split_range(range.first, range.second, scale);
    std::vector<Object> objects;
    for (Object& object : scene_.objects) replace(object, objects);
    scene_.objects = std::move(objects);
  }

 private:
  struct PartRange {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };

  [[nodiscard]] bool too_large(const Object& object) const {
    Box box;
    for (std::uint32_t p = 0; p < object.part_count; ++p) box.extend(scene_.meshes[scene_.parts[object.first_part + p].mesh].bounds);
    return limits_.exceeded(object.triangle_count, box.size() * axis_scales(object));
  }

  void replace(Object& object, std::vector<Object>& objects) {
    const auto found = pieces_.find({object.first_part, object.part_count});
    if (found == pieces_.end() || found->second.size() < 2 || !too_large(object)) {
      objects.push_back(std::move(object));
      return;
    }
    add_note(scene_, LoadNote::Kind::kChosen, "objects", 1, "too heavy or too long; split by a kd tree");
    if (!object.levels.empty())
      add_note(scene_, LoadNote::Kind::kDropped, "levels of detail", object.levels.size(), "their object was split into pieces");
    object.levels.clear();
    add_note(scene_, LoadNote::Kind::kChosen, "pieces", found->second.size(), "that split objects became");
    for (std::size_t k = 0; k < found->second.size(); ++k) {
      Object piece = object;
      piece.name += "#" + std::to_string(k);
      piece.first_part = found->second[k].first;
      piece.part_count = found->second[k].count;
      objects.push_back(std::move(piece));
    }
  }

  [[nodiscard]] std::vector<Triangle> triangles_of(std::uint32_t first_part, std::uint32_t part_count) const {
    std::vector<Triangle> triangles;
    for (std::uint32_t p = 0; p < part_count; ++p) {
      const Mesh& mesh = scene_.meshes[scene_.parts[first_part + p].mesh];
      for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        const auto corner = [&](std::uint32_t c) { return mesh.positions[mesh.indices[3 * t + c]]; };
        triangles.push_back({p, t, (corner(0) + corner(1) + corner(2)) / 3.0F});
      }
    }
    return triangles;
  }

  [[nodiscard]] Box bounds_of(std::uint32_t first_part, std::span<const Triangle> triangles) const {
    Box box;
    for (const Triangle& triangle : triangles) {
      const Mesh& mesh = scene_.meshes[scene_.parts[first_part + triangle.part].mesh];
      for (std::uint32_t c = 0; c < 3; ++c) box.extend(Vec3(mesh.positions[mesh.indices[3 * triangle.index + c]]));
    }
    return box;
  }

  // Halves at the median centroid along the longest axis until each piece is within the limits.
  std::vector<PartRange> split_range(std::uint32_t first_part, std::uint32_t part_count, const Vec3& scale) {
    std::vector<Triangle> triangles = triangles_of(first_part, part_count);
    std::vector<PartRange> pieces;
    std::vector<std::span<Triangle>> stack{triangles};
    while (!stack.empty()) {
      const std::span<Triangle> node = stack.back();
      stack.pop_back();
      const Vec3 size_m = bounds_of(first_part, node).size() * scale;
      if (node.size() < 2 || !limits_.exceeded(node.size(), size_m)) {
        pieces.push_back(make_piece(first_part, node));
        continue;
      }
      const std::size_t half = node.size() / 2;
      partition(node, half, scale);
      stack.push_back(node.subspan(half));
      stack.push_back(node.first(half));
    }
    return pieces;
  }

  // The `half` least triangles first; a total order, so that the two sets do not depend on the library's algorithm.
  static void partition(std::span<Triangle> node, std::size_t half, const Vec3& scale) {
    Box centroids;
    for (const Triangle& triangle : node) centroids.extend(Vec3(triangle.centroid));
    const Vec3 size = centroids.size() * scale;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    std::nth_element(node.begin(), node.begin() + static_cast<std::ptrdiff_t>(half), node.end(),
                     [axis](const Triangle& a, const Triangle& b) {
                       return a.centroid[axis] != b.centroid[axis] ? a.centroid[axis] < b.centroid[axis] : a.key() < b.key();
                     });
  }

  PartRange make_piece(std::uint32_t first_part, std::span<Triangle> triangles) {
    std::sort(triangles.begin(), triangles.end(), [](const Triangle& a, const Triangle& b) { return a.key() < b.key(); });
    PartRange range{static_cast<std::uint32_t>(scene_.parts.size()), 0};
    for (std::size_t begin = 0; begin < triangles.size();) {
      std::size_t end = begin;
      while (end < triangles.size() && triangles[end].part == triangles[begin].part) ++end;
      const Part whole = scene_.parts[first_part + triangles[begin].part];
      Mesh piece = extract(scene_.meshes[whole.mesh], triangles.subspan(begin, end - begin));
      scene_.parts.push_back({static_cast<std::uint32_t>(scene_.meshes.size()), whole.material, whole.gltf_mesh, whole.gltf_primitive});
      scene_.meshes.push_back(std::move(piece));
      ++range.count;
      begin = end;
    }
    return range;
  }

  // Vertices in the order of their first use.
  Mesh extract(const Mesh& mesh, std::span<const Triangle> triangles) {
    Mesh piece;
    piece.name = mesh.name;
    piece.is_piece = true;
    new_index_.resize(std::max(new_index_.size(), mesh.positions.size()), kUnused);
    std::vector<std::uint32_t> used;
    for (const Triangle& triangle : triangles) {
      for (std::uint32_t c = 0; c < 3; ++c) {
        const std::uint32_t old = mesh.indices[3 * triangle.index + c];
        if (new_index_[old] == kUnused) {
          new_index_[old] = static_cast<std::uint32_t>(used.size());
          used.push_back(old);
        }
        piece.indices.push_back(new_index_[old]);
      }
    }
    for (const std::uint32_t old : used) {
      piece.positions.push_back(mesh.positions[old]);
      piece.normals.push_back(mesh.normals[old]);
      if (!mesh.uvs.empty()) piece.uvs.push_back(mesh.uvs[old]);
      piece.source.push_back(mesh.source.empty() ? old : mesh.source[old]);
      new_index_[old] = kUnused;
    }
    return piece;
  }

  static constexpr std::uint32_t kUnused = 0xFFFFFFFFU;
  Scene& scene_;
  Limits limits_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<PartRange>> pieces_;
  std::vector<std::uint32_t> new_index_;  // scratch of extract(): kUnused between calls
};

}  // namespace

bool split_objects(Scene& scene, const LoadOptions& options) {
  const std::size_t before = scene.objects.size();
  Splitter(scene, {options.split_triangles, options.split_extent * scene.bounds.diagonal()}).run();
  return scene.objects.size() > before;
}

}  // namespace standin
