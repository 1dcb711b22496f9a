#include "server/cache/bake_cache.h"

#include <gtest/gtest.h>

#include <functional>

#include "render/impostor/texture_pyramid.h"
#include "server/cache/impostor_bytes.h"
#include "tests/server/cache/painted_scene.h"
#include "tests/support/temp_folder.h"

namespace standin {
namespace {

using test::kBlock, test::kCrate, test::kPane;

Candidate candidate_of(Technique technique, std::vector<std::uint32_t> objects) {
  Candidate candidate;
  candidate.technique = technique;
  candidate.objects = std::move(objects);
  Shaft shaft = shaft_frame({1.0, 1.0, 0.0}, {0.0, 0.0, 1.0});
  shaft.tan_half = {0.02, 0.02};
  shaft.min_distance_m = 40.0;
  candidate.view_cell = shaft;
  return candidate;
}

class BakeCaches : public test::TempFolder {
 protected:
  [[nodiscard]] std::optional<Impostor> fresh(const Scene& scene, const Candidate& candidate) const {
    const TexturePyramids textures(scene);
    return candidate_baker(scene, textures, camera_, quality_, {})(candidate);
  }
  /// In a job of its own; counts how often it had to bake.
  std::optional<Impostor> cached(const Scene& scene, const Candidate& candidate) {
    StageCache cache(root_, fingerprint_of("build"));
    const BakeCache bakes(cache, scene, camera_, quality_);
    const BakeCandidate bake = through_cache(&bakes, [&](const Candidate& asked) {
      ++baked_;
      return fresh(scene, asked);
    });
    return bake(candidate);
  }
  [[nodiscard]] Fingerprint inputs_of(const Scene& scene, const Candidate& candidate) {
    StageCache cache(root_, fingerprint_of("build"));
    return BakeCache(cache, scene, camera_, quality_).inputs_of(candidate);
  }

  Camera camera_{.width = 128, .height = 128};
  BakeQuality quality_;
  int baked_ = 0;
};

void expect_same(const std::optional<Impostor>& a, const std::optional<Impostor>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  EXPECT_EQ(bytes_of(a), bytes_of(b));
  EXPECT_EQ(a->objects, b->objects);
  EXPECT_EQ(a->view_cell.index(), b->view_cell.index());
}

TEST_F(BakeCaches, AreWhatBakingWouldMakeWithEveryTechnique) {
  const Scene scene = test::painted_scene();
  int possible = 0;
  for (std::size_t t = 0; t < kTechniqueCount; ++t) {
    const Candidate candidate = candidate_of(static_cast<Technique>(t), {kCrate, kBlock});
    const auto impostor = fresh(scene, candidate);
    possible += impostor && !impostor->empty() ? 1 : 0;
    expect_same(cached(scene, candidate), impostor);
    expect_same(cached(scene, candidate), impostor);
    EXPECT_EQ(baked_, static_cast<int>(t) + 1) << technique_name(candidate.technique);
  }
  EXPECT_GE(possible, 3);
}

TEST_F(BakeCaches, ThatThereIsNoneIsKnownToo) {
  const Scene scene = test::painted_scene();
  const Candidate masked = candidate_of(Technique::kLodSprite, {kPane});
  ASSERT_FALSE(fresh(scene, masked));
  EXPECT_FALSE(cached(scene, masked));
  EXPECT_FALSE(cached(scene, masked));
  EXPECT_EQ(baked_, 1);
}

TEST_F(BakeCaches, EditsElsewhereDoNotMatter) {
  const Scene scene = test::painted_scene();
  const Scene more = test::with_one_in_front(scene);
  static_cast<void>(cached(scene, candidate_of(Technique::kLayered, {kCrate, kBlock})));
  const Candidate shifted = candidate_of(Technique::kLayered, {kCrate + 1, kBlock + 1});
  const auto impostor = cached(more, shifted);
  EXPECT_EQ(baked_, 1);
  ASSERT_TRUE(impostor);
  EXPECT_EQ(impostor->objects, shifted.objects) << "as they are numbered now";
  expect_same(impostor, fresh(more, shifted));
}

TEST_F(BakeCaches, EveryInputMatters) {
  const Scene scene = test::painted_scene();
  const Candidate plain = candidate_of(Technique::kLayered, {kCrate, kBlock});
  std::vector<Fingerprint> all = {inputs_of(scene, plain)};
  const auto candidate = [&](const std::function<void(Candidate&)>& change) {
    Candidate changed = plain;
    change(changed);
    all.push_back(inputs_of(scene, changed));
  };
  candidate([](Candidate& c) { c.technique = Technique::kDepthMesh; });
  candidate([](Candidate& c) { c.objects.pop_back(); });
  candidate([](Candidate& c) { c.objects.front() = kPane; });
  candidate([](Candidate& c) { c.view_cell = Box{Vec3(0.0, 0.0, 40.0), Vec3(1.0, 1.0, 41.0)}; });
  for (int number = 0; number < 15; ++number)
    candidate([&](Candidate& c) {
      auto& shaft = std::get<Shaft>(c.view_cell);
      double* const numbers[] = {&shaft.apex.x, &shaft.apex.y,  &shaft.apex.z,     &shaft.axis.x,     &shaft.axis.y,
                                 &shaft.axis.z, &shaft.right.x, &shaft.right.y,    &shaft.right.z,    &shaft.up.x,
                                 &shaft.up.y,   &shaft.up.z,    &shaft.tan_half.x, &shaft.tan_half.y, &shaft.min_distance_m};
      *numbers[number] += 0.01;
    });
  const auto quality = [&](const std::function<void(BakeQuality&)>& change) {
    const BakeQuality before = quality_;
    change(quality_);
    all.push_back(inputs_of(scene, plain));
    quality_ = before;
  };
  quality([](BakeQuality& q) { q.alpha_scale *= 2.0; });
  quality([](BakeQuality& q) { q.texel_scale *= 2.0; });
  quality([](BakeQuality& q) { q.max_layers += 1; });
  quality([](BakeQuality& q) { q.max_resolution += 1; });
  quality([](BakeQuality& q) { q.grid_texels += 1; });
  quality([](BakeQuality& q) { q.fill_ratio *= 0.5; });
  for (bool BakeQuality::*member :
       {&BakeQuality::fuzzy, &BakeQuality::strict, &BakeQuality::leave_out, &BakeQuality::supercover, &BakeQuality::seal_rims})
    quality([&](BakeQuality& q) { q.*member = !(q.*member); });
  for (int* side : {&camera_.width, &camera_.height}) {
    *side *= 2;
    all.push_back(inputs_of(scene, plain));
    *side /= 2;
  }
  camera_.fov_y_rad = 0.5;
  all.push_back(inputs_of(scene, plain));
  Scene recoloured = scene;
  recoloured.materials[2].base_colour.r = 0.5F;
  all.push_back(inputs_of(recoloured, plain));
  Scene shared = scene;
  shared.parts[kBlock].mesh = shared.parts[kCrate].mesh;
  all.push_back(inputs_of(shared, plain));
  EXPECT_EQ(std::set<Fingerprint>(all.begin(), all.end()).size(), all.size());
  Candidate estimated_otherwise = plain;
  estimated_otherwise.cells = {4};
  estimated_otherwise.bytes = 3.0;
  estimated_otherwise.node = 8;
  Scene elsewhere = scene;
  elsewhere.materials[0].base_colour.r = 0.5F;
  camera_ = {.width = 128, .height = 128};
  EXPECT_EQ(inputs_of(elsewhere, estimated_otherwise), all.front());
}

}  // namespace
}  // namespace standin
