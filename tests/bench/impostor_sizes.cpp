// How well an impostor's bytes and quads are known before it is baked (impostor_sizes.md holds results).
//
//     impostor_sizes sample SCENE --target T [--count 300] [--share 0.6] [flags of place] > scene.csv
//     impostor_sizes compare A.csv B.csv ...
//
// `sample` generates candidates as the survey does (regions above `share` of the worst predicted time), bakes a spread of them and writes
// what was known before beside what came out. `compare` judges, scene by scene: the default model; a model fitted on all other files; the
// default fitted on 48 bakes of the scene, judged on the rest, as place does; and the proven lower bound. Last it prints the laws fitted on
// all files, which default_size_model() holds. `sample --techniques T` samples another technique; "default" in `compare` is the layered
// one's all the same.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <numeric>
#include <sstream>

#include "placement/candidates/size_model.h"
#include "render/base/error.h"
#include "render/impostor/size_bound.h"
#include "render/impostor/texture_pyramid.h"
#include "server/job/job_spec.h"
#include "server/job/world.h"

namespace standin {
namespace {

constexpr std::size_t kShippedBakes = 48;  // JobSpec::size_bakes

struct Arguments {
  std::string scene, target;
  std::uint32_t count = 300;
  double share = 0.6;
  JobSpec spec;
};

Arguments parse(int argc, char** argv) {
  Arguments arguments;
  arguments.spec.lods = "off";  // objects as the scene has them
  for (int i = 2; i < argc; ++i) {
    const std::string flag = argv[i];
    if (!flag.starts_with("--")) {
      arguments.scene = flag;
      continue;
    }
    if (i + 1 == argc) throw Failure(ErrorWord::kBadUsage, flag + " needs a value");
    const std::string value = argv[++i];
    const auto field = std::ranges::find(spec_fields(), flag, &SpecField::flag);
    if (flag == "--target")
      arguments.target = value;
    else if (flag == "--count")
      arguments.count = static_cast<std::uint32_t>(std::stoul(value));
    else if (flag == "--share")
      arguments.share = std::stod(value);
    else if (field != spec_fields().end())
      set_field_from_text(arguments.spec, *field, value);
    else
      throw Failure(ErrorWord::kBadUsage, "unknown flag " + flag);
  }
  return arguments;
}

Subdivision regions_above(const World& world, const TimeModel& model, double predicted_ms) {
  SubdivisionOptions options;
  options.threads = world.threads;
  options.predicted_budget_ms = predicted_ms;
  return subdivide(world.scene, world.hierarchy.rank, world.view_space, world.visibility, model, world.camera, world.view_space_options,
                   options, {});
}

std::vector<Candidate> candidates_of(const World& world, const TimeModel& model, const Arguments& arguments, StageClock& clock) {
  const double worst_ms = regions_above(world, model, std::numeric_limits<double>::infinity()).worst_predicted_ms;
  const Subdivision probe = regions_above(world, model, arguments.share * worst_ms);
  CandidateOptions options;
  options.threads = world.threads;
  SizeModels sizes;
  for (const Technique technique : techniques_of(arguments.spec)) sizes.offer(technique, default_size_model(technique));
  return clock
      .run("candidates",
           [&] { return generate_candidates(world.scene, world.hierarchy, probe, model, sizes, world.camera, world.quality, options, {}); })
      .candidates;
}

struct Row {
  SizeSample sample;
  double least_bytes = 0.0;  // proven
};

void print_row(const Row& row) {
  const auto& [input, baked] = row.sample;
  for (const double value : {input.silhouette_texels, input.block_texels, input.layers, input.layers_crossed, input.cut_texels, baked.bytes,
                             baked.texels, baked.quads})
    std::printf("%.17g,", value);
  std::printf("%.17g\n", row.least_bytes);
}

void sample(const Arguments& arguments) {
  const TimeModel model = read_target(arguments.target).model;
  World world;
  const WorkBudget budget;
  StageClock clock(budget);
  build_world(arguments.scene, arguments.spec, clock, {}, world);
  const std::vector<Candidate> candidates = candidates_of(world, model, arguments, clock);
  const ObjectOutlines outlines(world.scene);
  const TexturePyramids textures(world.scene);
  const BakeCandidate bake = candidate_baker(world.scene, textures, world.camera, world.quality, budget);
  const SizeBound bound = clock.run("prepare_bounds", [&] { return SizeBound(world.scene); });
  clock.run("bounds", [&] {
    double sum = 0.0;
    for (const Candidate& candidate : candidates)
      sum += bound.texture_bytes(candidate.objects, candidate.view_cell, world.camera, world.quality);
    return sum;
  });
  for (const std::uint32_t id : spread_of_candidates(candidates, arguments.count, arguments.spec.seed)) {
    const Candidate& candidate = candidates[id];
    const auto baked = bake_size_sample(world.scene, outlines, candidate, world.camera, world.quality, bake);
    const double least_bytes = bound.texture_bytes(candidate.objects, candidate.view_cell, world.camera, world.quality);
    if (baked) print_row({*baked, least_bytes});
  }
  std::fprintf(stderr, "%zu candidates, seconds %s\n", candidates.size(), clock.seconds().dump().c_str());
}

std::vector<Row> read_rows(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw Failure(ErrorWord::kFileMissing, file + " cannot be read");
  std::vector<Row> rows;
  for (std::string line; std::getline(stream, line);) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream fields(line);
    Row row;
    auto& [input, baked] = row.sample;
    for (double* value : {&input.silhouette_texels, &input.block_texels, &input.layers, &input.layers_crossed, &input.cut_texels,
                          &baked.bytes, &baked.texels, &baked.quads, &row.least_bytes})
      fields >> *value;
    if (!fields) throw Failure(ErrorWord::kFileBroken, file + ": \"" + line + "\"");
    rows.push_back(row);
  }
  if (rows.size() <= kShippedBakes) throw Failure(ErrorWord::kFileBroken, file + " holds too few samples: more than 48 are needed");
  return rows;
}

std::vector<SizeSample> samples_of(const std::vector<Row>& rows) {
  std::vector<SizeSample> samples;
  for (const Row& row : rows) samples.push_back(row.sample);
  return samples;
}

double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// Ties share the mean of their ranks.
std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  std::vector<double> rank(values.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
    for (std::size_t i = begin; i < end; ++i) rank[order[i]] = 0.5 * static_cast<double>(begin + end - 1);
  }
  return rank;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double n = static_cast<double>(a.size());
  const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / n, mean_b = std::accumulate(b.begin(), b.end(), 0.0) / n;
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return ab / std::sqrt(aa * bb);
}

/// One target of one model on one scene.
void print_figures(std::span<const SizeSample> judged, const SizeModel& model, double SizeEstimate::*target) {
  std::vector<double> estimated, real, errors;
  for (const SizeSample& s : judged) {
    estimated.push_back(estimate_size(model, s.input).*target);
    real.push_back(s.baked.*target);
    errors.push_back(std::abs(estimated.back() / real.back() - 1.0));
  }
  const double large = quantile(real, 0.75);
  std::vector<double> large_errors;
  for (std::size_t i = 0; i < real.size(); ++i)
    if (real[i] >= large) large_errors.push_back(errors[i]);
  std::printf(" %5.1f %% | %5.1f %% | %5.1f %% | %.3f |", 100.0 * quantile(errors, 0.5), 100.0 * quantile(errors, 0.9),
              100.0 * quantile(large_errors, 0.5), correlation(ranks(estimated), ranks(real)));
}

void print_line(const std::string& scene, const char* model_name, std::span<const SizeSample> judged, const SizeModel& model) {
  std::printf("| %s | %s | %zu |", scene.c_str(), model_name, judged.size());
  for (const auto target : {&SizeEstimate::bytes, &SizeEstimate::texels, &SizeEstimate::quads}) print_figures(judged, model, target);
  std::printf("\n");
}

void print_law(const char* name, const SizeLaw& law) {
  std::printf("%s:", name);
  for (const double b : law) std::printf(" %.3f", b);
  std::printf("\n");
}

/// As many as place bakes, evenly by size, and the rest.
void split(std::span<const SizeSample> all, std::vector<SizeSample>& fitted, std::vector<SizeSample>& judged) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool fits = (i + 1) * kShippedBakes / all.size() > i * kShippedBakes / all.size();
    (fits ? fitted : judged).push_back(all[i]);
  }
}

void print_bounds(const std::string& scene, const std::vector<Row>& rows) {
  std::vector<double> ratios, real;
  for (const Row& row : rows) {
    ratios.push_back(row.least_bytes / row.sample.baked.bytes);
    real.push_back(row.sample.baked.bytes);
  }
  std::vector<double> large_ratios;
  for (std::size_t i = 0; i < real.size(); ++i)
    if (real[i] >= quantile(real, 0.75)) large_ratios.push_back(ratios[i]);
  std::printf("| %s | %.3f | %.3f | %.3f | %.3f | %.3f |\n", scene.c_str(), quantile(ratios, 0.1), quantile(ratios, 0.5),
              quantile(ratios, 0.9), quantile(ratios, 1.0), quantile(large_ratios, 0.5));
}

void compare(const std::vector<std::string>& files) {
  std::vector<std::vector<SizeSample>> scenes;
  std::printf("| scene | lower bound / real: p10 | median | p90 | max | largest quarter's median |\n|---|---|---|---|---|---|\n");
  for (const std::string& file : files) {
    const std::vector<Row> rows = read_rows(file);
    print_bounds(file, rows);
    scenes.push_back(samples_of(rows));
  }
  std::printf("| scene | model | judged | bytes: median | p90 | largest quarter's median | rank corr. | texels: | | | | quads: | | | |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  std::vector<SizeSample> all;
  for (std::size_t scene = 0; scene < scenes.size(); ++scene) {
    all.insert(all.end(), scenes[scene].begin(), scenes[scene].end());
    std::vector<SizeSample> others, fitted, judged;
    for (std::size_t other = 0; other < scenes.size(); ++other)
      if (other != scene) others.insert(others.end(), scenes[other].begin(), scenes[other].end());
    split(scenes[scene], fitted, judged);
    const SizeModel from_others = fit_sizes(others, SizeModel{});
    print_line(files[scene], "default", scenes[scene], default_size_model());
    print_line(files[scene], "other scenes", scenes[scene], from_others);
    print_line(files[scene], "other scenes + 48 bakes", judged, fit_sizes(fitted, from_others));
  }
  const SizeModel model = fit_sizes(all, SizeModel{});
  print_law("log_bytes", model.log_bytes);
  print_law("log_texels", model.log_texels);
  print_law("log_quads", model.log_quads);
}

}  // namespace
}  // namespace standin

int main(int argc, char** argv) {
  try {
    const std::string mode = argc > 1 ? argv[1] : "";
    if (mode == "sample")
      standin::sample(standin::parse(argc, argv));
    else if (mode == "compare" && argc > 2)
      standin::compare({argv + 2, argv + argc});
    else
      throw standin::Failure(standin::ErrorWord::kBadUsage, "impostor_sizes sample SCENE --target T ... | compare FILE...");
  } catch (const standin::Failure& failure) {
    std::cerr << failure.what() << "\n";
    return 2;
  }
}
