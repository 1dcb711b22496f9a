#include "server/service/job_request.h"

#include <algorithm>
#include <array>
#include <set>

#include "render/base/error.h"
#include "render/impostor/impostor.h"
#include "server/http/message.h"
#include "server/job/value_check.h"

namespace standin {
namespace {

using nlohmann::json;

constexpr std::array<std::string_view, kJobKinds> kKindNames = {"survey", "place", "sweep", "calibrate", "verify", "bake"};
constexpr std::size_t kMostLabelBytes = 200;

const std::set<std::string> kServicesOwn = {
    "cache.folder", "cache.update", "scene.texture_folders", "scene.max_triangles", "scene.max_texels", "threads", "device"};

struct Needs {
  bool scene, target, budget;
};

// In the order of JobKind. A calibration without a scene takes the built-in ones.
constexpr std::array<Needs, kJobKinds> kNeeds = {
    {{true, true, false}, {true, true, true}, {true, true, false}, {false, false, false}, {false, false, false}, {true, false, false}}};

std::vector<ArgumentField> make_argument_fields() {
  json techniques = json::array();
  for (const auto name : technique_names()) techniques.push_back(name);
  const auto number = [](double least, double most) { return json{{"type", "number"}, {"minimum", least}, {"maximum", most}}; };
  const auto integer = [](double least, double most) { return json{{"type", "integer"}, {"minimum", least}, {"maximum", most}}; };
  return {
      {JobKind::kCalibrate, "seconds", "of timed renders, at most", number(1, 3600),
       [](CommandArguments& a, const json& v) { a.seconds = v; }},
      {JobKind::kCalibrate, "target_error", "share within which the held-out median error ends it early; 0: use all seconds", number(0, 1),
       [](CommandArguments& a, const json& v) { a.target_error = v; }},
      {JobKind::kCalibrate, "coverage", "share of frames that the bound is to cover", number(0.5, 0.999),
       [](CommandArguments& a, const json& v) { a.coverage = v; }},
      {JobKind::kBake,
       "objects",
       "object ids, as 1,2,5-9; all without it",
       {{"type", "string"}, {"maxLength", 4096}},
       [](CommandArguments& a, const json& v) { a.objects = v; }},
      {JobKind::kBake,
       "view_cell",
       "shaft:DX,DY,DZ,APEX_DEG,MIN_DISTANCE or box:X0,Y0,Z0,X1,Y1,Z1; needed",
       {{"type", "string"}, {"maxLength", 4096}},
       [](CommandArguments& a, const json& v) { a.view_cell = v; }},
      {JobKind::kBake,
       "technique",
       "impostor technique",
       {{"type", "string"}, {"enum", techniques}},
       [](CommandArguments& a, const json& v) { a.technique = v; }},
      {JobKind::kBake, "views", "views inside the view cell that the image metrics look at", integer(0, 100'000),
       [](CommandArguments& a, const json& v) { a.quality_views = v; }},
      {JobKind::kVerify, "judged_views", "views inside view cells to judge by rays", integer(0, 100'000),
       [](CommandArguments& a, const json& v) { a.judged_views = v; }},
  };
}

// Collects what is wrong instead of stopping at the first.
class Reader {
 public:
  void wrong(const std::string& pointer, const std::string& detail) { problems_.push_back({pointer, detail}); }
  [[nodiscard]] bool is_wrong(const std::string& pointer) const {
    return std::ranges::any_of(problems_, [&](const FieldProblem& problem) { return problem.pointer == pointer; });
  }
  template <class Action>
  void attempt(const std::string& pointer, Action&& action) {
    try {
      action();
    } catch (const Failure& failure) {
      wrong(pointer, failure.what());
    }
  }
  void finish() {
    if (!problems_.empty()) throw InvalidBody(std::move(problems_));
  }

  std::string text(const json& body, const std::string& key, std::size_t most_bytes) {
    if (!body.contains(key)) return "";
    if (!body[key].is_string() || body[key].get_ref<const std::string&>().size() > most_bytes) {
      wrong("/" + key, "a string of at most " + std::to_string(most_bytes) + " bytes is expected");
      return "";
    }
    return body[key];
  }

  FileReference file(const json& body, const std::string& key, const std::vector<std::string>& sources) {
    if (!body.contains(key)) return {};
    const json& value = body[key];
    if (value.is_object() && value.size() == 1 && value.begin().value().is_string())
      for (const auto& source : sources)
        if (value.begin().key() == source) return {source_named(source), value.begin().value()};
    std::string expected;
    for (const auto& source : sources) expected += (expected.empty() ? R"({")" : R"(, or {")") + source + R"(": "..."})";
    wrong("/" + key, expected + " is expected");
    return {};
  }

  void settings(JobSpec& spec, const json& object) {
    if (!object.is_object()) return wrong("/spec", "an object is expected");
    for_each_setting(object, [&](const SettingPlace& place, const json& value) { setting(spec, place, value); });
  }

  static std::string pointer_to(const std::string& name, const std::string& within = "") {
    return (json::json_pointer(within) / name).to_string();
  }

 private:
  static FileReference::Source source_named(const std::string& name) {
    if (name == "upload") return FileReference::Source::kUpload;
    return name == "job" ? FileReference::Source::kJob : FileReference::Source::kName;
  }

  void setting(JobSpec& spec, const SettingPlace& place, const json& value) {
    const std::string pointer = "/spec" + place.pointer.to_string();
    if (place.field == nullptr) return wrong(pointer, "is not a known setting");
    if (is_services_own(place.key)) return wrong(pointer, "is the service's own to set");
    if (place.key == "view_space.kind" && value.is_string() && value.get_ref<const std::string&>().starts_with("path:"))
      return wrong(pointer, "path:FILE names a file of the server: give boxes");
    attempt(pointer, [&] { set_field(spec, *place.field, value, place.key); });
  }

  std::vector<FieldProblem> problems_;
};

const ArgumentField* find_argument(JobKind kind, const std::string& key) {
  const auto& fields = argument_fields();
  const auto found = std::ranges::find_if(fields, [&](const ArgumentField& field) { return field.kind == kind && field.key == key; });
  return found == fields.end() ? nullptr : &*found;
}

void read_arguments(Reader& reader, JobKind kind, const json& body, json& arguments) {
  arguments = json::object();
  if (!body.contains("arguments")) return;
  if (!body["arguments"].is_object()) return reader.wrong("/arguments", "an object is expected");
  arguments = body["arguments"];
  for (const auto& [key, value] : arguments.items()) {
    const std::string pointer = Reader::pointer_to(key, "/arguments");
    if (const ArgumentField* field = find_argument(kind, key))
      reader.attempt(pointer, [&, &value_ = value] { check_value(field->schema, value_, field->key); });
    else
      reader.wrong(pointer, "is no argument of " + std::string(kind_name(kind)));
  }
}

void require_what_the_kind_needs(Reader& reader, const JobRequest& request) {
  const Needs& needs = kNeeds.at(static_cast<std::size_t>(request.kind));
  const auto given = [](const FileReference& file) { return file.source != FileReference::Source::kNone; };
  const auto missing = [&](const char* pointer, const std::string& detail) {
    if (!reader.is_wrong(pointer)) reader.wrong(pointer, detail);
  };
  const std::string kind(kind_name(request.kind));
  if (needs.scene && !given(request.scene)) missing("/scene", kind + " needs a scene");
  if (needs.target && !given(request.target)) missing("/target", kind + " needs a target file");
  if (needs.budget && !(request.spec.budget_ms > 0.0)) missing("/spec/budget_ms", kind + " needs a budget above 0 ms");
  if (request.kind == JobKind::kVerify && request.placed_job.empty()) missing("/job", "verify needs the id of a place job");
  if (request.kind != JobKind::kVerify && !request.placed_job.empty()) reader.wrong("/job", "only verify takes a job");
  if (request.kind != JobKind::kSweep && given(request.baseline)) reader.wrong("/baseline", "only sweep takes a baseline");
  if (request.kind == JobKind::kBake && !request.arguments.contains("view_cell")) missing("/arguments/view_cell", "bake needs a view cell");
}

json file_schema(const std::vector<std::string>& sources) {
  json schema = {{"oneOf", json::array()}};
  for (const auto& source : sources)
    schema["oneOf"].push_back(
        {{"type", "object"}, {"properties", {{source, {{"type", "string"}}}}}, {"required", {source}}, {"additionalProperties", false}});
  return schema;
}

const std::vector<std::string> kSceneSources = {"upload", "name"};
const std::vector<std::string> kTargetSources = {"upload", "name", "job"};
const std::vector<std::string> kBaselineSources = {"upload", "job"};

}  // namespace

std::string_view kind_name(JobKind kind) {
  return kKindNames.at(static_cast<std::size_t>(kind));
}

const std::vector<ArgumentField>& argument_fields() {
  static const std::vector<ArgumentField> fields = make_argument_fields();
  return fields;
}

bool is_services_own(const std::string& key) {
  return kServicesOwn.contains(key);
}

void apply_arguments(JobKind kind, const json& arguments, CommandArguments& to) {
  for (const auto& [key, value] : arguments.items())
    if (const ArgumentField* field = find_argument(kind, key)) field->set(to, value);
}

JobRequest parse_job_request(const json& body) {
  Reader reader;
  if (!body.is_object()) throw InvalidBody(std::vector<FieldProblem>{{"", "an object is expected"}});
  static const std::set<std::string> kKnown = {"kind", "label", "scene", "target", "baseline", "job", "spec", "arguments", "dry_run"};
  for (const auto& [key, value] : body.items())
    if (!kKnown.contains(key)) reader.wrong(Reader::pointer_to(key), "is not a known field");

  JobRequest request;
  const auto kind = std::ranges::find(kKindNames, reader.text(body, "kind", 20));
  if (kind == kKindNames.end())
    throw InvalidBody(std::vector<FieldProblem>{{"/kind", "one of survey, place, sweep, calibrate, verify, bake is expected"}});
  request.kind = static_cast<JobKind>(kind - kKindNames.begin());
  request.label = reader.text(body, "label", kMostLabelBytes);
  request.scene = reader.file(body, "scene", kSceneSources);
  request.target = reader.file(body, "target", kTargetSources);
  request.baseline = reader.file(body, "baseline", kBaselineSources);
  request.placed_job = reader.text(body, "job", 64);
  if (body.contains("spec")) reader.settings(request.spec, body["spec"]);
  if (body.contains("dry_run") && !body["dry_run"].is_boolean()) reader.wrong("/dry_run", "true or false is expected");
  request.dry_run = body.contains("dry_run") && body["dry_run"] == true;
  read_arguments(reader, request.kind, body, request.arguments);
  require_what_the_kind_needs(reader, request);
  reader.finish();
  return request;
}

json job_request_schema() {
  json arguments = json::object();
  for (const ArgumentField& field : argument_fields()) {
    arguments[field.key] = field.schema;
    arguments[field.key]["description"] = std::string(kind_name(field.kind)) + ": " + field.help;
  }
  json spec = spec_schema(is_services_own);
  spec.erase("$schema");
  return {{"type", "object"},
          {"required", {"kind"}},
          {"additionalProperties", false},
          {"properties",
           {{"kind", {{"type", "string"}, {"enum", kKindNames}}},
            {"label", {{"type", "string"}, {"maxLength", kMostLabelBytes}}},
            {"scene", file_schema(kSceneSources)},
            {"target", file_schema(kTargetSources)},
            {"baseline", file_schema(kBaselineSources)},
            {"job", {{"type", "string"}, {"description", "verify: the place job to look at"}}},
            {"spec", spec},
            {"arguments", {{"type", "object"}, {"additionalProperties", false}, {"properties", arguments}}},
            {"dry_run", {{"type", "boolean"}, {"description", "validate only"}}}}}};
}

}  // namespace standin
