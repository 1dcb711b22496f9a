// Based on: P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild. FLIP: A Difference Evaluator for
// Alternating Images. Proc. ACM on Computer Graphics and Interactive Techniques 3(2), 2020 (section and equation numbers below). Constants
// as in the authors' reference implementation; filters are applied as the products of rows and columns that they are.
#include "render/image/image_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>

#include "render/base/error.h"

namespace standin {
namespace {

constexpr double kColourExponent = 0.7;      // q_c, section 4.3
constexpr double kColourKnee = 0.4;          // p_c: this share of the largest difference
constexpr double kColourAtKnee = 0.95;       // p_t: is mapped to this
constexpr double kFeatureExponent = 0.5;     // q_f, section 4.4
constexpr double kFeatureWidth_deg = 0.082;  // w: peak to trough of the detectors

using Colour = glm::dvec3;  // linear RGB, XYZ over white, YCxCz or L*a*b*
using Plane = std::vector<float>;

void check_comparable(const Texture& a, const Texture& b) {
  const auto whole = [](const Texture& t) {
    return t.rgba.size() == 4 * static_cast<std::size_t>(t.width) * static_cast<std::size_t>(t.height);
  };
  if (a.width > 0 && a.height > 0 && whole(a) && whole(b) && a.width == b.width && a.height == b.height) return;
  throw Failure(ErrorWord::kInternal, "images of " + std::to_string(a.width) + " x " + std::to_string(a.height) + " and " +
                                          std::to_string(b.width) + " x " + std::to_string(b.height) + " pixels cannot be compared");
}

// Pixels [x0, x0 + width) x [y0, y0 + height).
struct Region {
  int x0 = 0, y0 = 0, width = 0, height = 0;
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

// A 1D filter over [-radius, radius].
using Kernel = std::vector<double>;

Kernel sampled(int radius, const auto& function) {
  Kernel kernel;
  for (int x = -radius; x <= radius; ++x) kernel.push_back(function(static_cast<double>(x)));
  return kernel;
}

double sum(const Kernel& kernel) {
  double total = 0.0;
  for (const double weight : kernel) total += weight;
  return total;
}

Kernel scaled(Kernel kernel, double factor) {
  for (double& weight : kernel) weight *= factor;
  return kernel;
}

// Rows by `across`, then columns by `down`; the border repeats.
Plane filtered(const Plane& plane, int width, int height, const Kernel& across, const Kernel& down) {
  const int radius = static_cast<int>(across.size()) / 2;
  Plane rows(plane.size(), 0.0F);
  Plane padded(static_cast<std::size_t>(width + 2 * radius));
  for (int y = 0; y < height; ++y) {
    const float* from = plane.data() + static_cast<std::ptrdiff_t>(y) * width;
    for (int x = 0; x < width + 2 * radius; ++x) padded[static_cast<std::size_t>(x)] = from[std::clamp(x - radius, 0, width - 1)];
    float* to = rows.data() + static_cast<std::ptrdiff_t>(y) * width;
    for (std::size_t i = 0; i < across.size(); ++i) {
      const auto weight = static_cast<float>(across[i]);
      const float* shifted = padded.data() + i;
      for (int x = 0; x < width; ++x) to[x] += weight * shifted[x];
    }
  }
  Plane result(plane.size(), 0.0F);
  for (int y = 0; y < height; ++y) {
    float* to = result.data() + static_cast<std::ptrdiff_t>(y) * width;
    for (std::size_t i = 0; i < down.size(); ++i) {
      const auto weight = static_cast<float>(down[i]);
      const float* from = rows.data() + static_cast<std::ptrdiff_t>(std::clamp(y + static_cast<int>(i) - radius, 0, height - 1)) * width;
      for (int x = 0; x < width; ++x) to[x] += weight * from[x];
    }
  }
  return result;
}

// sRGB primaries; XYZ is over the white of D65 throughout.
constexpr Colour kWhite{0.950428545, 1.0, 1.088900371};

Colour xyz_of_linear(const Colour& c) {
  static const glm::dmat3 kMatrix = glm::transpose(glm::dmat3(10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0,
                                                              2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0,
                                                              1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0));
  return (kMatrix * c) / kWhite;
}

Colour linear_of_xyz(const Colour& c) {
  static const glm::dmat3 kInverse = glm::transpose(
      glm::dmat3(3.241003275, -1.537398934, -0.498615861, -0.969224334, 1.875930071, 0.041554224, 0.055639423, -0.204011202, 1.057148933));
  return kInverse * (c * kWhite);
}

Colour opponent(const Colour& xyz) {
  return {116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z)};
}

Colour xyz_of_opponent(const Colour& c) {
  const double y = (c.x + 16.0) / 116.0;
  return {y + c.y / 500.0, y, y - c.z / 200.0};
}

// L*a*b* with chroma scaled by lightness (Hunt, equation 3).
Colour hunt_lab(const Colour& linear) {
  constexpr double kDelta = 6.0 / 29.0;
  const Colour xyz = xyz_of_linear(linear);
  Colour f(0.0);
  for (int i = 0; i < 3; ++i) f[i] = xyz[i] > kDelta * kDelta * kDelta ? std::cbrt(xyz[i]) : xyz[i] / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
  const double lightness = 116.0 * f.y - 16.0;
  return {lightness, 0.01 * lightness * 500.0 * (f.x - f.y), 0.01 * lightness * 200.0 * (f.y - f.z)};
}

double hyab(const Colour& a, const Colour& b) {
  return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

// HyAB distances to [0, 1] (equation 4): linear up to the knee, the rest squeezed above it.
double colour_difference(const Colour& a, const Colour& b) {
  static const double kLargest = std::pow(hyab(hunt_lab({0.0, 1.0, 0.0}), hunt_lab({0.0, 0.0, 1.0})), kColourExponent);
  constexpr double kRest = 1.0 - kColourAtKnee;
  const double power = std::pow(hyab(a, b), kColourExponent);
  const double knee = kColourKnee * kLargest;
  return power < knee ? kColourAtKnee * power / knee : kColourAtKnee + kRest * (power - knee) / (kLargest - knee);
}

double linear_of_srgb(double encoded) {
  return encoded > 0.04045 ? std::pow((encoded + 0.055) / 1.055, 2.4) : encoded / 12.92;
}

// The part of a picture that is looked at, as Y, Cx and Cz.
std::array<Plane, 3> opponent_planes(const Texture& image, const Region& region) {
  static const std::array<double, 256> kLinear = [] {
    std::array<double, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = linear_of_srgb(static_cast<double>(i) / 255.0);
    return table;
  }();
  std::array<Plane, 3> planes;
  for (Plane& plane : planes) plane.reserve(region.size());
  for (int y = region.y0; y < region.y0 + region.height; ++y)
    for (int x = region.x0; x < region.x0 + region.width; ++x) {
      const std::uint8_t* pixel = image.rgba.data() + 4 * (static_cast<std::ptrdiff_t>(y) * image.width + x);
      const Colour colour = opponent(xyz_of_linear({kLinear[pixel[0]], kLinear[pixel[1]], kLinear[pixel[2]]}));
      for (int i = 0; i < 3; ++i) planes[static_cast<std::size_t>(i)].push_back(static_cast<float>(colour[i]));
    }
  return planes;
}

// Contrast sensitivity of a channel: a sum of two Gaussians, a * sqrt(pi / b) * exp(-pi^2 x^2 / b), x in degrees (table 1).
struct Sensitivity {
  double a1 = 0.0, b1 = 1.0, a2 = 0.0, b2 = 1.0;
};
constexpr std::array<Sensitivity, 3> kSensitivity = {{{1.0, 0.0047, 0.0, 1e-5}, {1.0, 0.0053, 0.0, 1e-5}, {34.1, 0.04, 13.5, 0.025}}};
constexpr double kWidest = 0.04;  // b

int sensitivity_radius(double pixels_per_degree) {
  return static_cast<int>(std::ceil(3.0 * std::sqrt(kWidest / (2.0 * std::numbers::pi * std::numbers::pi)) * pixels_per_degree));
}

int feature_radius(double pixels_per_degree) {
  return static_cast<int>(std::ceil(3.0 * 0.5 * kFeatureWidth_deg * pixels_per_degree));
}

Plane as_seen(const Plane& plane, const Region& region, const Sensitivity& s, double pixels_per_degree) {
  const int radius = sensitivity_radius(pixels_per_degree);
  const auto gaussian = [&](double b) {
    return sampled(radius, [&](double x) {
      const double degrees = x / pixels_per_degree;
      return std::exp(-std::numbers::pi * std::numbers::pi * degrees * degrees / b);
    });
  };
  const auto volume = [](double a, double b, const Kernel& kernel) {
    return a * std::sqrt(std::numbers::pi / b) * sum(kernel) * sum(kernel);
  };
  const Kernel first = gaussian(s.b1);
  const Kernel second = gaussian(s.b2);
  const double total = volume(s.a1, s.b1, first) + volume(s.a2, s.b2, second);
  const double share = volume(s.a1, s.b1, first) / total;
  Plane result = filtered(plane, region.width, region.height, scaled(first, share / sum(first)), scaled(first, 1.0 / sum(first)));
  if (s.a2 == 0.0) return result;
  const Plane rest =
      filtered(plane, region.width, region.height, scaled(second, (1.0 - share) / sum(second)), scaled(second, 1.0 / sum(second)));
  for (std::size_t i = 0; i < result.size(); ++i) result[i] += rest[i];
  return result;
}

// Positive weights sum to 1, negative ones to -1.
Kernel balanced(Kernel kernel) {
  double positive = 0.0, negative = 0.0;
  for (const double weight : kernel) (weight > 0.0 ? positive : negative) += std::abs(weight);
  for (double& weight : kernel) weight /= weight > 0.0 ? positive : negative > 0.0 ? negative : 1.0;
  return kernel;
}

// Lengths of the responses along rows and columns.
Plane magnitude(const Plane& lightness, const Region& region, const Kernel& detector, const Kernel& smooth) {
  Plane across = filtered(lightness, region.width, region.height, detector, smooth);
  const Plane down = filtered(lightness, region.width, region.height, smooth, detector);
  for (std::size_t i = 0; i < across.size(); ++i) across[i] = std::hypot(across[i], down[i]);
  return across;
}

// What the eye makes of a picture: colours, edges and points of each pixel.
struct Percept {
  std::vector<Colour> colours;
  Plane edges;
  Plane points;
};

Percept perceive(const Texture& image, const Region& region, double pixels_per_degree) {
  const std::array<Plane, 3> planes = opponent_planes(image, region);
  Percept result;
  std::array<Plane, 3> seen;
  for (std::size_t i = 0; i < 3; ++i) seen[i] = as_seen(planes[i], region, kSensitivity[i], pixels_per_degree);
  for (std::size_t i = 0; i < region.size(); ++i)
    result.colours.push_back(
        hunt_lab(glm::clamp(linear_of_xyz(xyz_of_opponent({seen[0][i], seen[1][i], seen[2][i]})), Colour(0.0), Colour(1.0))));
  Plane lightness = planes[0];
  for (float& y : lightness) y = (y + 16.0F) / 116.0F;
  const double deviation = 0.5 * kFeatureWidth_deg * pixels_per_degree;
  const auto gaussian = [&](double x) { return std::exp(-x * x / (2.0 * deviation * deviation)); };
  const int radius = feature_radius(pixels_per_degree);
  const Kernel plain = sampled(radius, gaussian);
  const Kernel smooth = scaled(plain, 1.0 / sum(plain));
  result.edges = magnitude(lightness, region, balanced(sampled(radius, [&](double x) { return -x * gaussian(x); })), smooth);
  result.points =
      magnitude(lightness, region,
                balanced(sampled(radius, [&](double x) { return (x * x / (deviation * deviation) - 1.0) * gaussian(x); })), smooth);
  return result;
}

bool same_colour(const Texture& a, const Texture& b, std::size_t pixel) {
  return std::equal(a.rgba.begin() + static_cast<std::ptrdiff_t>(4 * pixel), a.rgba.begin() + static_cast<std::ptrdiff_t>(4 * pixel + 3),
                    b.rgba.begin() + static_cast<std::ptrdiff_t>(4 * pixel));
}

// All pixels that differ and, `margin` around them, what their filters reach and see.
Region differing(const Texture& a, const Texture& b, int margin) {
  int x0 = a.width, y0 = a.height, x1 = 0, y1 = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      if (same_colour(a, b, static_cast<std::size_t>(y) * static_cast<std::size_t>(a.width) + static_cast<std::size_t>(x))) continue;
      x0 = std::min(x0, x), x1 = std::max(x1, x + 1), y0 = std::min(y0, y), y1 = std::max(y1, y + 1);
    }
  if (x0 >= x1) return {};
  x0 = std::max(0, x0 - margin), y0 = std::max(0, y0 - margin);
  return {x0, y0, std::min(a.width, x1 + margin) - x0, std::min(a.height, y1 + margin) - y0};
}

}  // namespace

double mean_error(const Texture& a, const Texture& b) {
  check_comparable(a, b);
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i)
    if (i % 4 != 3) total += static_cast<std::uint64_t>(std::abs(int{a.rgba[i]} - int{b.rgba[i]}));
  return static_cast<double>(total) / (255.0 * 3.0 * static_cast<double>(a.rgba.size() / 4));
}

std::vector<float> flip_map(const Texture& a, const Texture& b, double pixels_per_degree) {
  check_comparable(a, b);
  if (!(pixels_per_degree > 0.0))
    throw Failure(ErrorWord::kInternal, "pixels_per_degree = " + std::to_string(pixels_per_degree) + " violates: > 0");
  std::vector<float> map(a.rgba.size() / 4, 0.0F);
  const int reach = std::max(sensitivity_radius(pixels_per_degree), feature_radius(pixels_per_degree));
  const Region region = differing(a, b, 2 * reach);
  if (region.size() == 0) return map;
  const Percept first = perceive(a, region, pixels_per_degree);
  const Percept second = perceive(b, region, pixels_per_degree);
  for (std::size_t i = 0; i < region.size(); ++i) {
    const double colour = colour_difference(first.colours[i], second.colours[i]);
    const double edges = std::abs(double{first.edges[i]} - double{second.edges[i]});
    const double points = std::abs(double{first.points[i]} - double{second.points[i]});
    const double feature = std::pow(std::max(edges, points) / std::numbers::sqrt2, kFeatureExponent);
    const std::size_t row = static_cast<std::size_t>(region.y0) + i / static_cast<std::size_t>(region.width);
    const std::size_t column = static_cast<std::size_t>(region.x0) + i % static_cast<std::size_t>(region.width);
    map[row * static_cast<std::size_t>(a.width) + column] = static_cast<float>(colour > 0.0 ? std::pow(colour, 1.0 - feature) : 0.0);
  }
  return map;
}

double mean_flip(const Texture& a, const Texture& b, double pixels_per_degree) {
  const std::vector<float> map = flip_map(a, b, pixels_per_degree);
  double total = 0.0;
  for (const float error : map) total += double{error};
  return total / static_cast<double>(map.size());
}

}  // namespace standin
