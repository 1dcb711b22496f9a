#include "estimation/features.h"

#include "estimation/feature_table.h"

namespace standin {

std::string_view term_name(Term term) {
  static constexpr std::array<std::string_view, kTermCount> kNames = {
      "frame",        "draws",           "texture_switches", "triangles",      "on_screen_triangles", "edge_pixels",
      "plain_pixels", "textured_pixels", "masked_pixels",    "impostor_quads", "impostor_pixels"};
  return kNames[static_cast<std::size_t>(term)];
}

bool is_pixel_term(Term term) {
  return term == Term::kPlainPixels || term == Term::kTexturedPixels || term == Term::kMaskedPixels;
}

Features frame_features() {
  Features features;
  features[Term::kFrame] = 1.0;
  return features;
}

namespace {

/// The scene reduced to one object, whose id becomes 0 (the table samples every mesh it is given).
Scene only(const Scene& scene, std::uint32_t object) {
  Scene one;
  one.objects = {scene.objects[object]};
  one.materials = scene.materials;
  one.objects[0].first_part = 0;
  one.objects[0].levels.clear();
  for (std::uint32_t p = 0; p < one.objects[0].part_count; ++p) {
    const Part& part = scene.parts[scene.objects[object].first_part + p];
    one.parts.push_back({p, part.material});
    one.meshes.push_back(scene.meshes[part.mesh]);
  }
  return one;
}

}  // namespace

Features object_features(const Scene& scene, std::uint32_t object, const View& view, const Camera& camera) {
  const Scene one = only(scene, object);
  return FeatureTable(one, camera).estimate(0, PreparedView(view, camera));
}

Features object_features_bound(const Scene& scene, std::uint32_t object, const Box& eyes, const Camera& camera) {
  const Scene one = only(scene, object);
  return FeatureTable(one, camera).bound(0, eyes);
}

}  // namespace standin
