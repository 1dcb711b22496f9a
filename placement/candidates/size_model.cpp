#include "placement/candidates/size_model.h"

#include <algorithm>
#include <cmath>

namespace standin {
namespace {

constexpr double kPriorSamples = 0.05;  // weight of the default slopes

constexpr double kCautious = 0.9;  // share of bakes that stay within a margin

using Coefficients = std::array<double, 3>;

double predicted_log(const Coefficients& b, const SizeInput& input) {
  return b[0] + b[1] * std::log(input.silhouette_texels) + b[2] * std::log(input.layers);
}

/// Area of a box's shadow along a unit direction.
double projected_area_m2(const Box& box, const Vec3& direction) {
  const Vec3 size = box.size();
  return std::abs(direction.x) * size.y * size.z + std::abs(direction.y) * size.x * size.z + std::abs(direction.z) * size.x * size.y;
}

/// From the objects to the viewers.
Vec3 viewing_direction(const Box& object_bounds, const ViewCell& cell) {
  if (const auto* shaft = std::get_if<Shaft>(&cell)) return shaft->axis;
  const Vec3 towards = std::get<Box>(cell).centre() - object_bounds.centre();
  const double length = glm::length(towards);
  return length > 0.0 ? towards / length : Vec3(0.0, 0.0, 1.0);
}

/// Normal equations about the prior slopes; `skip` leaves one sample out.
template <class Target>
Coefficients fit(std::span<const SizeSample> samples, std::size_t skip, const Coefficients& prior, Target&& log_target) {
  Mat3 normal(0.0);
  Vec3 right(0.0);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i == skip) continue;
    const Vec3 row(1.0, std::log(samples[i].input.silhouette_texels), std::log(samples[i].input.layers));
    normal += glm::outerProduct(row, row);
    right += row * (log_target(samples[i]) - predicted_log(prior, samples[i].input));
  }
  for (int i = 0; i < 3; ++i) normal[i][i] += i == 0 ? 1e-9 : kPriorSamples;
  const Vec3 change = glm::inverse(normal) * right;
  return {prior[0] + change.x, prior[1] + change.y, prior[2] + change.z};
}

double log_bytes(const SizeSample& sample) {
  return std::log(sample.baked.bytes);
}
double log_quads(const SizeSample& sample) {
  return std::log(sample.baked.quads);
}

/// baked / predicted by the model of all other samples.
template <class Target>
std::vector<double> held_out_ratios(std::span<const SizeSample> samples, const Coefficients& prior, Target&& log_target) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < samples.size(); ++i)
    ratios.push_back(std::exp(log_target(samples[i]) - predicted_log(fit(samples, i, prior, log_target), samples[i].input)));
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

}  // namespace

SizeInput size_input(const Scene& scene, std::span<const std::uint32_t> objects, const Box& object_bounds, const ViewCell& cell,
                     const ImpostorSketch& sketch) {
  const Vec3 direction = viewing_direction(object_bounds, cell);
  double area_m2 = 0.0;
  for (const std::uint32_t object : objects) area_m2 += projected_area_m2(scene.objects[object].bounds, direction);
  // The texture's box holds the whole cluster; the objects' share of it is their share of the cluster's shadow.
  const double cluster_m2 = projected_area_m2(object_bounds, direction);
  const double share = cluster_m2 > 0.0 ? std::min(1.0, area_m2 / cluster_m2) : 1.0;
  return {std::max(1.0, share * sketch.width_texels * sketch.height_texels), std::max(1.0, sketch.layers)};
}

SizeEstimate estimate_size(const SizeModel& model, const SizeInput& input) {
  return {std::max(4.0, std::exp(predicted_log(model.log_bytes, input))), std::max(1.0, std::exp(predicted_log(model.log_quads, input)))};
}

// Near texels = 1.25 (1.3 S + 1.5 N sqrt S) and quads = N (1 + 0.04 N), which reproduce thesis Table 4.1 within a quarter, for S of 1e3 to
// 1e4 and N of 1 to 100.
SizeModel default_size_model() {
  SizeModel model;
  model.log_bytes = {2.3, 0.9, 0.33};
  model.log_quads = {0.04, 0.0, 1.34};
  return model;
}

SizeModel fit_sizes(std::span<const SizeSample> samples) {
  SizeModel model = default_size_model();
  if (samples.empty()) return model;
  const SizeModel prior = model;
  model.log_bytes = fit(samples, samples.size(), prior.log_bytes, log_bytes);
  model.log_quads = fit(samples, samples.size(), prior.log_quads, log_quads);
  const auto bytes_ratios = held_out_ratios(samples, prior.log_bytes, log_bytes);
  model.bytes_margin = std::max(1.0, quantile(bytes_ratios, kCautious));
  model.quads_margin = std::max(1.0, quantile(held_out_ratios(samples, prior.log_quads, log_quads), kCautious));
  model.median_error = median_error(bytes_ratios);
  model.bakes = static_cast<std::uint32_t>(samples.size());
  return model;
}

}  // namespace standin
