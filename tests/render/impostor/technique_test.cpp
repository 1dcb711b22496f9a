// What holds for impostors of every technique: one suite over all of them.
#include "render/impostor/technique.h"

#include <gtest/gtest.h>

#include "render/base/error.h"
#include "render/impostor/atlas.h"
#include "render/impostor/texture_pyramid.h"
#include "tests/render/impostor/small_scene.h"

namespace standin {
namespace {

ViewCell shaft_towards_z(double tan_half, double min_distance) {
  Shaft shaft = shaft_frame(Vec3(0.0), Vec3(0, 0, 1));
  shaft.tan_half = Vec2(tan_half);
  shaft.min_distance_m = min_distance;
  return shaft;
}

/// Random triangles, flat enough that one layer will do from afar.
Scene crumpled_scene(std::uint64_t seed) {
  Rng rng(seed);
  test::SmallScene scene;
  for (int i = 0; i < 2; ++i) scene.add_object(test::random_triangles(rng, {Vec3(-4, -3, -0.1), Vec3(4, 3, 0.1)}, 8));
  return std::move(scene.scene);
}

class EveryTechnique : public testing::TestWithParam<Technique> {
 protected:
  [[nodiscard]] static Impostor baked(const Scene& scene, const ViewCell& cell, const BakeQuality& quality = {}) {
    std::vector<std::uint32_t> objects;
    for (std::uint32_t i = 0; i < scene.objects.size(); ++i) objects.push_back(i);
    return bake_impostor(scene, TexturePyramids(scene), GetParam(), {objects, cell}, Camera{}, quality);
  }
  static std::vector<ViewCell> cells() { return {shaft_towards_z(0.05, 60.0), Box{Vec3(-1, -1, 60), Vec3(1, 1, 62)}}; }
};

INSTANTIATE_TEST_SUITE_P(Techniques, EveryTechnique,
                         testing::Values(Technique::kLayered, Technique::kDepthMesh, Technique::kPlanar, Technique::kLodSprite),
                         [](const testing::TestParamInfo<Technique>& one) {
                           std::string name(technique_name(one.param));
                           std::erase(name, '-');
                           return name;
                         });

TEST_P(EveryTechnique, NamesItselfAndItsGuarantee) {
  const Impostor impostor = baked(crumpled_scene(1), cells()[0]);
  EXPECT_EQ(impostor.technique, GetParam());
  EXPECT_EQ(technique_named(technique_name(GetParam())), GetParam());
  EXPECT_EQ(technique_names()[static_cast<std::size_t>(GetParam())], technique_name(GetParam()));
  EXPECT_EQ(guarantee_name(impostor), is_mesh(GetParam()) ? "none" : "nearest");
  EXPECT_FALSE(impostor.empty());
}

TEST_P(EveryTechnique, SameRequestSameBytes) {
  for (const ViewCell& cell : cells()) {
    const Scene scene = crumpled_scene(2);
    const Impostor a = baked(scene, cell), b = baked(scene, cell);
    EXPECT_EQ(a.texels, b.texels);
    const TexturedMesh of_a = textured_mesh(a), of_b = textured_mesh(b);
    EXPECT_EQ(of_a.indices, of_b.indices);
    ASSERT_EQ(of_a.vertices.size(), of_b.vertices.size());
    for (std::size_t i = 0; i < of_a.vertices.size(); ++i) {
      EXPECT_EQ(of_a.vertices[i].offset, of_b.vertices[i].offset);
      EXPECT_EQ(of_a.vertices[i].texel, of_b.vertices[i].texel);
    }
  }
}

TEST_P(EveryTechnique, TexelsLieWithinChartsAndChartsInTheAtlas) {
  for (const ViewCell& cell : cells()) {
    const Impostor impostor = baked(crumpled_scene(3), cell);
    const TexturedMesh mesh = textured_mesh(impostor);
    std::uint64_t texels = 0;
    for (const Chart& chart : mesh.charts) {
      texels += std::uint64_t{chart.width} * chart.height;
      for (std::uint32_t i = 0; i < chart.index_count; ++i) {
        const std::uint32_t index = mesh.indices.at(chart.first_index + i);
        ASSERT_LT(index, chart.vertex_count);
        const Vec2 texel = mesh.vertices.at(chart.first_vertex + index).texel;
        EXPECT_TRUE(texel.x >= 0.0 && texel.y >= 0.0 && texel.x <= chart.width && texel.y <= chart.height);
      }
    }
    EXPECT_EQ(texels, impostor.texel_count());
    const ImpostorSet set = pack_atlas({impostor});
    ASSERT_EQ(set.slots.at(0).size(), mesh.charts.size());
    for (std::size_t i = 0; i < mesh.charts.size(); ++i) {
      const AtlasSlot& slot = set.slots[0][i];
      EXPECT_LE(slot.x + mesh.charts[i].width, static_cast<std::uint32_t>(set.pages.at(slot.page).width));
      EXPECT_LE(slot.y + mesh.charts[i].height, static_cast<std::uint32_t>(set.pages.at(slot.page).height));
    }
  }
}

TEST_P(EveryTechnique, TrianglesLieInFrontOfTheViewCell) {
  for (const ViewCell& cell : cells()) {
    const Impostor impostor = baked(crumpled_scene(4), cell);
    const Vec3 nearest = impostor.frame.reference_viewpoint;
    const double border = 60.0;  // of both cells, along +z
    for (const ImpostorVertex& vertex : textured_mesh(impostor).vertices) {
      EXPECT_LT((nearest + vertex.offset).z, border);
      EXPECT_GT(glm::dot(vertex.offset, impostor.frame.forward), 0.0);
    }
  }
}

TEST_P(EveryTechnique, NothingToSeeGivesAnEmptyImpostor) {
  test::SmallScene scene;
  scene.add_object({{Vec3(0, 0, 0), Vec3(1, 1, 0), Vec3(2, 2, 0)}});  // no area: no ray hits it
  const Impostor impostor = baked(scene.scene, cells()[0]);
  EXPECT_TRUE(impostor.empty());
  EXPECT_EQ(textured_mesh(impostor).triangle_count(), 0U);
}

TEST_P(EveryTechnique, RefusesWithTheReason) {
  const Scene scene = crumpled_scene(5);
  const auto expect_refusal = [&](const BakeRequest& request, const BakeQuality& quality, ErrorWord word, const std::string& why) {
    try {
      static_cast<void>(bake_impostor(scene, TexturePyramids(scene), GetParam(), request, Camera{}, quality));
      FAIL() << why;
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.word(), word);
      EXPECT_NE(std::string(failure.what()).find(why), std::string::npos) << failure.what();
    }
  };
  BakeQuality small;
  small.max_resolution = 4;
  expect_refusal({{}, cells()[0]}, {}, ErrorWord::kBadUsage, "without objects");
  expect_refusal({{7}, cells()[0]}, {}, ErrorWord::kBadUsage, "object 7 of a scene with 2");
  expect_refusal({{0, 1}, Box{Vec3(-9.0), Vec3(9.0)}}, {}, ErrorWord::kImpostorImpossible, "reaches into the view cell");
  expect_refusal({{0, 1}, cells()[0]}, small, ErrorWord::kImpostorImpossible, "texture too large");
}

}  // namespace
}  // namespace standin
