#include "render/scene/city_textures.h"

#include <array>
#include <functional>
#include <string>

#include "render/base/rng.h"

namespace standin {
namespace {

struct Rgb {
  int r = 0;
  int g = 0;
  int b = 0;
};

constexpr std::array<Rgb, kFacadeColours> kWalls{
    {{214, 199, 160}, {196, 174, 150}, {183, 186, 176}, {222, 212, 196}, {190, 150, 122}, {168, 176, 186}}};
constexpr std::array<Rgb, kPaintColours> kPaints{
    {{168, 30, 34}, {32, 60, 118}, {210, 212, 214}, {38, 40, 44}, {92, 112, 96}, {196, 168, 72}}};

int clamped(int value) {
  return std::min(std::max(value, 0), 255);
}

Rgb lit(const Rgb& colour, int by) {
  return {clamped(colour.r + by), clamped(colour.g + by), clamped(colour.b + by)};
}

using Painter = std::function<std::array<int, 4>(int x, int y)>;

Texture painted(const std::string& name, int size, const Painter& painter) {
  Texture texture{name, size, size, {}};
  texture.rgba.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 4);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      for (const int channel : painter(x, y)) texture.rgba.push_back(static_cast<std::uint8_t>(clamped(channel)));
    }
  }
  return texture;
}

std::array<int, 4> opaque(const Rgb& c) {
  return {c.r, c.g, c.b, 255};
}

// Plaster with one window per cell of 64 x 64 texels; curtains, blinds and dark rooms in turn.
Texture facade(std::uint32_t colour, std::uint64_t seed) {
  Rng rng(seed, 100 + colour);
  std::array<int, kFacadeBays * kFacadeFloors> room{};
  for (int& tone : room) tone = static_cast<int>(rng.below(4)) * 22;
  const Rgb wall = kWalls[colour];
  return painted("facade_" + std::to_string(colour), 64 * kFacadeBays, [&](int x, int y) {
    const int u = x % 64;
    const int v = y % 64;
    const int grain = static_cast<int>(rng.below(13)) - 6;
    const bool frame = u >= 16 && u < 48 && v >= 10 && v < 54;
    const bool pane = u >= 19 && u < 45 && v >= 13 && v < 51 && u != 31 && u != 32 && v != 26;
    if (pane) return opaque(lit({52, 64, 78}, room[static_cast<std::size_t>(y / 64 * kFacadeBays + x / 64)] + (51 - v) / 2 + grain));
    if (frame) return opaque(lit({232, 230, 224}, grain));
    const bool joint = v >= 61;
    return opaque(lit(wall, grain * 2 - (joint ? 28 : 0)));
  });
}

// A plain colour with `grain` levels of noise.
Texture noisy(const std::string& name, int size, const Rgb& colour, int grain, std::uint64_t seed) {
  Rng rng(seed, 200);
  return painted(name, size, [&](int, int) {
    return opaque(lit(colour, static_cast<int>(rng.below(static_cast<std::uint64_t>(2 * grain + 1))) - grain));
  });
}

// Rows of stones or tiles, every second row shifted by half a tile.
Texture tiled(const std::string& name, const Rgb& colour, int width, int height, std::uint64_t seed) {
  Rng rng(seed, 300);
  return painted(name, 128, [&](int x, int y) {
    const int row = y / height;
    const bool joint = y % height == 0 || (x + (row % 2) * width / 2) % width == 0;
    return opaque(lit(colour, static_cast<int>(rng.below(21)) - 10 - (joint ? 40 : 0)));
  });
}

Texture bark(std::uint64_t seed) {
  Rng rng(seed, 400);
  std::array<int, 64> furrow{};
  for (int& depth : furrow) depth = static_cast<int>(rng.below(50));
  return painted("bark", 64, [&](int x, int) {
    return opaque(lit({104, 82, 62}, -furrow[static_cast<std::size_t>(x)] + static_cast<int>(rng.below(15))));
  });
}

// A twig of leaves: ellipses on a transparent ground whose colour is that of the leaves, so that filtering shows no fringe. More than half
// of it is opaque, or smaller mip levels would fall below the cutoff and far trees lose their leaves.
Texture leaves(std::uint64_t seed) {
  constexpr int kSize = 128;
  struct Leaf {
    int x, y, dx, dy, tone;
  };
  Rng rng(seed, 500);
  std::array<Leaf, 48> twig{};
  for (Leaf& leaf : twig) {
    const auto within = [&](std::uint64_t low, std::uint64_t high) { return static_cast<int>(low + rng.below(high - low)); };
    leaf = {within(14, 114), within(14, 114), within(0, 25) - 12, within(0, 25) - 12, within(0, 60) - 30};
    if (leaf.dx * leaf.dx + leaf.dy * leaf.dy < 64) leaf.dx = 11;
  }
  return painted("leaves", kSize, [&](int x, int y) -> std::array<int, 4> {
    const Rgb green{74, 112, 42};
    for (const Leaf& leaf : twig) {
      const int length2 = leaf.dx * leaf.dx + leaf.dy * leaf.dy;
      const int along = (x - leaf.x) * leaf.dx + (y - leaf.y) * leaf.dy;
      const int aside = (x - leaf.x) * leaf.dy - (y - leaf.y) * leaf.dx;
      if (along * along + 4 * aside * aside > length2 * length2 * 2) continue;
      const Rgb c = lit(green, leaf.tone - (std::abs(aside) < length2 / 12 ? 18 : 0));
      return {c.r, c.g, c.b, 255};
    }
    return {green.r, green.g, green.b, 0};
  });
}

Texture poster(std::uint64_t seed) {
  Rng rng(seed, 600);
  std::array<Rgb, 16> sheet{};
  for (Rgb& c : sheet)
    c = {static_cast<int>(90 + rng.below(160)), static_cast<int>(90 + rng.below(160)), static_cast<int>(90 + rng.below(160))};
  return painted("poster", 128, [&](int x, int y) {
    const bool text = x % 32 > 4 && x % 32 < 27 && y % 8 < 3 && y % 32 > 7;
    return opaque(lit(sheet[static_cast<std::size_t>(y / 32 * 4 + x / 32)], text ? -70 : 0));
  });
}

std::int32_t add_texture(Scene& scene, Texture texture) {
  scene.textures.push_back(std::move(texture));
  return static_cast<std::int32_t>(scene.textures.size() - 1);
}

void add_material(Scene& scene, const std::string& name, std::int32_t texture, const Rgb& colour = {255, 255, 255}) {
  Material material;
  material.name = name;
  material.texture = texture;
  material.base_colour = glm::vec4(glm::vec3(colour.r, colour.g, colour.b) / 255.0F, 1.0F);
  scene.materials.push_back(material);
}

}  // namespace

void add_city_materials(Scene& scene, std::uint64_t seed) {
  for (std::uint32_t i = 0; i < kFacadeColours; ++i)
    add_material(scene, "facade_" + std::to_string(i), add_texture(scene, facade(i, seed)));
  for (std::uint32_t i = 0; i < kPaintColours; ++i) add_material(scene, "paint_" + std::to_string(i), -1, kPaints[i]);
  add_material(scene, "roof", add_texture(scene, tiled("roof", {150, 84, 62}, 16, 8, seed)));
  add_material(scene, "trim", -1, {228, 222, 210});
  add_material(scene, "bark", add_texture(scene, bark(seed)));
  add_material(scene, "leaves", add_texture(scene, leaves(seed)));
  scene.materials.back().alpha_mode = AlphaMode::kMask;
  add_material(scene, "glass", -1, {44, 54, 66});
  add_material(scene, "tyre", -1, {30, 30, 32});
  add_material(scene, "metal", -1, {96, 104, 108});
  add_material(scene, "wood", add_texture(scene, noisy("wood", 64, {134, 98, 64}, 18, seed)));
  add_material(scene, "asphalt", add_texture(scene, noisy("asphalt", 128, {78, 78, 82}, 12, seed)));
  add_material(scene, "paving", add_texture(scene, tiled("paving", {162, 158, 150}, 32, 32, seed)));
  add_material(scene, "grass", add_texture(scene, noisy("grass", 128, {92, 124, 58}, 22, seed)));
  add_material(scene, "poster", add_texture(scene, poster(seed)));
}

std::uint32_t city_material(Surface surface, std::uint32_t colour) {
  if (surface == Surface::kFacade) return colour % kFacadeColours;
  if (surface == Surface::kPaint) return kFacadeColours + colour % kPaintColours;
  return kFacadeColours + kPaintColours + static_cast<std::uint32_t>(surface) - static_cast<std::uint32_t>(Surface::kRoof);
}

}  // namespace standin
