#include "render/visibility/raytracer.h"

#include <embree3/rtcore.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>
#include <string>
#include <utility>

#include "render/base/error.h"
#include "render/visibility/alpha_mask.h"

namespace standin {
namespace {

struct Release {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using SceneHandle = std::unique_ptr<std::remove_pointer_t<RTCScene>, Release>;
using GeometryHandle = std::unique_ptr<std::remove_pointer_t<RTCGeometry>, Release>;

// The process's only device. It keeps the first error that Embree reports, on whatever thread, until somebody asks.
class Device {
 public:
  static Device& instance() {
    static Device device;
    return device;
  }
  [[nodiscard]] RTCDevice handle() const { return device_; }
  void throw_reported() {
    const std::scoped_lock lock(mutex_);
    if (!error_.empty()) throw Failure(ErrorWord::kInternal, "Embree: " + std::exchange(error_, {}));
  }

 private:
  Device() : device_(rtcNewDevice(nullptr)) {
    if (device_ == nullptr)
      throw Failure(ErrorWord::kInternal, "Embree gives no device, error " + std::to_string(rtcGetDeviceError(nullptr)));
    rtcSetDeviceErrorFunction(device_, keep, this);
  }
  static void keep(void* self, RTCError code, const char* message) {
    auto& device = *static_cast<Device*>(self);
    const std::scoped_lock lock(device.mutex_);
    if (device.error_.empty()) device.error_ = std::string(message) + " (error " + std::to_string(code) + ")";
  }

  RTCDevice device_;
  std::mutex mutex_;
  std::string error_;
};

SceneHandle new_scene() {
  SceneHandle scene(rtcNewScene(Device::instance().handle()));
  // Robust: watertight edges. Context filter: every hit passes through the query's own callback.
  rtcSetSceneFlags(scene.get(), static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_MEDIUM);  // HIGH would split triangles and report them twice
  return scene;
}

// Copies: Embree reads 16 bytes per vertex, past the end of an array of three floats each.
GeometryHandle new_triangles(const std::vector<glm::vec3>& positions, const std::vector<std::uint32_t>& indices) {
  GeometryHandle geometry(rtcNewGeometry(Device::instance().handle(), RTC_GEOMETRY_TYPE_TRIANGLE));
  void* vertices =
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), positions.size());
  void* triangles =
      rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), indices.size() / 3);
  Device::instance().throw_reported();
  std::copy_n(positions.data(), positions.size(), static_cast<glm::vec3*>(vertices));
  std::copy_n(indices.data(), indices.size(), static_cast<std::uint32_t*>(triangles));
  rtcCommitGeometry(geometry.get());
  return geometry;
}

// A transform that flattens space has no inverse, which instances need.
bool is_singular(const Mat4& transform) {
  const Mat3 linear(transform);
  const double volume = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
  return !(std::abs(glm::determinant(linear)) > 1e-9 * volume);
}

// The meshes and materials of an object's parts: objects alike in these share one tree.
using Appearance = std::vector<std::uint32_t>;

// What a geometry of the world shows: an object as an instance, or one part of it as plain triangles.
struct Target {
  std::uint32_t object = 0;
  std::uint32_t part = 0;  // plain triangles only
};

}  // namespace

struct Raytracer::State {
  const Scene* scene = nullptr;
  bool honour_masks = true;
  Vec3 origin{0.0};             // local origin: Embree's coordinates are world minus this
  std::vector<Target> targets;  // by geometry id in the world
  std::map<std::uint32_t, GeometryHandle> mesh_geometries;
  std::map<Appearance, SceneHandle> prototypes;
  SceneHandle world;

  State(const Scene& source, const std::vector<std::uint32_t>& objects, const Options& options);
  [[nodiscard]] Appearance appearance(const Object& object) const;
  RTCScene prototype(const Appearance& appearance);
  void add_instance(std::uint32_t id);
  void add_triangles(std::uint32_t id);
  void add_to_world(RTCGeometry geometry, const Target& target);
  [[nodiscard]] const Target& target_of(RTCHitN* hit) const;
  [[nodiscard]] bool is_seen(const Target& target, RTCHitN* hit) const;
};

namespace {

constexpr float kNoHit = std::numeric_limits<float>::infinity();

// What Embree hands back to the filter: it sees the first member only.
struct Query {
  RTCIntersectContext context{};
  const Raytracer::State* state = nullptr;
  double from_m = 0.0;
  double to_m = 0.0;
  float best_distance = kNoHit;
  std::uint32_t best_object = 0;
  std::vector<Hit> hits;
};

// Embree offers hits no farther than the best so far, in the order of its tree: equal distances are settled by object id here, so that the
// answer does not depend on the tree.
void keep_nearest(const RTCFilterFunctionNArguments* candidate) {
  auto& query = *reinterpret_cast<Query*>(candidate->context);
  const Target& target = query.state->target_of(candidate->hit);
  const float distance = RTCRayN_tfar(candidate->ray, 1, 0);
  const bool worse = distance == query.best_distance && target.object >= query.best_object;
  if (worse || !query.state->is_seen(target, candidate->hit)) {
    candidate->valid[0] = 0;
    return;
  }
  query.best_distance = distance;
  query.best_object = target.object;
}

// Rejecting every hit keeps the ray alive to its end.
void keep_all(const RTCFilterFunctionNArguments* candidate) {
  auto& query = *reinterpret_cast<Query*>(candidate->context);
  const Target& target = query.state->target_of(candidate->hit);
  const double distance = RTCRayN_tfar(candidate->ray, 1, 0);
  candidate->valid[0] = 0;
  if (distance >= query.from_m && distance <= query.to_m && query.state->is_seen(target, candidate->hit))
    query.hits.push_back({distance, target.object});
}

void trace(Query& query, RTCFilterFunctionN filter, const Vec3& origin, const Vec3& direction, float near, float far) {
  rtcInitIntersectContext(&query.context);
  query.context.filter = filter;
  const glm::vec3 start(origin - query.state->origin);
  const glm::vec3 along(direction);
  RTCRayHit ray{};
  ray.ray = {start.x, start.y, start.z, near, along.x, along.y, along.z, 0.0F, far, ~0U, 0U, 0U};
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(query.state->world.get(), &query.context, &ray);
}

Vec3 centre_of(const Scene& scene, const std::vector<std::uint32_t>& objects) {
  Box bounds;
  for (const std::uint32_t object : objects) bounds.extend(scene.objects[object].bounds);
  return bounds.empty() ? Vec3(0.0) : bounds.centre();
}

std::vector<std::uint32_t> all_objects(const Scene& scene) {
  std::vector<std::uint32_t> objects(scene.objects.size());
  std::iota(objects.begin(), objects.end(), 0U);
  return objects;
}

}  // namespace

Raytracer::State::State(const Scene& source, const std::vector<std::uint32_t>& objects, const Options& options)
    : scene(&source), honour_masks(options.honour_masks), origin(centre_of(source, objects)) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(std::max(1, options.threads)));
  std::map<Appearance, int> uses;
  for (const std::uint32_t id : objects) ++uses[appearance(scene->objects[id])];
  world = new_scene();
  for (const std::uint32_t id : objects) {
    const Object& object = scene->objects[id];
    const bool plain = uses[appearance(object)] == 1 || is_singular(object.world_from_object);
    plain ? add_triangles(id) : add_instance(id);
  }
  rtcCommitScene(world.get());
  Device::instance().throw_reported();
}

Appearance Raytracer::State::appearance(const Object& object) const {
  Appearance result;
  for (std::uint32_t i = 0; i < object.part_count; ++i) {
    result.push_back(scene->parts[object.first_part + i].mesh);
    result.push_back(scene->parts[object.first_part + i].material);
  }
  return result;
}

// Objects that show the same mesh share its vertices.
RTCScene Raytracer::State::prototype(const Appearance& parts) {
  SceneHandle& shared = prototypes[parts];
  if (shared) return shared.get();
  shared = new_scene();
  for (std::uint32_t i = 0; 2 * i < parts.size(); ++i) {
    const Mesh& mesh = scene->meshes[parts[2 * i]];
    GeometryHandle& geometry = mesh_geometries[parts[2 * i]];
    if (!geometry) geometry = new_triangles(mesh.positions, mesh.indices);
    rtcAttachGeometryByID(shared.get(), geometry.get(), i);
  }
  rtcCommitScene(shared.get());
  return shared.get();
}

void Raytracer::State::add_instance(std::uint32_t id) {
  const Object& object = scene->objects[id];
  Mat4 local_from_object = object.world_from_object;
  local_from_object[3] -= Vec4(origin, 0.0);
  const glm::mat4 transform(local_from_object);
  const GeometryHandle instance(rtcNewGeometry(Device::instance().handle(), RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(instance.get(), prototype(appearance(object)));
  rtcSetGeometryTransform(instance.get(), 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, glm::value_ptr(transform));
  rtcCommitGeometry(instance.get());
  add_to_world(instance.get(), {id, 0});
}

void Raytracer::State::add_triangles(std::uint32_t id) {
  const Object& object = scene->objects[id];
  for (std::uint32_t i = 0; i < object.part_count; ++i) {
    const Mesh& mesh = scene->meshes[scene->parts[object.first_part + i].mesh];
    std::vector<glm::vec3> positions;
    positions.reserve(mesh.positions.size());
    for (const glm::vec3& position : mesh.positions)
      positions.emplace_back(Vec3(object.world_from_object * Vec4(Vec3(position), 1.0)) - origin);
    add_to_world(new_triangles(positions, mesh.indices).get(), {id, i});
  }
}

void Raytracer::State::add_to_world(RTCGeometry geometry, const Target& target) {
  rtcAttachGeometryByID(world.get(), geometry, static_cast<unsigned>(targets.size()));
  targets.push_back(target);
}

const Target& Raytracer::State::target_of(RTCHitN* hit) const {
  const unsigned instance = RTCHitN_instID(hit, 1, 0, 0);
  return targets[instance == RTC_INVALID_GEOMETRY_ID ? RTCHitN_geomID(hit, 1, 0) : instance];
}

bool Raytracer::State::is_seen(const Target& target, RTCHitN* hit) const {
  if (!honour_masks) return true;
  const bool instanced = RTCHitN_instID(hit, 1, 0, 0) != RTC_INVALID_GEOMETRY_ID;
  const std::uint32_t part = instanced ? RTCHitN_geomID(hit, 1, 0) : target.part;
  const Part& shown = scene->parts[scene->objects[target.object].first_part + part];
  return is_opaque(*scene, scene->materials[shown.material], scene->meshes[shown.mesh], RTCHitN_primID(hit, 1, 0), RTCHitN_u(hit, 1, 0),
                   RTCHitN_v(hit, 1, 0));
}

Raytracer::Raytracer(const Scene& scene, const Options& options) : Raytracer(scene, all_objects(scene), options) {}

Raytracer::Raytracer(const Scene& scene, const std::vector<std::uint32_t>& objects, const Options& options)
    : state_(std::make_unique<State>(scene, objects, options)) {}

Raytracer::~Raytracer() = default;
Raytracer::Raytracer(Raytracer&&) noexcept = default;
Raytracer& Raytracer::operator=(Raytracer&&) noexcept = default;

std::optional<Hit> Raytracer::nearest(const Vec3& origin, const Vec3& direction, double from_m) const {
  Query query;
  query.state = state_.get();
  trace(query, keep_nearest, origin, direction, static_cast<float>(std::max(0.0, from_m)), kNoHit);
  if (query.best_distance == kNoHit) return std::nullopt;
  return Hit{query.best_distance, query.best_object};
}

std::vector<Hit> Raytracer::all(const Vec3& origin, const Vec3& direction, double from_m, double to_m) const {
  Query query;
  query.state = state_.get();
  query.from_m = from_m;
  query.to_m = to_m;
  // Embree's own interval is open and in float: ask for a little more on both sides, and let the filter decide.
  const float near = std::nextafter(static_cast<float>(std::max(0.0, from_m)), 0.0F);
  const float far = std::nextafter(static_cast<float>(to_m), std::numeric_limits<float>::infinity());
  trace(query, keep_all, origin, direction, near, far);
  std::sort(query.hits.begin(), query.hits.end(),
            [](const Hit& a, const Hit& b) { return std::pair(a.distance_m, a.object) < std::pair(b.distance_m, b.object); });
  return std::move(query.hits);
}

}  // namespace standin
