#include "placement/candidates/size_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/impostor/atlas.h"

namespace standin {
namespace {

constexpr double kPriorSamples = 5.0;  // weight of the prior's slopes, against samples that spread by a factor e
constexpr int kReweightings = 8;
constexpr double kSmallDeviation = 0.05;  // deviations below it weigh as squares

constexpr double kCautious = 0.9;  // share of bakes that stay within a margin

constexpr double kGutters = 2.0 * AtlasOptions{}.gutter;  // on both sides

constexpr std::size_t kSlopes = 4;
using Row = std::array<double, kSlopes>;

/// What the slopes multiply. The last is 0 where an object lies in one layer: nothing is cut.
Row row_of(const SizeInput& input, double silhouette_texels) {
  const double cut = std::log((input.cut_texels + 2.0) / silhouette_texels);
  return {std::log(silhouette_texels), std::log(input.layers_crossed), std::log(input.layers), (1.0 - 1.0 / input.layers_crossed) * cut};
}
Row row_without_gutters(const SizeInput& input) {
  return row_of(input, input.silhouette_texels);
}
Row row_with_gutters(const SizeInput& input) {
  return row_of(input, input.block_texels);
}

double predicted_log(const SizeLaw& law, const Row& row) {
  double sum = law[0];
  for (std::size_t i = 0; i < kSlopes; ++i) sum += law[i + 1] * row[i];
  return sum;
}

/// Solves A x = b for a symmetric A whose eigenvalues are at least kPriorSamples (Cholesky).
Row solve(std::array<Row, kSlopes> a, Row b) {
  for (std::size_t j = 0; j < kSlopes; ++j) {
    for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
    a[j][j] = std::sqrt(a[j][j]);
    for (std::size_t i = j + 1; i < kSlopes; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      a[i][j] /= a[j][j];
    }
  }
  for (std::size_t i = 0; i < kSlopes; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (std::size_t i = kSlopes; i-- > 0;) {
    for (std::size_t k = i + 1; k < kSlopes; ++k) b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
  return b;
}

/// Samples of one target as the fit sees them.
struct Observation {
  Row row{};
  double log_value = 0.0;
  double weight = 1.0;
};

/// Weighted least squares about the prior. Variables are centred first, which leaves a system in the slopes alone: with the prior's weight
/// on its diagonal it is positive definite whatever the samples are, and as well conditioned as they spread at most, so that Cholesky on
/// the normal equations loses nothing that QR would keep.
SizeLaw fit_weighted(std::span<const Observation> observations, const SizeLaw& prior) {
  double total = 0.0, mean_rest = 0.0;
  Row mean{};
  for (const Observation& o : observations) {
    total += o.weight;
    mean_rest += o.weight * (o.log_value - predicted_log(prior, o.row));
    for (std::size_t i = 0; i < kSlopes; ++i) mean[i] += o.weight * o.row[i];
  }
  mean_rest /= total;
  for (double& m : mean) m /= total;

  std::array<Row, kSlopes> normal{};
  Row right{};
  for (std::size_t i = 0; i < kSlopes; ++i) normal[i][i] = kPriorSamples;
  for (const Observation& o : observations) {
    const double rest = o.log_value - predicted_log(prior, o.row) - mean_rest;
    for (std::size_t i = 0; i < kSlopes; ++i) {
      const double weighted = o.weight * (o.row[i] - mean[i]);
      right[i] += weighted * rest;
      for (std::size_t k = 0; k < kSlopes; ++k) normal[i][k] += weighted * (o.row[k] - mean[k]);
    }
  }
  const Row change = solve(normal, right);
  SizeLaw law = prior;
  law[0] += mean_rest;
  for (std::size_t i = 0; i < kSlopes; ++i) {
    law[i + 1] += change[i];
    law[0] -= change[i] * mean[i];
  }
  return law;
}

/// Least absolute deviations by reweighting: sizes are skewed (a slanted wall fills half its rectangle, and none fills twice), and what
/// ranks candidates is the median. Weights keep their mean, so that the prior's share stays what it is.
SizeLaw fit(std::vector<Observation> observations, const SizeLaw& prior) {
  if (observations.empty()) return prior;
  SizeLaw law = prior;
  for (Observation& o : observations) o.weight = 1.0;
  for (int round = 0; round < kReweightings; ++round) {
    law = fit_weighted(observations, prior);
    double sum = 0.0;
    for (Observation& o : observations)
      sum += o.weight = 1.0 / std::max(kSmallDeviation, std::abs(o.log_value - predicted_log(law, o.row)));
    for (Observation& o : observations) o.weight *= static_cast<double>(observations.size()) / sum;
  }
  return law;
}

std::vector<Observation> observe(std::span<const SizeSample> samples, Row (*row)(const SizeInput&), double SizeEstimate::*target) {
  std::vector<Observation> observations;
  for (const SizeSample& sample : samples) observations.push_back({row(sample.input), std::log(sample.baked.*target)});
  return observations;
}

/// baked / predicted by the law of all other samples.
std::vector<double> held_out_ratios(const std::vector<Observation>& observations, const SizeLaw& prior) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    std::vector<Observation> others = observations;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    ratios.push_back(std::exp(observations[i].log_value - predicted_log(fit(std::move(others), prior), observations[i].row)));
  }
  return ratios;
}

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double median_error(std::vector<double> ratios) {
  for (double& ratio : ratios) ratio = std::abs(1.0 / ratio - 1.0);
  return quantile(std::move(ratios), 0.5);
}

double margin_of(const std::vector<double>& ratios) {
  return std::max(1.0, quantile(ratios, kCautious));
}

/// What a set of points spans in slopes and depths from the sketch's viewpoint.
struct Span {
  Vec2 slope_min{std::numeric_limits<double>::infinity()};
  Vec2 slope_max{-std::numeric_limits<double>::infinity()};
  double near_m = std::numeric_limits<double>::infinity();
  double far_m = 0.0;
};

Span span_of(std::span<const Vec3> points, const ImpostorFrame& frame) {
  Span span;
  for (const Vec3& point : points) {
    const Vec3 offset = point - frame.reference_viewpoint;
    const double depth_m = glm::dot(offset, frame.forward);
    const Vec2 slope = Vec2(glm::dot(offset, frame.right), glm::dot(offset, frame.up)) / depth_m;
    span.slope_min = glm::min(span.slope_min, slope);
    span.slope_max = glm::max(span.slope_max, slope);
    span.near_m = std::min(span.near_m, depth_m);
    span.far_m = std::max(span.far_m, depth_m);
  }
  return span;
}

/// Whole texels, as the texture has them.
Vec2 rectangle_of(const Vec2& texels) {
  return glm::max(glm::ceil(texels - 1e-9), Vec2(1.0));
}
double area(const Vec2& rectangle, double gutters = 0.0) {
  return (rectangle.x + gutters) * (rectangle.y + gutters);
}

}  // namespace

SizeInput size_input(const Scene& scene, const ObjectOutlines& outlines, std::span<const std::uint32_t> objects,
                     const ImpostorSketch& sketch) {
  const double texel = sketch.frame.slope_step.x;
  const double e_folds = std::log(sketch.far_m / sketch.near_m);
  const double layers_per_e_fold = sketch.layers > 1.0 && e_folds > 0.0 ? sketch.layers / e_folds : 0.0;
  SizeInput input{0.0, 0.0, sketch.layers, 0.0, 0.0};
  for (const std::uint32_t object : objects) {
    const Span span = span_of(outlines.of(object), sketch.frame);
    const Vec2 rectangle = rectangle_of((span.slope_max - span.slope_min) / texel);
    const double block = area(rectangle, kGutters);
    input.silhouette_texels += area(rectangle);
    input.block_texels += block;
    input.layers_crossed += block * std::min(sketch.layers, 1.0 + layers_per_e_fold * std::log(span.far_m / span.near_m));
    input.cut_texels += scene.objects[object].area_m2 / (span.near_m * span.far_m) * (layers_per_e_fold / texel);
  }
  input.layers_crossed = std::max(1.0, input.layers_crossed / input.block_texels);
  const Vec2 whole(sketch.width_texels, sketch.height_texels);
  input.silhouette_texels = std::min(input.silhouette_texels, area(whole));
  input.block_texels = std::min(input.block_texels, area(whole, kGutters));
  return input;
}

SizeEstimate estimate_size(const SizeModel& model, const SizeInput& input) {
  constexpr double kLeastBytes = 4.0 * (1.0 + kGutters) * (1.0 + kGutters);
  const Row blocks = row_with_gutters(input), silhouette = row_without_gutters(input);
  return {std::max(kLeastBytes, std::exp(predicted_log(model.log_bytes, blocks))),
          std::max(1.0, std::exp(predicted_log(model.log_texels, silhouette))),
          std::max(1.0, std::exp(predicted_log(model.log_quads, silhouette)))};
}

// `impostor_sizes compare` prints these, for a generated city, a town model, a building and two race tracks (tests/bench/impostor_sizes.md
// has the commands). Bytes are 4 S' and drawn texels S, in one layer.
SizeModel default_size_model(Technique technique) {
  SizeModel model;
  if (technique == Technique::kLodSprite) {
    model.log_bytes = {1.677, 1.123, 0.363, -0.164, 0.058};
    model.log_texels = {0.379, 1.052, 0.492, -0.206, 0.136};
    model.log_quads = {0.335, 0.285, 0.437, 0.212, 0.215};
    return model;
  }
  if (technique == Technique::kDepthMesh) {
    // Its size follows the silhouette; layers matter little.
    model.log_bytes = {1.8, 1.0, 0.3, 0.0, 0.2};
    model.log_texels = {0.4, 1.0, 0.3, 0.0, 0.2};
    model.log_quads = {0.5, 0.3, 0.5, 0.5, 0.0};
    return model;
  }
  model.log_bytes = {1.406, 0.997, 0.627, 0.073, 0.309};
  model.log_texels = {-0.004, 1.002, 0.495, 0.086, 0.359};
  model.log_quads = {-0.303, 0.074, 0.570, 0.648, -0.117};
  return model;
}

SizeModel fit_sizes(std::span<const SizeSample> samples, const SizeModel& prior) {
  SizeModel model = prior;
  if (samples.empty()) return model;
  const auto bytes = observe(samples, row_with_gutters, &SizeEstimate::bytes);
  const auto texels = observe(samples, row_without_gutters, &SizeEstimate::texels);
  const auto quads = observe(samples, row_without_gutters, &SizeEstimate::quads);
  model.log_bytes = fit(bytes, prior.log_bytes);
  model.log_texels = fit(texels, prior.log_texels);
  model.log_quads = fit(quads, prior.log_quads);
  model.texels_margin = margin_of(held_out_ratios(texels, prior.log_texels));
  model.quads_margin = margin_of(held_out_ratios(quads, prior.log_quads));
  model.median_error = median_error(held_out_ratios(bytes, prior.log_bytes));
  model.bakes = static_cast<std::uint32_t>(samples.size());
  return model;
}

}  // namespace standin
