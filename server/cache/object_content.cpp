#include "server/cache/object_content.h"

#include <algorithm>

#include "estimation/feature_table.h"

namespace standin {
namespace {

Fingerprint triangles_of(const Mesh& mesh) {
  return Fingerprinter().add_list(mesh.positions).add_list(mesh.indices).fingerprint();
}

Fingerprint content_of(const Texture& texture) {
  return Fingerprinter().add(texture.width).add(texture.height).add_list(texture.rgba).fingerprint();
}

Fingerprint alpha_of(const Texture& texture) {
  std::vector<std::uint8_t> alpha;
  alpha.reserve(texture.rgba.size() / 4);
  for (std::size_t i = 3; i < texture.rgba.size(); i += 4) alpha.push_back(texture.rgba[i]);
  return Fingerprinter().add(texture.width).add(texture.height).add_list(alpha).fingerprint();
}

template <class Item, class Of>
std::vector<Fingerprint> each(const std::vector<Item>& items, const Of& of) {
  std::vector<Fingerprint> contents;
  contents.reserve(items.size());
  for (const Item& item : items) contents.push_back(of(item));
  return contents;
}

/// `add_part(part, to)` for each of the object's own parts.
template <class AddPart>
Fingerprint object_content(const Scene& scene, const Object& object, const AddPart& add_part) {
  Fingerprinter to;
  to.add(object.world_from_object).add(object.bounds).add(object.part_count);
  for (std::uint32_t p = object.first_part; p < object.first_part + object.part_count; ++p) add_part(scene.parts[p], to);
  return to.fingerprint();
}

// What lets a ray through: coordinates and alpha, where the material is masked.
class MaskContents {
 public:
  explicit MaskContents(const Scene& scene) : scene_(scene), alpha_(scene.textures.size()), uvs_(scene.meshes.size()) {
    for (const Part& part : scene.parts) prepare(part);
  }

  void add(const Part& part, Fingerprinter& to) const {
    const Material& material = scene_.materials[part.material];
    to.add(material.alpha_mode);
    if (material.alpha_mode != AlphaMode::kMask) return;
    to.add(material.base_colour.a).add(material.alpha_cutoff).add(uvs_[part.mesh]).add(material.texture >= 0);
    if (material.texture >= 0) to.add(alpha_[static_cast<std::size_t>(material.texture)]);
  }

 private:
  void prepare(const Part& part) {
    const Material& material = scene_.materials[part.material];
    if (material.alpha_mode != AlphaMode::kMask) return;
    if (uvs_[part.mesh] == Fingerprint{}) uvs_[part.mesh] = Fingerprinter().add_list(scene_.meshes[part.mesh].uvs).fingerprint();
    if (material.texture < 0) return;
    Fingerprint& alpha = alpha_[static_cast<std::size_t>(material.texture)];
    if (alpha == Fingerprint{}) alpha = alpha_of(scene_.textures[static_cast<std::size_t>(material.texture)]);
  }

  const Scene& scene_;
  std::vector<Fingerprint> alpha_;  // per texture, of those that mask
  std::vector<Fingerprint> uvs_;    // per mesh, of those that are masked
};

// The samples of a simplified mesh are made from those of the mesh before it, down to the one that it was simplified from.
std::vector<Fingerprint> sampled_contents(const Scene& scene) {
  std::vector<Fingerprint> contents;
  for (const Mesh& mesh : scene.meshes) {
    Fingerprinter to;
    to.add(triangles_of(mesh)).add(!mesh.uvs.empty()).add(mesh.simplified_from >= 0);
    if (mesh.simplified_from >= 0) {
      const std::size_t before = contents.size() - 1;
      const bool first = scene.meshes[before].simplified_from != mesh.simplified_from;
      to.add(contents[first ? static_cast<std::size_t>(mesh.simplified_from) : before]);
    }
    contents.push_back(to.fingerprint());
  }
  return contents;
}

void add_drawn(const Scene& scene, const std::vector<Fingerprint>& meshes, const Part& part, Fingerprinter& to) {
  to.add(meshes[part.mesh]).add(pixel_kind(scene, part)).add(scene.materials[part.material].double_sided);
}

void add_levels(const Scene& scene, const std::vector<Fingerprint>& meshes, const Object& object, Fingerprinter& to) {
  to.add(std::uint64_t{object.levels.size()});
  for (const ObjectLevel& level : object.levels) {
    to.add(level.least_distance_m).add(level.triangle_count).add(level.part_count);
    for (std::uint32_t p = level.first_part; p < level.first_part + level.part_count; ++p) add_drawn(scene, meshes, scene.parts[p], to);
  }
}

Fingerprint content_of(const Material& material, const std::vector<Fingerprint>& textures) {
  Fingerprinter to;
  for (int channel = 0; channel < 4; ++channel) to.add(material.base_colour[channel]);
  to.add(material.alpha_mode).add(material.alpha_cutoff).add(material.double_sided).add(material.unlit).add(material.texture >= 0);
  if (material.texture >= 0) to.add(textures[static_cast<std::size_t>(material.texture)]);
  return to.fingerprint();
}

// Ranks among those that occur.
void add_ranks(const std::vector<std::int64_t>& numbers, Fingerprinter& to) {
  std::vector<std::int64_t> used = numbers;
  std::ranges::sort(used);
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::vector<std::uint32_t> ranks;
  for (const std::int64_t number : numbers)
    ranks.push_back(static_cast<std::uint32_t>(std::ranges::lower_bound(used, number) - used.begin()));
  to.add_list(ranks);
}

}  // namespace

Fingerprint mesh_content(const Mesh& mesh) {
  return Fingerprinter().add_list(mesh.positions).add_list(mesh.normals).add_list(mesh.uvs).add_list(mesh.indices).fingerprint();
}

std::vector<Fingerprint> ray_contents(const Scene& scene) {
  const auto meshes = each(scene.meshes, triangles_of);
  const MaskContents masks(scene);
  return each(scene.objects, [&](const Object& object) {
    return object_content(scene, object, [&](const Part& part, Fingerprinter& to) {
      to.add(meshes[part.mesh]);
      masks.add(part, to);
    });
  });
}

std::vector<Fingerprint> cost_contents(const Scene& scene) {
  const auto meshes = sampled_contents(scene);
  return each(scene.objects, [&](const Object& object) {
    const Fingerprint own = object_content(scene, object, [&](const Part& part, Fingerprinter& to) { add_drawn(scene, meshes, part, to); });
    Fingerprinter to;
    add_levels(scene, meshes, object, to.add(own));
    return to.fingerprint();
  });
}

std::vector<Fingerprint> look_contents(const Scene& scene) {
  const auto meshes = each(scene.meshes, mesh_content);
  const auto textures = each(scene.textures, [](const Texture& texture) { return content_of(texture); });
  const auto materials = each(scene.materials, [&](const Material& material) { return content_of(material, textures); });
  return each(scene.objects, [&](const Object& object) {
    return object_content(scene, object,
                          [&](const Part& part, Fingerprinter& to) { to.add(meshes[part.mesh]).add(materials[part.material]); });
  });
}

void add_sharing(const Scene& scene, std::span<const std::uint32_t> objects, Fingerprinter& to) {
  std::vector<std::int64_t> meshes, materials, textures;
  for (const std::uint32_t id : objects) {
    const Object& object = scene.objects[id];
    for (std::uint32_t p = object.first_part; p < object.first_part + object.part_count; ++p) {
      meshes.push_back(scene.parts[p].mesh);
      materials.push_back(scene.parts[p].material);
      textures.push_back(scene.materials[scene.parts[p].material].texture);
    }
  }
  for (const auto* numbers : {&meshes, &materials, &textures}) add_ranks(*numbers, to);
}

}  // namespace standin
