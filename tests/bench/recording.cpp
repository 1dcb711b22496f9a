// How long recording a layered impostor takes, step by step, beside its untextured pass and the thesis' N passes of a graphics device.
//
//   recording [repeats]
//
// 60 textured balls of 100,920 triangles in 16 layers of 512 x 512 texels, one core. All columns are taken in turn, repeat by repeat, so
// that ratios hold on a busy machine; medians are printed.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <string>

#include "render/base/rng.h"
#include "render/device/context.h"
#include "render/device/renderer.h"
#include "render/impostor/culling.h"
#include "render/impostor/quads.h"
#include "render/impostor/recorder.h"
#include "tests/support/gl_layers.h"
#include "tests/support/scene_builder.h"

namespace standin {
namespace {

constexpr int kBalls = 60, kSegments = 58, kRings = 32;
constexpr std::uint32_t kSide = 512, kLayers = 16;

/// A ball of `rings` x `segments` quads, the polar ones triangles.
Mesh ball() {
  Mesh mesh;
  for (int ring = 0; ring <= kRings / 2; ++ring)
    for (int segment = 0; segment <= kSegments; ++segment) {
      const double polar = M_PI * ring / (kRings / 2), azimuth = 2.0 * M_PI * segment / kSegments;
      const Vec3 p(std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth));
      mesh.positions.emplace_back(p);
      mesh.normals.emplace_back(p);
      mesh.uvs.emplace_back(4.0 * segment / kSegments, 2.0 * ring / (kRings / 2));
    }
  const auto at = [](int ring, int segment) { return static_cast<std::uint32_t>(ring * (kSegments + 1) + segment); };
  for (int ring = 0; ring < kRings / 2; ++ring)
    for (int segment = 0; segment < kSegments; ++segment) {
      const std::uint32_t a = at(ring, segment), b = at(ring, segment + 1), c = at(ring + 1, segment), d = at(ring + 1, segment + 1);
      if (ring > 0) mesh.indices.insert(mesh.indices.end(), {a, b, d});
      if (ring + 1 < kRings / 2) mesh.indices.insert(mesh.indices.end(), {a, d, c});
    }
  return mesh;
}

Scene balls(bool textured) {
  Scene scene;
  Material material;
  if (textured) {
    Texture checks{"checks", 256, 256, {}};
    for (int i = 0; i < 256 * 256; ++i)
      for (const int c : {(i / 16 + i / 4096) % 2 * 200, i % 256, i / 256, 255}) checks.rgba.push_back(static_cast<std::uint8_t>(c));
    scene.textures.push_back(std::move(checks));
    material.texture = 0;
  }
  const auto mesh = test::add_mesh(scene, ball());
  const auto id = test::add_material(scene, material);
  Rng rng(3);
  for (int i = 0; i < kBalls; ++i) {
    const Mat4 placed = glm::translate(Mat4(1.0), Vec3(rng.uniform(-7.0, 7.0), rng.uniform(-7.0, 7.0), -rng.uniform(22.0, 38.0)));
    test::add_object(scene, mesh, id, placed);
  }
  update_derived(scene);
  return scene;
}

ImpostorFrame frame() {
  ImpostorFrame frame;
  frame.slope_min = {-0.4, 0.4};
  frame.slope_step = Vec2(0.8 / kSide);
  frame.width = frame.height = kSide;
  return frame;
}

std::vector<Layer> layers() {
  std::vector<Layer> result;
  for (std::uint32_t i = 0; i < kLayers; ++i)
    result.push_back({20.5 + 20.0 * i / kLayers, 20.0 + 20.0 * i / kLayers, 20.0 + 20.0 * (i + 1) / kLayers});
  return result;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

class Bench {
 public:
  template <class Step>
  auto time(const std::string& name, const Step& step) {
    const auto start = std::chrono::steady_clock::now();
    auto result = step();
    ms_[name].push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    return result;
  }
  [[nodiscard]] double ms(const std::string& name) const { return median(ms_.at(name)); }

 private:
  std::map<std::string, std::vector<double>> ms_;
};

std::vector<BitImage> culled(const std::vector<LayerImage>& images) {
  OcclusionCulling culling(kSide, kSide, CullRule::kCorner);
  std::vector<BitImage> visible;
  for (const LayerImage& image : images) {
    BitImage opaque(kSide, kSide);
    image.for_each_opaque([&](std::uint32_t x, std::uint32_t y) { opaque.set(x, y); });
    opaque -= culling.hidden_in_next(opaque);
    visible.push_back(std::move(opaque));
  }
  return visible;
}

std::size_t quads_of(const std::vector<BitImage>& visible) {
  std::size_t count = 0;
  for (std::uint32_t layer = 0; layer < visible.size(); ++layer) count += grow_quads(visible[layer], layer, {}).size();
  return count;
}

void run(int repeats) {
  const Scene textured = balls(true), plain = balls(false);
  const TexturePyramids textures(textured), none(plain);
  std::vector<std::uint32_t> objects(kBalls);
  for (std::uint32_t i = 0; i < kBalls; ++i) objects[i] = i;
  const auto context = make_context(DeviceKind::kOsMesa, static_cast<int>(kSide), static_cast<int>(kSide));
  Camera camera;
  camera.width = camera.height = static_cast<int>(kSide);
  Renderer renderer(*context, textured, camera);
  Bench bench;
  std::size_t quads = 0;
  for (int i = 0; i < repeats; ++i) {
    const auto images =
        bench.time("record", [&] { return record_layers(textured, textures, objects, frame(), layers(), Coverage::kClosed); });
    const auto visible = bench.time("cull", [&] { return culled(images); });
    quads = bench.time("quads", [&] { return quads_of(visible); });
    bench.time("untextured", [&] { return record_layers(plain, none, objects, frame(), layers(), Coverage::kClosed); });
    bench.time("centre", [&] { return record_layers(textured, textures, objects, frame(), layers(), Coverage::kCentre); });
    bench.time("N passes", [&] {
      for (const Layer& layer : layers()) (void)test::draw_layer(renderer, objects, frame(), layer);
      return 0;
    });
  }
  const double all = bench.ms("record") + bench.ms("cull") + bench.ms("quads");
  std::printf("%llu triangles, %u layers of %u x %u, %zu quads, %d repeats; median ms\n\n",
              static_cast<unsigned long long>(textured.triangle_count()), kLayers, kSide, kSide, quads, repeats);
  std::printf(
      "| record, textured, closed | cull | quads | all three | untextured pass | all / untextured | centre samples | device, N passes | N "
      "passes / all |\n|---|---|---|---|---|---|---|---|---|\n");
  std::printf("| %.1f | %.1f | %.1f | %.1f | %.1f | %.2f | %.1f | %.1f | %.2f |\n", bench.ms("record"), bench.ms("cull"), bench.ms("quads"),
              all, bench.ms("untextured"), all / bench.ms("untextured"), bench.ms("centre"), bench.ms("N passes"),
              bench.ms("N passes") / all);
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  standin::run(argc > 1 ? std::atoi(argv[1]) : 15);
}
