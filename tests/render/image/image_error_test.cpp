// FLIP against values worked out by hand, against its definition carried out pixel by pixel, and against what a measure of errors must do.
#include "render/image/image_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "render/base/error.h"
#include "render/base/rng.h"

namespace standin {
namespace {

using Colour = glm::dvec3;

Texture drawn(int width, int height, const std::function<glm::ivec3(int, int)>& colour) {
  Texture image{"drawn", width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::ivec3 c = colour(x, y);
      for (const int channel : {c.r, c.g, c.b, 255}) image.rgba.push_back(static_cast<std::uint8_t>(channel));
    }
  return image;
}

Texture plain(const glm::ivec3& colour, int size = 40) {
  return drawn(size, size, [&](int, int) { return colour; });
}

Texture picture(int width, int height) {
  return drawn(width, height, [](int x, int y) {
    const double wave = std::sin(0.21 * x) * std::cos(0.13 * y);
    return glm::ivec3(128 + 90 * wave, (7 * x + 3 * y) % 256, (x / 9 + y / 7) % 2 == 0 ? 40 : 210);
  });
}

Texture noisy(const Texture& image, double amplitude, std::uint64_t seed) {
  Rng rng(seed);
  Texture result = image;
  for (std::size_t i = 0; i < result.rgba.size(); ++i) {
    const double offset = rng.uniform(-amplitude, amplitude);
    if (i % 4 != 3) result.rgba[i] = static_cast<std::uint8_t>(std::clamp(image.rgba[i] + offset, 0.0, 255.0));
  }
  return result;
}

TEST(ImageError, MeanErrorCountsColourOnly) {
  Texture a{"a", 2, 1, {0, 0, 0, 0, 10, 20, 30, 255}};
  Texture b{"b", 2, 1, {255, 0, 0, 255, 10, 20, 30, 0}};
  EXPECT_DOUBLE_EQ(mean_error(a, b), 1.0 / 6.0);
  EXPECT_DOUBLE_EQ(mean_error(a, a), 0.0);
  b.width = 1;
  const std::function<double()> measures[] = {[&] { return mean_error(a, b); }, [&] { return mean_flip(a, b); }};
  for (const auto& measure : measures) try {
      (void)measure();
      FAIL() << "compared images of different sizes";
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.word(), ErrorWord::kInternal);
    }
}

TEST(Flip, TheSamePictureHasNoError) {
  const Texture image = picture(50, 30);
  EXPECT_EQ(mean_flip(image, image), 0.0);
}

// Plain pictures have no features and no detail to filter: all that is left is the colour difference, HyAB(a, b)^0.7 up to 0.4 of that of
// green and blue (41.276) linearly to 0.95, the rest above. Black and white are 100 apart: 0.95 + 0.05 (25.119 - 16.510) / 24.766.
TEST(Flip, PlainColoursAreTheirMappedDistance) {
  EXPECT_NEAR(mean_flip(plain({0, 0, 0}), plain({255, 255, 255})), 0.967380, 2e-4);
  EXPECT_NEAR(mean_flip(plain({0, 255, 0}), plain({0, 0, 255})), 1.0, 1e-5);
  EXPECT_NEAR(mean_flip(plain({128, 128, 128}), plain({160, 160, 160})), 0.333022, 2e-4);
}

TEST(Flip, IsSymmetric) {
  const Texture a = picture(60, 40), b = noisy(a, 40.0, 3);
  EXPECT_EQ(flip_map(a, b), flip_map(b, a));
}

TEST(Flip, GrowsWithNoise) {
  const Texture image = picture(80, 60);
  double before = 0.0;
  for (const double amplitude : {2.0, 5.0, 10.0, 20.0, 40.0, 80.0}) {
    const double error = mean_flip(image, noisy(image, amplitude, 7));
    EXPECT_GT(error, before) << amplitude;
    before = error;
  }
  EXPECT_LT(before, 1.0);
}

// The same amount of change is seen less where it alternates from pixel to pixel than in a patch; and all of it from nearby.
TEST(Flip, FineDetailIsSeenLessFromAfar) {
  const Texture grey = plain({120, 120, 120}, 60);
  const auto changed = [&](int cell) {
    return drawn(60, 60,
                 [&](int x, int y) { return (x / cell + y / cell) % 2 == 0 ? glm::ivec3(130, 115, 120) : glm::ivec3(110, 125, 120); });
  };
  EXPECT_NEAR(mean_error(grey, changed(1)), mean_error(grey, changed(10)), 1e-12);
  EXPECT_LT(mean_flip(grey, changed(1)), 0.7 * mean_flip(grey, changed(10)));
  EXPECT_GT(mean_flip(grey, changed(1), 10.0), mean_flip(grey, changed(1)));
}

// A line that vanishes counts for more than its colour.
TEST(Flip, MissingEdgesAndPointsStandOut) {
  const Texture grey = plain({120, 120, 120}, 41);
  const Texture line = drawn(41, 41, [](int x, int) { return x == 20 ? glm::ivec3(60) : glm::ivec3(120); });
  const std::vector<float> map = flip_map(grey, line);
  const float at_line = map[20 * 41 + 20];
  EXPECT_GT(at_line, 0.25F);
  EXPECT_EQ(map[20 * 41 + 5], 0.0F) << "out of reach of all filters";
}

TEST(Flip, IsZeroWhereNothingDiffersNearby) {
  const Texture a = picture(100, 100);
  Texture b = a;
  for (int c = 0; c < 3; ++c) b.rgba[static_cast<std::size_t>(4 * (50 * 100 + 50) + c)] ^= 0x80U;
  const std::vector<float> map = flip_map(a, b);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) {
      const float error = map[static_cast<std::size_t>(100 * y + x)];
      const int away = std::max(std::abs(x - 50), std::abs(y - 50));
      if (away > 10) {
        EXPECT_EQ(error, 0.0F) << x << " " << y;
      }
      if (away <= 2) {
        EXPECT_GT(error, 0.0F) << x << " " << y;
      }
    }
}

// The definition, step by step in double: two-dimensional kernels over all pixels.
namespace slow {

Colour xyz(const Colour& c) {
  const Colour rows[3] = {{0.4123866, 0.3575915, 0.1804505}, {0.2126369, 0.7151830, 0.0721802}, {0.0193306, 0.1191972, 0.9503726}};
  return Colour(glm::dot(rows[0], c) / 0.950428545, glm::dot(rows[1], c), glm::dot(rows[2], c) / 1.088900371);
}

Colour lab(const Colour& linear) {
  const auto f = [](double t) { return t > 216.0 / 24389.0 ? std::cbrt(t) : t * 841.0 / 108.0 + 4.0 / 29.0; };
  const Colour w = xyz(linear);
  const double l = 116.0 * f(w.y) - 16.0;
  return {l, l / 100.0 * 500.0 * (f(w.x) - f(w.y)), l / 100.0 * 200.0 * (f(w.y) - f(w.z))};
}

double hyab(const Colour& a, const Colour& b) {
  return std::abs(a.x - b.x) + std::sqrt((a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
}

struct Image {
  int width = 0, height = 0;
  std::vector<Colour> pixels;  // YCxCz
  [[nodiscard]] const Colour& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(std::clamp(y, 0, height - 1) * width + std::clamp(x, 0, width - 1))];
  }
};

Image opponent(const Texture& texture) {
  Image image{texture.width, texture.height, {}};
  for (std::size_t i = 0; i < texture.rgba.size(); i += 4) {
    Colour linear(0.0);
    for (int c = 0; c < 3; ++c) {
      const double s = texture.rgba[i + static_cast<std::size_t>(c)] / 255.0;
      linear[c] = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
    }
    const Colour w = xyz(linear);
    image.pixels.emplace_back(116.0 * w.y - 16.0, 500.0 * (w.x - w.y), 200.0 * (w.y - w.z));
  }
  return image;
}

using Weight = std::function<double(double x, double y)>;

double convolved(const Image& image, int channel, int x, int y, int radius, const Weight& weight, bool balanced) {
  double positive = 0.0, negative = 0.0, weights_up = 0.0, weights_down = 0.0;
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx) {
      const double w = weight(dx, dy);
      (w > 0.0 ? weights_up : weights_down) += std::abs(w);
      (w > 0.0 ? positive : negative) += w * image.at(x + dx, y + dy)[channel];
    }
  return balanced ? positive / weights_up + negative / weights_down : (positive + negative) / weights_up;
}

Colour seen(const Image& image, int x, int y, double ppd) {
  const double pi = std::numbers::pi;
  const auto radius = static_cast<int>(std::ceil(3.0 * std::sqrt(0.04 / (2.0 * pi * pi)) * ppd));
  const auto gaussian = [&](double a, double b, double r2) { return a * std::sqrt(pi / b) * std::exp(-pi * pi * r2 / b); };
  const auto channel = [&](int c, const auto& weight) {
    return convolved(
        image, c, x, y, radius, [&](double dx, double dy) { return weight((dx * dx + dy * dy) / (ppd * ppd)); }, false);
  };
  const double l = (channel(0, [&](double r2) { return gaussian(1.0, 0.0047, r2); }) + 16.0) / 116.0;
  const double cx = channel(1, [&](double r2) { return gaussian(1.0, 0.0053, r2); }) / 500.0;
  const double cz = channel(2, [&](double r2) { return gaussian(34.1, 0.04, r2) + gaussian(13.5, 0.025, r2); }) / 200.0;
  const glm::dmat3 rgb_of_xyz = glm::inverse(
      glm::transpose(glm::dmat3(0.4123866, 0.3575915, 0.1804505, 0.2126369, 0.7151830, 0.0721802, 0.0193306, 0.1191972, 0.9503726)));
  const Colour linear = rgb_of_xyz * Colour((l + cx) * 0.950428545, l, (l - cz) * 1.088900371);
  return lab(glm::clamp(linear, Colour(0.0), Colour(1.0)));
}

// Lengths of the responses to edges and to points.
std::pair<double, double> features(const Image& image, int x, int y, double ppd) {
  const double s = 0.5 * 0.082 * ppd;
  const auto radius = static_cast<int>(std::ceil(3.0 * s));
  const auto g = [&](double dx, double dy) { return std::exp(-(dx * dx + dy * dy) / (2.0 * s * s)); };
  const auto length = [&](const std::function<double(double)>& along) {
    const double across = convolved(
        image, 0, x, y, radius, [&](double dx, double dy) { return along(dx) * g(dx, dy); }, true);
    const double down = convolved(
        image, 0, x, y, radius, [&](double dx, double dy) { return along(dy) * g(dx, dy); }, true);
    return std::hypot(across, down) / 116.0;
  };
  return {length([](double d) { return -d; }), length([&](double d) { return d * d / (s * s) - 1.0; })};
}

double flip(const Image& a, const Image& b, int x, int y, double ppd) {
  const double largest = std::pow(hyab(lab({0, 1, 0}), lab({0, 0, 1})), 0.7);
  const double power = std::pow(hyab(seen(a, x, y, ppd), seen(b, x, y, ppd)), 0.7);
  const double colour = power < 0.4 * largest ? 0.95 * power / (0.4 * largest) : 0.95 + 0.05 * (power - 0.4 * largest) / (0.6 * largest);
  const auto [edges_a, points_a] = features(a, x, y, ppd);
  const auto [edges_b, points_b] = features(b, x, y, ppd);
  const double feature = std::sqrt(std::max(std::abs(edges_a - edges_b), std::abs(points_a - points_b)) / std::numbers::sqrt2);
  return std::pow(colour, 1.0 - feature);
}

}  // namespace slow

TEST(Flip, IsWhatItsDefinitionSays) {
  const Texture a = picture(37, 29);
  Texture b = noisy(a, 25.0, 11);
  for (int y = 8; y < 20; ++y)
    for (int c = 0; c < 3; ++c) b.rgba[static_cast<std::size_t>(4 * (37 * y + 15) + c)] = 250;
  const slow::Image slow_a = slow::opponent(a), slow_b = slow::opponent(b);
  for (const double pixels_per_degree : {kPixelsPerDegree, 30.0}) {
    const std::vector<float> map = flip_map(a, b, pixels_per_degree);
    for (int y = 0; y < 29; ++y)
      for (int x = 0; x < 37; ++x)
        EXPECT_NEAR(map[static_cast<std::size_t>(37 * y + x)], slow::flip(slow_a, slow_b, x, y, pixels_per_degree), 1e-4) << x << " " << y;
  }
}

}  // namespace
}  // namespace standin
