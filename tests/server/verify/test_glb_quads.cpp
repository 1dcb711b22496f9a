#include <gtest/gtest.h>

#include "render/base/error.h"
#include "server/verify/glb_quads.h"
#include "tests/server/verify/hand_made_glb.h"

namespace standin {
namespace {

using test::HandMadeGlb;
using test::write_glb;

void expect_broken(const std::string& bytes) {
  try {
    static_cast<void>(read_glb_quads(bytes));
    FAIL() << "read without complaint";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.word(), ErrorWord::kFileBroken) << failure.what();
  }
}

TEST(GlbQuads, ReadsPositionsTexelsAndAlpha) {
  const auto quads = read_glb_quads(
      write_glb({"imp_3", Vec3(1e6, 2, 3), "MASK", {{10.0, 0.5, 4, [](int column, int row) { return column == 1 && row == 2; }}}}));
  ASSERT_EQ(quads.impostors.size(), 1U);
  const GlbImpostor& impostor = quads.impostor("imp_3");
  EXPECT_EQ(impostor.origin, Vec3(1e6, 2, 3));
  ASSERT_EQ(impostor.triangles.size(), 2U);
  EXPECT_EQ(impostor.triangles[0].offsets[0], Vec3(-5, 5, -10));
  EXPECT_EQ(impostor.triangles[0].offsets[2], Vec3(5, -5, -10));
  EXPECT_EQ(impostor.triangles[0].texels[0], Vec2(0, 0));
  EXPECT_EQ(impostor.triangles[0].texels[2], Vec2(4, 4));
  ASSERT_EQ(quads.pages.size(), 1U);
  EXPECT_EQ(quads.pages[0].alpha_cutoff, 0.5);
  for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(quads.pages[0].rgba.at(4 * i + 3), i == 2 * 4 + 1 ? 255 : 0) << i;
}

TEST(GlbQuads, NamesAMissingNode) {
  const auto quads = read_glb_quads(write_glb({"imp_3", Vec3(0.0), "MASK", {{}}}));
  EXPECT_THROW(static_cast<void>(quads.impostor("imp_4")), Failure);
}

TEST(GlbQuads, RefusesBrokenFiles) {
  const std::string good = write_glb({"imp_0", Vec3(0.0), "MASK", {{}}});
  expect_broken("");
  expect_broken("no glTF at all, but long enough to hold a header");
  expect_broken(good.substr(0, good.size() / 2));
  expect_broken(write_glb({"imp_0", Vec3(0.0), "BLEND", {{}}}));
}

// Each of 60 nodes names the next one twice: without a look at what was visited, there are 2^60 ways down.
TEST(GlbQuads, RefusesNodesThatAreNoTree) {
  std::string nodes;
  for (int i = 1; i <= 60; ++i) nodes += R"({"children":[)" + std::to_string(i) + "," + std::to_string(i) + "]},";
  expect_broken(R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[)" + nodes + "{}]}");
}

}  // namespace
}  // namespace standin
