// Impostors that are no stack of planes: meshes before the reference viewpoint, judged like layers but for their depth range.
#include <gtest/gtest.h>

#include <cmath>

#include "render/base/error.h"
#include "render/base/rng.h"
#include "tests/server/verify/judged_panes.h"

namespace standin {
namespace {

using test::judged;
using test::kCamera;
using test::kFromOrigin;
using test::panes;
using test::SceneMaker;

// Slabs of a quarter of a metre from 8 to 14 m.
std::vector<Layer> quarter_slabs() {
  std::vector<Layer> layers;
  for (int i = 0; i < 24; ++i) layers.push_back({8.0 + 0.25 * i + 0.125, 8.0 + 0.25 * i, 8.25 + 0.25 * i});
  return layers;
}

JudgedImpostor judged_mesh(const Scene& scene) {
  JudgedImpostor impostor = judged(scene, quarter_slabs());
  impostor.technique = Technique::kDepthMesh;
  impostor.slope_step = Vec2(0.01);
  return impostor;
}

// A sheet of `side` x `side` quadrilaterals over x, y in [-2, 2] with its depth given; an opaque page.
using Depth = std::function<double(double x, double y)>;

struct Sheet {
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;
};

Sheet sheet(int side, const Depth& depth) {
  Sheet result;
  for (int j = 0; j <= side; ++j)
    for (int i = 0; i <= side; ++i) {
      const double x = 4.0 * i / side - 2.0, y = 4.0 * j / side - 2.0;
      result.positions.emplace_back(x, y, -depth(x, y));
    }
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (side + 1) + i), b = a + 1, c = a + static_cast<std::uint32_t>(side) + 1;
      result.indices.insert(result.indices.end(), {a, b, c, b, c + 1, c});
    }
  return result;
}

Scene scene_of(const Sheet& sheet) {
  SceneMaker maker;
  maker.add_object(maker.add_mesh(sheet.positions, sheet.indices), Mat4(1.0));
  return maker.take();
}

GlbQuads impostor_of(const Sheet& sheet) {
  GlbQuads quads;
  quads.pages.push_back({2, 2, std::vector<std::uint8_t>(16, 255)});
  GlbImpostor impostor{"imp_0", Vec3(0.0), {}};
  for (std::size_t i = 0; i < sheet.indices.size(); i += 3) {
    GlbTriangle triangle;
    for (std::size_t k = 0; k < 3; ++k) triangle.offsets[k] = Vec3(sheet.positions[sheet.indices[i + k]]);
    triangle.texels = {Vec2(0, 0), Vec2(2, 0), Vec2(0, 2)};
    impostor.triangles.push_back(triangle);
  }
  quads.impostors.push_back(std::move(impostor));
  return quads;
}

std::vector<View> around() {
  std::vector<View> views = {kFromOrigin};
  for (const Vec3& position : {Vec3(2, 1, 0), Vec3(-2, 1, -1), Vec3(0, -2, 1), Vec3(1.5, 1.5, 1.5)})
    views.push_back({position, glm::normalize(Vec3(0, 0, -11) - position)});
  return views;
}

ImpostorJudgement judge(const Scene& scene, const GlbQuads& quads, const std::vector<View>& views = around()) {
  return judge_impostor(scene, quads, judged_mesh(scene), kCamera, views, 1, {});
}

double tilted(double x, double /*y*/) {
  return 11.0 + x;
}

TEST(DepthMeshRays, AMeshOnItsSurfaceKeepsThePromise) {
  const Scene scene = scene_of(sheet(1, tilted));
  const auto result = judge(scene, impostor_of(sheet(7, tilted)));
  EXPECT_GT(result.pixels, 2000U);
  EXPECT_EQ(result.gap_pixels, 0U);
  EXPECT_EQ(result.baseless_pixels, 0U);
  EXPECT_LT(result.max_parallax_ratio, 1e-3);
  EXPECT_LT(*result.bloat_px(), 0.01);
}

// Every triangle once, and with it all that its neighbours share: no pixel may slip through.
TEST(DepthMeshRays, RoughSheetsDoNotLeak) {
  Rng rng(4);
  std::vector<double> heights;
  for (int i = 0; i < 61 * 61; ++i) heights.push_back(rng.uniform(10.0, 11.0));
  std::size_t next = 0;
  const Sheet rough = sheet(60, [&](double, double) { return heights[next++]; });
  const auto result = judge(scene_of(rough), impostor_of(rough));
  EXPECT_GT(result.pixels, 2000U);
  EXPECT_EQ(result.gap_pixels, 0U);
  EXPECT_LT(result.max_parallax_ratio, 0.01) << "the original's distances are float";
}

TEST(DepthMeshRays, AMissingTriangleIsAGap) {
  const Sheet flat = sheet(1, [](double, double) { return 10.1; });
  GlbQuads half = impostor_of(flat);
  half.impostors[0].triangles.pop_back();
  const auto result = judge(scene_of(flat), half, {kFromOrigin});
  EXPECT_NEAR(static_cast<double>(result.gap_pixels) / static_cast<double>(result.pixels), 0.5, 0.03);
}

// The shown point lies in the slab [10.25, 10.5], the pane at 10.1 m in the slab before: within the extended range, not within its own.
TEST(DepthMeshRays, TheDepthRangeReachesOneLayerFurther) {
  const Scene scene = panes({{2.0, 10.1}});
  const GlbQuads behind = impostor_of(sheet(1, [](double, double) { return 10.3; }));
  const View beside{Vec3(3, 0, 0), glm::normalize(Vec3(-3, 0, -10.2))};
  const Camera narrow{0.1, 64, 64, 0.1};
  JudgedImpostor impostor = judged_mesh(scene);
  // On the axis: the greatest angle in the narrow image is within 10 % of it.
  const double on_axis = std::atan(3.0 / 10.1) - std::atan(3.0 / 10.3);
  const auto mesh = judge_impostor(scene, behind, impostor, narrow, std::vector<View>{beside}, 1, {});
  EXPECT_EQ(mesh.baseless_pixels, 0U);
  EXPECT_EQ(mesh.gap_pixels, 0U);
  EXPECT_NEAR(mesh.max_parallax_ratio, on_axis / 0.01, 0.1 * on_axis / 0.01);
  impostor.technique = Technique::kLayered;
  const auto layered = judge_impostor(scene, behind, impostor, narrow, std::vector<View>{beside}, 1, {});
  EXPECT_EQ(layered.baseless_pixels, layered.shown_pixels);
}

TEST(DepthMeshRays, TooFarBehindIsAGapAndHasNoBase) {
  const Scene scene = panes({{1.9, 10.1}});
  const auto result = judge(scene, impostor_of(sheet(1, [](double, double) { return 11.3; })), {kFromOrigin});
  EXPECT_GT(result.pixels, 100U);
  EXPECT_EQ(result.gap_pixels, result.pixels);
  EXPECT_EQ(result.baseless_pixels, result.shown_pixels);
}

TEST(DepthMeshRays, RefusesTrianglesBehindTheReferenceViewpoint) {
  const Scene scene = panes({{2.0, 10.0}});
  const GlbQuads quads = impostor_of(sheet(2, [](double x, double) { return 10.0 * x; }));
  EXPECT_THROW(static_cast<void>(judge(scene, quads, {kFromOrigin})), Failure);
}

}  // namespace
}  // namespace standin
