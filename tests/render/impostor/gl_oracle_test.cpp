// The recorder against the device it replaces: every layer once more, drawn by OpenGL between its near and far plane (the thesis' N
// passes).
//
// A device samples texel centres, and snaps corners to 1/256 of a pixel. So closed coverage must hold every texel the device draws, without
// exception; centre coverage must be the device's but for texels whose centre lies that close to an edge or a layer's border, of which the
// share is stated and bounded; and colours must agree where the surface is seen at the centre.
#include <gtest/gtest.h>

#include <cstdio>

#include "render/impostor/recorder.h"
#include "render/scene/shading.h"
#include "tests/render/impostor/small_scene.h"
#include "tests/support/gl_layers.h"

namespace standin::test {
namespace {

constexpr std::uint32_t kSide = 96;

/// Looks along a skew direction, with texels of different width and height.
ImpostorFrame skew_frame() {
  ImpostorFrame frame;
  frame.reference_viewpoint = {3.0, -2.0, 5.0};
  frame.forward = glm::normalize(Vec3(1.0, 0.3, -2.0));
  frame.right = glm::normalize(glm::cross(frame.forward, Vec3(0.0, 1.0, 0.0)));
  frame.up = glm::cross(frame.right, frame.forward);
  frame.slope_min = {-0.55, 0.6};
  frame.slope_step = {1.15 / kSide, 1.1 / kSide};
  frame.width = frame.height = kSide;
  return frame;
}

/// Six layers whose ranges adjoin, from 4 m to 14 m.
std::vector<Layer> six_layers() {
  const double borders[] = {4.0, 5.0, 6.25, 7.75, 9.5, 11.5, 14.0};
  std::vector<Layer> layers;
  for (std::size_t i = 0; i < 6; ++i) layers.push_back({0.5 * (borders[i] + borders[i + 1]), borders[i], borders[i + 1]});
  return layers;
}

Vec3 in_world(const ImpostorFrame& frame, const Vec3& p) {
  return frame.reference_viewpoint + p.x * frame.right + p.y * frame.up + p.z * frame.forward;
}

/// Triangles of 1 to 4 m within the layers' range, most of them crossing several layers, each an object of its own colour.
SmallScene random_scene(std::uint64_t seed, bool unlit, int texture = -1) {
  Rng rng(seed);
  const ImpostorFrame frame = skew_frame();
  SmallScene scene;
  for (int i = 0; i < 60; ++i) {
    const double depth = rng.uniform(6.0, 12.0), size = rng.uniform(0.5, 2.0);
    const Vec3 middle(depth * rng.uniform(-0.6, 0.6), depth * rng.uniform(-0.6, 0.6), depth);
    WorldTriangle triangle;
    for (Vec3& corner : triangle)
      corner = in_world(frame, middle + Vec3(rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)));
    Material material;
    material.unlit = unlit;
    material.double_sided = true;  // the recorder draws both sides
    material.texture = texture;
    for (int c = 0; c < 3; ++c) material.base_colour[c] = static_cast<float>(rng.uniform(0.2, 1.0));
    scene.add_object({triangle}, material, {{Vec2(0.0), Vec2(3.0, 0.0), Vec2(0.0, 3.0)}});
  }
  return scene;
}

/// Smooth, so that the device's choice of level changes little.
Texture waves(int side) {
  Texture texture{"waves", side, side, {}};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      for (const double phase : {0.0, 2.0, 4.0, -1.0})
        texture.rgba.push_back(
            phase < 0.0 ? 255 : static_cast<std::uint8_t>(140.0 + 100.0 * std::sin(6.283185307179586 * (x + y) / side + phase)));
  return texture;
}

struct Differences {
  std::uint64_t drawn = 0;         // texels the device drew, over all layers
  std::uint64_t missed = 0;        // of these, transparent in the recorder's closed coverage
  std::uint64_t centre_other = 0;  // centre coverage says otherwise than the device
  std::uint64_t compared = 0;      // drawn by both with the surface at the centre
  std::uint64_t colour_other = 0;  // of these, further apart than the tolerance
  int greatest = 0;                // distance of colours among the others
};

int distance_of(const std::array<std::uint8_t, 4>& a, const std::uint8_t* b) {
  int greatest = 0;
  for (int c = 0; c < 3; ++c) greatest = std::max(greatest, std::abs(a[static_cast<std::size_t>(c)] - b[c]));
  return greatest;
}

void compare_layer(const LayerImage& closed, const LayerImage& centre, const Texture& device, int tolerance, Differences& sum) {
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const std::uint8_t* pixel = &device.rgba[4 * (std::size_t{y} * kSide + x)];
      const bool drawn = pixel[3] == 255;
      sum.drawn += drawn ? 1 : 0;
      sum.missed += drawn && !closed.get(x, y).opaque() ? 1 : 0;
      sum.centre_other += drawn != centre.get(x, y).opaque() ? 1 : 0;
      if (!drawn || !centre.get(x, y).opaque()) continue;
      ++sum.compared;
      const int distance = distance_of(closed.get(x, y).rgba, pixel);
      if (distance > tolerance)
        ++sum.colour_other;
      else
        sum.greatest = std::max(sum.greatest, distance);
    }
}

class GlOracle : public testing::Test {
 protected:
  Differences compare(const Scene& scene, int tolerance) {
    std::vector<std::uint32_t> objects(scene.objects.size());
    for (std::uint32_t i = 0; i < objects.size(); ++i) objects[i] = i;
    const ImpostorFrame frame = skew_frame();
    const std::vector<Layer> layers = six_layers();
    const TexturePyramids textures(scene);
    const auto closed = record_layers(scene, textures, objects, frame, layers, Coverage::kClosed);
    const auto centre = record_layers(scene, textures, objects, frame, layers, Coverage::kCentre);
    const auto device = draw_layers(*context_, scene, objects, frame, layers);
    Differences sum;
    for (std::size_t i = 0; i < layers.size(); ++i) compare_layer(closed[i], centre[i], device[i], tolerance, sum);
    std::printf("%llu texels drawn, %llu missed, %llu at an edge, %llu of %llu colours differ by more than %d (others by %d)\n",
                static_cast<unsigned long long>(sum.drawn), static_cast<unsigned long long>(sum.missed),
                static_cast<unsigned long long>(sum.centre_other), static_cast<unsigned long long>(sum.colour_other),
                static_cast<unsigned long long>(sum.compared), tolerance, sum.greatest);
    return sum;
  }

  void expect_same(const Scene& scene, int tolerance, std::uint64_t seed) {
    const Differences found = compare(scene, tolerance);
    EXPECT_GT(found.drawn, 2000U) << "seed " << seed;
    EXPECT_EQ(found.missed, 0U) << "seed " << seed;
    EXPECT_LE(found.centre_other, found.drawn / 200) << "seed " << seed;
    EXPECT_LE(found.colour_other, found.compared / 100) << "seed " << seed;
  }

 private:
  std::unique_ptr<Context> context_ = make_context(DeviceKind::kOsMesa, 16, 16);
};

TEST_F(GlOracle, UnlitTriangles) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) expect_same(random_scene(seed, true).scene, 0, seed);
}

TEST_F(GlOracle, LitTriangles) {
  for (std::uint64_t seed = 11; seed <= 13; ++seed) expect_same(random_scene(seed, false).scene, 1, seed);
}

TEST_F(GlOracle, TexturedTriangles) {
  for (std::uint64_t seed = 21; seed <= 23; ++seed) {
    SmallScene scene = random_scene(seed, true, 0);
    scene.scene.textures.push_back(waves(64));
    expect_same(scene.scene, 8, seed);  // llvmpipe takes one level of detail for 2 x 2 pixels
  }
}

}  // namespace
}  // namespace standin::test
