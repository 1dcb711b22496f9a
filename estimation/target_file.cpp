// Target files: "format": "standin.target". What is read has been checked: no number that is negative, not finite or missing gets past
// here.
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "estimation/learning_curve_json.h"
#include "estimation/time_model.h"
#include "render/base/error.h"
#include "render/base/json_text.h"
#include "render/base/sha256.h"
#include "render/base/staged_file.h"

namespace standin {
namespace {

using Json = nlohmann::json;
constexpr const char* kFormat = "standin.target";
constexpr int kVersion = 2;  // 1: other terms

/// Reads members of a JSON object, naming file and place in every complaint.
class Reader {
 public:
  Reader(const Json& json, std::string place) : json_(json), place_(std::move(place)) {
    if (!json.is_object()) fail("is not an object");
  }

  [[nodiscard]] const Json& member(const std::string& key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) fail("has no \"" + key + "\"");
    return *found;
  }
  [[nodiscard]] Reader object(const std::string& key) const { return {member(key), place_ + "/" + key}; }
  [[nodiscard]] std::string text(const std::string& key) const {
    if (!member(key).is_string()) fail("\"" + key + "\" is not a string");
    return member(key).get<std::string>();
  }
  [[nodiscard]] std::vector<std::string> texts(const std::string& key) const {
    std::vector<std::string> result;
    for (const Json& entry : array(key)) {
      if (!entry.is_string()) fail("\"" + key + "\" holds something else than strings");
      result.push_back(entry.get<std::string>());
    }
    return result;
  }
  [[nodiscard]] double number(const std::string& key) const {
    const Json& value = member(key);
    const double number = value.is_number() ? value.get<double>() : -1.0;
    if (!(number >= 0.0) || std::isinf(number)) fail("\"" + key + "\" is " + value.dump() + ", not a finite number >= 0");
    return number;
  }
  /// A number, or null for infinity.
  [[nodiscard]] double number_or_infinity(const std::string& key) const {
    return member(key).is_null() ? std::numeric_limits<double>::infinity() : number(key);
  }
  [[nodiscard]] const Json& array(const std::string& key) const {
    if (!member(key).is_array()) fail("\"" + key + "\" is not a list");
    return member(key);
  }
  [[nodiscard]] const std::string& place() const { return place_; }
  [[noreturn]] void fail(const std::string& what) const { throw Failure(ErrorWord::kFileBroken, "target file " + place_ + ": " + what); }

 private:
  const Json& json_;
  std::string place_;
};

Json null_if_infinite(double number) {
  return std::isinf(number) ? Json(nullptr) : Json(number);
}

Combination read_combination(const Reader& model) {
  const std::string word = model.text("combination");
  if (word != "sum" && word != "max") model.fail("\"combination\" is \"" + word + "\", not \"sum\" or \"max\"");
  return word == "sum" ? Combination::kSum : Combination::kMax;
}

std::vector<BoundStep> read_bound_steps(const Reader& model) {
  std::vector<BoundStep> steps;
  for (const Json& entry : model.array("bound_steps")) {
    const Reader step(entry, model.place() + "/bound_steps/" + std::to_string(steps.size()));
    steps.push_back({step.number_or_infinity("until_ms"), step.number("factor")});
    if (steps.size() > 1 && !(steps[steps.size() - 2].until_ms < steps.back().until_ms)) step.fail("\"until_ms\" does not ascend");
  }
  if (steps.empty() || !std::isinf(steps.back().until_ms)) model.fail("\"bound_steps\" do not end in infinity (null)");
  return steps;
}

TimeModel read_model(const Reader& json) {
  TimeModel model;
  const Reader terms = json.object("milliseconds_per_unit");
  for (std::size_t i = 0; i < kTermCount; ++i) model.milliseconds_per_unit[i] = terms.number(std::string(term_name(static_cast<Term>(i))));
  model.combination = read_combination(json);
  model.bound_steps = read_bound_steps(json);
  model.coverage = json.number("coverage");
  if (!(model.coverage > 0.0 && model.coverage < 1.0)) json.fail("\"coverage\" is not between 0 and 1");
  return model;
}

Json model_json(const TimeModel& model) {
  Json terms = Json::object();
  for (std::size_t i = 0; i < kTermCount; ++i) terms[std::string(term_name(static_cast<Term>(i)))] = model.milliseconds_per_unit[i];
  Json steps = Json::array();
  for (const BoundStep& step : model.bound_steps) steps.push_back({{"until_ms", null_if_infinite(step.until_ms)}, {"factor", step.factor}});
  return {{"milliseconds_per_unit", terms},
          {"combination", model.combination == Combination::kSum ? "sum" : "max"},
          {"bound_steps", steps},
          {"coverage", model.coverage}};
}

std::uint32_t count_of(const Reader& json, const std::string& key) {
  return static_cast<std::uint32_t>(std::min(json.number(key), 4294967295.0));
}

std::vector<LearningPoint> read_learning_curve(const Reader& quality) {
  std::vector<LearningPoint> curve;
  for (const Json& entry : quality.array("learning_curve")) {
    const Reader point(entry, quality.place() + "/learning_curve/" + std::to_string(curve.size()));
    curve.push_back({point.number("seconds"), count_of(point, "frames"), point.number("median_error"), point.number("p90_error"),
                     point.number("coverage"), point.number("bound_over_measured_median")});
  }
  return curve;
}

void check_format(const Json& json, const std::filesystem::path& file) {
  const Json format = json.is_object() ? json.value("format", Json()) : Json();
  const Json version = json.is_object() ? json.value("version", Json()) : Json();
  if (format == kFormat && version == kVersion) return;
  throw Failure(ErrorWord::kTargetUnreadable, "target file " + file.string() + " is of format " + format.dump() + ", version " +
                                                  version.dump() + "; this program reads \"" + kFormat + "\", version " +
                                                  std::to_string(kVersion));
}

}  // namespace

Target read_target(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  const Json json = parse_json(bytes, "target file " + file.string());
  check_format(json, file);
  const Reader root(json, file.string());
  Target target;
  target.sha256 = sha256_hex(bytes);
  target.id = root.text("id");
  target.model = read_model(root.object("model"));
  const Reader machine = root.object("machine");
  target.machine.device = machine.text("device");
  target.machine.renderer = machine.text("renderer");
  target.machine.gl_version = machine.text("gl_version");
  target.machine.processor = machine.text("processor");
  target.machine.reference_ms = machine.number("reference_ms");
  if (!(target.machine.reference_ms > 0.0)) machine.fail("\"reference_ms\" is 0, which violates: > 0");
  target.machine.clock = machine.text("clock");
  if (target.machine.clock != "thread_cpu" && target.machine.clock != "wall")
    machine.fail("\"clock\" is \"" + target.machine.clock + "\", not thread_cpu or wall");
  const Reader quality = root.object("quality");
  target.samples = count_of(quality, "samples");
  target.median_error = quality.number("median_error");
  target.p90_error = quality.number("p90_error");
  target.measured_coverage = quality.number("measured_coverage");
  target.left_out = quality.texts("left_out");
  target.learning_curve = read_learning_curve(quality);
  return target;
}

void write_target(const Target& target, const std::filesystem::path& file) {
  const Json json = {{"format", kFormat},
                     {"version", kVersion},
                     {"id", target.id},
                     {"machine",
                      {{"device", target.machine.device},
                       {"renderer", target.machine.renderer},
                       {"gl_version", target.machine.gl_version},
                       {"processor", target.machine.processor},
                       {"reference_ms", target.machine.reference_ms},
                       {"clock", target.machine.clock}}},
                     {"model", model_json(target.model)},
                     {"quality",
                      {{"samples", target.samples},
                       {"median_error", target.median_error},
                       {"p90_error", target.p90_error},
                       {"measured_coverage", target.measured_coverage},
                       {"left_out", target.left_out},
                       {"learning_curve", learning_curve_json(target.learning_curve)}}}};
  write_file(file, json.dump(2) + '\n');
}

}  // namespace standin
