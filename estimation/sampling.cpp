// Which frames calibration times (thesis 5.8.1, Fig. 5.5 and 5.6): clusters of the object hierarchy from random viewpoints, whole frames
// from inside and around the scene with all, some or the surrounding objects, the busiest of them, baked impostors from inside their view
// cells, alone and among the originals of all other objects, and now and then an empty frame. The sequence depends on the seed alone; how
// far it gets, on the frames' times.
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <tuple>

#include "estimation/calibrate.h"
#include "estimation/feature_table.h"
#include "render/base/error.h"
#include "render/base/rng.h"
#include "render/device/renderer.h"
#include "render/impostor/atlas.h"
#include "render/impostor/bake.h"
#include "render/scene/hierarchy.h"
#include "render/visibility/raytracer.h"

namespace standin {
namespace {

constexpr std::size_t kMaxFrames = 5000;  // a scene; more teach the fit nothing
constexpr std::size_t kImpostors = 8;
constexpr int kImpostorAttempts = 40;
constexpr std::uint64_t kMaxBakedTriangles = 30'000;  // baking is not what the seconds are for
constexpr double kEyeHeight_m = 1.7;
constexpr int kAttempts = 8;
constexpr int kBusySteps = 12;
constexpr double kOneKindShare = 0.4;    // of clusters
constexpr double kJustOutside = 1.1;     // bounding radii
constexpr double kLeastTriangles = 1e5;  // however small a scene is, it does not take more turns than one of so many
constexpr double kUnculled = 2e5;        // triangles; of frames with more, visible sets leave what is seen
constexpr double kLargeScene = 1e6;      // triangles
constexpr int kSeeingRays = 1 << 15;
constexpr double kSeenFrom = 0.005;       // of the scene's diagonal, about the eye
constexpr double kBusyReach = 0.03;       // likewise: in large scenes, what hides most of the rest
constexpr std::size_t kWarmUpFrames = 8;  // one of each kind: compiles the shaders

double log_uniform(Rng& rng, double low, double high) {
  return low * std::pow(high / low, rng.uniform());
}

/// What a frame asks for, each kind of work in units of about a millisecond of a software renderer.
std::array<double, 6> work_of(const Features& features) {
  const double pixels = features[Term::kPlainPixels] + features[Term::kTexturedPixels] + features[Term::kMaskedPixels];
  return {features[Term::kDraws] / 200.0,       features[Term::kTriangles] / 5e3,     features[Term::kEdgePixels] / 3e4, pixels / 5e4,
          features[Term::kImpostorQuads] / 1e3, features[Term::kImpostorPixels] / 5e4};
}

/// No placement turns on such frames.
bool is_light(const Features& features) {
  const auto work = work_of(features);
  return std::all_of(work.begin(), work.end(), [](double share) { return share < 1.0; });
}

/// Roughly, and on a software renderer: which of two frames takes longer.
double likely_ms(const Features& features) {
  const double pixels = features[Term::kPlainPixels] + features[Term::kTexturedPixels] + features[Term::kMaskedPixels];
  return features[Term::kDraws] / 500.0 + features[Term::kTriangles] / 7e4 + features[Term::kOnScreenTriangles] / 2.5e4 +
         features[Term::kEdgePixels] / 7e4 + pixels / 7e4;
}

Vec3 random_direction(Rng& rng, double min_sine, double max_sine) {
  const double sine = rng.uniform(min_sine, max_sine);
  const double azimuth = rng.uniform(0.0, 6.28318530717958647693);
  const double cosine = std::sqrt(std::max(0.0, 1.0 - sine * sine));
  return {cosine * std::cos(azimuth), sine, cosine * std::sin(azimuth)};
}

Vec3 random_point(Rng& rng, const Box& box) {
  return {rng.uniform(box.min.x, box.max.x), rng.uniform(box.min.y, box.max.y), rng.uniform(box.min.z, box.max.z)};
}

/// Looks from `eye` at `target`, off by up to half the image, so that parts fall outside it.
View view_towards(Rng& rng, const Vec3& eye, const Vec3& target, const Camera& camera) {
  const Vec3 offset = target - eye;
  const double distance_m = glm::length(offset);
  const Vec3 axis = distance_m > 0.0 ? offset / distance_m : Vec3(0.0, 0.0, -1.0);
  const Mat3 frame = world_from_eye_rotation(axis);
  const double right = 0.5 * camera.tan_half_x() * rng.uniform(-1.0, 1.0);
  const double up = 0.5 * camera.tan_half_y() * rng.uniform(-1.0, 1.0);
  return {eye, glm::normalize(axis + right * frame[0] + up * frame[1])};
}

/// Pages so small that even these few impostors fill several: what a change of pages costs must show.
std::uint32_t smallest_page(const std::vector<Impostor>& impostors) {
  std::uint32_t side = 256;
  for (const Impostor& impostor : impostors)
    for (const Chart& chart : textured_mesh(impostor).charts)
      side = std::max({side, chart.width + 2 * AtlasOptions{}.gutter, chart.height + 2 * AtlasOptions{}.gutter});
  return side;
}

/// Whatever is asked of one frame: what to draw from where.
struct Setup {
  View view;
  DrawList list;
};

class FrameSampler {
 public:
  FrameSampler(const Scene& scene, const Camera& camera, std::uint64_t seed, const WorkBudget& budget)
      : scene_(scene),
        camera_(camera),
        hierarchy_(build_hierarchy(scene)),
        table_(scene, camera),
        raytracer_(scene),
        rng_(seed),
        budget_(budget) {
    for (std::uint32_t id = 0; id < scene.objects.size(); ++id) all_objects_.push_back(id);
    bake_impostors();
  }

  [[nodiscard]] const ImpostorSet& impostors() const { return impostors_; }

  /// Drawn again, a few times, while it is so light that it would teach little.
  [[nodiscard]] Setup setup(std::size_t frame) {
    if (frame % 40 == 0) return {street_view(), {}};
    Setup drawn = draw(frame % 8);
    for (int attempt = 1; attempt < kAttempts && is_light(features(drawn)); ++attempt) drawn = draw(frame % 8);
    if (features(drawn)[Term::kTriangles] > kUnculled) keep_what_is_seen(drawn);
    return drawn;
  }

  [[nodiscard]] Setup draw(std::size_t kind) {
    switch (kind) {
      case 0:
        return whole();
      case 3:
      case 6:
        return surroundings();
      case 2:
        return some_objects();
      case 4:
        return {busy_street_view(), {all_objects_, {}}};
      case 5:
        return impostors_.impostors.empty() ? cluster() : impostor(false);
      case 7:
        return impostors_.impostors.empty() ? whole() : impostor(true);
      default:
        return cluster();
    }
  }

  [[nodiscard]] Features features(const Setup& setup) const {
    Features sum = table_.frame(setup.list.objects, setup.view);
    std::vector<std::uint32_t> pages;
    for (const std::uint32_t id : setup.list.impostors) {
      const Features drawn = impostor_features(impostors_.impostors[id], impostor_bounds_[id], setup.view, camera_);
      sum += drawn;
      if (drawn[Term::kDraws] > 0.0)
        for (const AtlasSlot& slot : impostors_.slots[id]) pages.push_back(slot.page);
    }
    std::sort(pages.begin(), pages.end());
    sum[Term::kTextureSwitches] += static_cast<double>(std::unique(pages.begin(), pages.end()) - pages.begin());
    return sum;
  }

 private:
  /// Leaves the objects that rays from around the eye meet, as the visible set of a 3D cell would.
  void keep_what_is_seen(Setup& setup) {
    const double reach_m = kSeenFrom * scene_.bounds.diagonal();
    std::vector<bool> seen(scene_.objects.size(), false);
    for (int ray = 0; ray < kSeeingRays; ++ray) {
      const Vec3 origin = setup.view.position + reach_m * Vec3(rng_.uniform(-1.0, 1.0), 0.0, rng_.uniform(-1.0, 1.0));
      if (const auto hit = raytracer_.nearest(origin, random_direction(rng_, -1.0, 1.0))) seen[hit->object] = true;
    }
    std::erase_if(setup.list.objects, [&](std::uint32_t object) { return !seen[object]; });
  }

  /// A node of about log-uniformly many objects.
  [[nodiscard]] const HierarchyNode& random_node() {
    const double wanted = log_uniform(rng_, 1.0, static_cast<double>(scene_.objects.size()));
    const HierarchyNode* node = &hierarchy_.nodes[hierarchy_.leaf[rng_.below(scene_.objects.size())]];
    while (node->parent >= 0 && node->count < wanted) node = &hierarchy_.nodes[static_cast<std::size_t>(node->parent)];
    return *node;
  }

  [[nodiscard]] Setup cluster() {
    const HierarchyNode& node = random_node();
    const double radius_m = 0.5 * node.bounds.diagonal();
    const double distance_m = std::max(camera_.near_m, log_uniform(rng_, 0.6, 16.0) * radius_m);
    const Vec3 direction = random_direction(rng_, -0.1, 0.9);
    Vec3 eye = node.bounds.centre() + distance_m * direction;
    if (node.bounds.contains(eye)) eye = node.bounds.centre() + kJustOutside * radius_m * direction;
    std::vector<std::uint32_t> objects = objects_of(hierarchy_, node);
    if (rng_.uniform() < kOneKindShare) keep_one_kind(objects);
    return {view_towards(rng_, eye, node.bounds.centre(), camera_), {std::move(objects), {}}};
  }

  /// What only comes beside costlier things is hard to tell from nothing.
  void keep_one_kind(std::vector<std::uint32_t>& objects) {
    const auto kind_of = [&](std::uint32_t object) { return pixel_kind(scene_, scene_.parts[scene_.objects[object].first_part]); };
    const PixelKind kept = kind_of(objects[rng_.below(objects.size())]);
    std::erase_if(objects, [&](std::uint32_t object) { return kind_of(object) != kept; });
  }

  /// Upright, at eye height above the scene's floor or anywhere in its height, where a walk may lead: under free sky, clear of objects.
  /// From around the scene where there is no such place, or where nobody would walk.
  [[nodiscard]] View street_view() {
    if (is_exhibit(scene_)) return orbit_view();
    Box eyes = scene_.bounds;
    if (rng_.uniform() < 0.7) eyes.min.y = eyes.max.y = eyes.min.y + kEyeHeight_m;
    for (int attempt = 0; attempt < 32; ++attempt)
      if (const Vec3 position = random_point(rng_, eyes); is_open(position)) return {position, random_direction(rng_, -0.25, 0.25)};
    return orbit_view();
  }

  [[nodiscard]] bool is_open(const Vec3& position) const {
    constexpr double kClearance_m = 0.5;
    if (raytracer_.nearest(position, {0.0, 1.0, 0.0})) return false;
    for (const Vec3& direction : {Vec3(1.0, 0.0, 0.0), Vec3(-1.0, 0.0, 0.0), Vec3(0.0, 0.0, 1.0), Vec3(0.0, 0.0, -1.0)})
      if (const auto hit = raytracer_.nearest(position, direction); hit && hit->distance_m < kClearance_m) return false;
    return true;
  }

  [[nodiscard]] View orbit_view() {
    const double distance_m =
        (is_exhibit(scene_) ? log_uniform(rng_, 1.2, 10.0) : log_uniform(rng_, 0.6, 5.0)) * 0.5 * scene_.bounds.diagonal();
    return view_towards(rng_, scene_.bounds.centre() + distance_m * random_direction(rng_, 0.0, 0.9), scene_.bounds.centre(), camera_);
  }

  /// The busiest of a few beside heavy objects, then of a few steps from it: what an optimizer asks about are the slowest views, and a
  /// model that is fitted on others alone is wrong about those (tests/bench/time_model.md).
  [[nodiscard]] View busy_street_view() {
    View busiest = street_view();
    double most = work_at(busiest);
    for (int step = 0; step < kBusySteps; ++step) {
      const View other = beside(step < kBusySteps / 2 ? view_of_heavy_object() : busiest);
      if (const double asked = work_at(other); asked > most) std::tie(busiest, most) = std::pair(other, asked);
    }
    return busiest;
  }

  /// Of what is drawn from there; in large scenes, of what is near.
  [[nodiscard]] double work_at(const View& view) const {
    if (static_cast<double>(scene_.triangle_count()) <= kLargeScene) return likely_ms(table_.frame(all_objects_, view));
    const double reach_m = kBusyReach * scene_.bounds.diagonal();
    std::vector<std::uint32_t> near = all_objects_;
    std::erase_if(near, [&](std::uint32_t id) { return distance(view.position, scene_.objects[id].bounds) > reach_m; });
    return likely_ms(table_.frame(near, view));
  }

  /// At eye height beside an object, with a chance that is its share of the scene's triangles.
  [[nodiscard]] View view_of_heavy_object() {
    const View street = street_view();
    if (is_exhibit(scene_)) return street;
    std::uint64_t triangle = rng_.below(scene_.triangle_count());
    const auto heavy = std::find_if(scene_.objects.begin(), scene_.objects.end(), [&](const Object& object) {
      const bool found = triangle < object.triangle_count;
      triangle -= found ? 0 : object.triangle_count;
      return found;
    });
    const Vec3 centre = heavy->bounds.centre();
    const double away_m = rng_.uniform(0.3, 1.0) * heavy->bounds.diagonal();
    const Vec3 direction = random_direction(rng_, 0.0, 0.0);
    const Vec3 position(centre.x + away_m * direction.x, street.position.y, centre.z + away_m * direction.z);
    if (!is_open(position) || !scene_.bounds.contains(position)) return street;
    return {position, glm::normalize(centre - position)};
  }

  /// A few metres and degrees away on the same level; the same view where nobody could stand.
  [[nodiscard]] View beside(const View& view) {
    const Vec3 position = view.position + Vec3(rng_.uniform(-5.0, 5.0), 0.0, rng_.uniform(-5.0, 5.0));
    const Vec3 turned = view.direction + 0.5 * random_direction(rng_, -0.25, 0.25);
    return is_open(position) && scene_.bounds.contains(position) ? View{position, glm::normalize(turned)} : view;
  }

  [[nodiscard]] Setup whole() { return {rng_.uniform() < 0.75 ? street_view() : orbit_view(), {all_objects_, {}}}; }

  [[nodiscard]] Setup some_objects() {
    Setup setup = whole();
    const double share = log_uniform(rng_, 0.03, 0.9);
    std::erase_if(setup.list.objects, [&](std::uint32_t) { return rng_.uniform() >= share; });
    return setup;
  }

  /// What is left of a street view where visible sets hide the far end: all objects within some distance.
  [[nodiscard]] Setup surroundings() {
    Setup setup{street_view(), {}};
    const double reach_m = scene_.bounds.diagonal() * log_uniform(rng_, 0.05, 0.7);
    for (const std::uint32_t id : all_objects_)
      if (distance(setup.view.position, scene_.objects[id].bounds) <= reach_m) setup.list.objects.push_back(id);
    return setup;
  }

  [[nodiscard]] Setup impostor(bool among_originals) {
    const auto count = static_cast<std::uint32_t>(impostors_.impostors.size());
    const auto id = static_cast<std::uint32_t>(rng_.below(count));
    const Impostor& drawn = impostors_.impostors[id];
    const Shaft& shaft = std::get<Shaft>(drawn.view_cell);
    const double along_m = shaft.min_distance_m * log_uniform(rng_, 1.001, 3.0);
    const double right = along_m * shaft.tan_half.x * rng_.uniform(-0.9, 0.9);
    const double up = along_m * shaft.tan_half.y * rng_.uniform(-0.9, 0.9);
    const Vec3 eye = shaft.apex + along_m * shaft.axis + right * shaft.right + up * shaft.up;
    Setup setup{view_towards(rng_, eye, shaft.apex, camera_), {}};
    const double others = among_originals ? 0.0 : rng_.uniform();  // each of the others as well, with this chance
    for (std::uint32_t other = 0; other < count; ++other)
      if (other == id || (rng_.uniform() < others && is_far_from(other, eye))) setup.list.impostors.push_back(other);
    if (among_originals)
      std::set_difference(all_objects_.begin(), all_objects_.end(), drawn.objects.begin(), drawn.objects.end(),
                          std::back_inserter(setup.list.objects));
    return setup;
  }

  /// No nearer than the impostor's view cell is, so that its texels are about as small as there.
  [[nodiscard]] bool is_far_from(std::uint32_t impostor, const Vec3& eye) const {
    const Shaft& shaft = std::get<Shaft>(impostors_.impostors[impostor].view_cell);
    return glm::distance(eye, shaft.apex) >= shaft.min_distance_m;
  }

  [[nodiscard]] std::optional<Impostor> bake_one() {
    const HierarchyNode& node = random_node();
    Shaft shaft = shaft_frame(node.bounds.centre(), random_direction(rng_, 0.0, 0.6));
    shaft.tan_half = Vec2(std::tan(0.5 * std::array{0.19634954, 0.39269908, 0.78539816}[rng_.below(3)]));
    shaft.min_distance_m = node.bounds.diagonal() * log_uniform(rng_, 1.0, 8.0);
    BakeRequest request{objects_of(hierarchy_, node), shaft};
    std::uint64_t triangles = 0;
    for (const std::uint32_t id : request.objects) triangles += scene_.objects[id].triangle_count;
    if (triangles > kMaxBakedTriangles || !plan_impostor(node.bounds, shaft, camera_, {}).possible) return std::nullopt;
    Impostor impostor = bake_layered(scene_, request, camera_, {}, budget_);
    return impostor.empty() ? std::nullopt : std::optional(std::move(impostor));
  }

  void bake_impostors() {
    std::vector<Impostor> baked;
    for (int attempt = 0; attempt < kImpostorAttempts && baked.size() < kImpostors; ++attempt) {
      budget_.check();
      if (std::optional<Impostor> impostor = bake_one()) baked.push_back(std::move(*impostor));
    }
    for (const Impostor& impostor : baked) {
      Box& bounds = impostor_bounds_.emplace_back();
      for (const std::uint32_t id : impostor.objects) bounds.extend(scene_.objects[id].bounds);
    }
    const AtlasOptions pages{.max_side = smallest_page(baked)};
    impostors_ = pack_atlas(std::move(baked), pages);
  }

  const Scene& scene_;
  Camera camera_;
  Hierarchy hierarchy_;
  FeatureTable table_;
  Raytracer raytracer_;
  Rng rng_;
  const WorkBudget& budget_;
  std::vector<std::uint32_t> all_objects_;
  ImpostorSet impostors_;
  std::vector<Box> impostor_bounds_;
};

/// A scene that is timed. Of two, the one twice as large takes half as many turns.
class Source {
 public:
  Source(const Scene& scene, double size, Context& context, const Camera& camera, std::uint64_t seed, const WorkBudget& budget)
      : sampler_(scene, camera, seed, budget), renderer_(context, scene, camera), size_(size) {
    renderer_.upload(sampler_.impostors());
    for (std::size_t frame = 0; frame < kWarmUpFrames; ++frame) draw(sampler_.setup(frame));
  }

  /// How much of a calibration the source's frames so far are worth: large scenes take their turn less often, their frames take longer.
  [[nodiscard]] double share() const { return static_cast<double>(frames_) * size_; }

  /// The source's next frame, timed.
  [[nodiscard]] TimedFrame next(FrameTimer& timer, bool count_passed_pixels) {
    const Setup setup = sampler_.setup(frames_++);
    const FrameSample sample = timer.time(renderer_, setup.view, setup.list);
    TimedFrame frame{.features = sampler_.features(setup), .milliseconds = sample.milliseconds, .spread = sample.spread};
    frame.seconds = 1e-3 * sample.spent_milliseconds;
    if (count_passed_pixels) frame.passed_pixels = static_cast<double>(renderer_.count_passed_pixels(setup.view, setup.list));
    return frame;
  }

 private:
  void draw(const Setup& setup) { renderer_.draw(setup.view, setup.list); }

  FrameSampler sampler_;
  Renderer renderer_;
  double size_;
  std::size_t frames_ = 0;
};

/// Frames of larger scenes take longer. The designed scene takes no more turns than all others together: it tells costs apart, what they
/// are is to be learned from the others.
std::vector<double> sizes_of(std::span<const TrainingScene> scenes) {
  std::vector<double> sizes;
  double turns = 0.0;
  for (const TrainingScene& one : scenes) {
    sizes.push_back(std::sqrt(std::max(kLeastTriangles, static_cast<double>(one.scene.triangle_count()))));
    if (!one.designed) turns += 1.0 / sizes.back();
  }
  for (std::size_t i = 0; i < scenes.size(); ++i)
    if (scenes[i].designed && turns > 0.0) sizes[i] = std::max(sizes[i], 1.0 / turns);
  return sizes;
}

}  // namespace

std::vector<TimedFrame> sample_frames(std::span<const TrainingScene> scenes, Context& context, FrameTimer& timer, const Camera& camera,
                                      const CalibrationOptions& options, const Enough& enough, const WorkBudget& budget) {
  if (!(options.seconds > 0.0)) throw Failure(ErrorWord::kBadUsage, "calibration seconds are " + std::to_string(options.seconds));
  if (scenes.empty()) throw Failure(ErrorWord::kBadUsage, "calibration: no scene to time");
  std::deque<Source> sources;
  const std::vector<double> sizes = sizes_of(scenes);
  for (std::size_t i = 0; i < scenes.size(); ++i) sources.emplace_back(scenes[i].scene, sizes[i], context, camera, options.seed, budget);
  std::vector<TimedFrame> frames;
  double spent_s = 0.0, next_look_s = kLookEvery_s;
  while (spent_s < options.seconds && frames.size() < kMaxFrames * scenes.size()) {
    budget.check();
    budget.report("calibrate", spent_s / options.seconds);
    const auto source =
        std::min_element(sources.begin(), sources.end(), [](const Source& a, const Source& b) { return a.share() < b.share(); });
    frames.push_back(source->next(timer, options.count_passed_pixels));
    frames.back().group = static_cast<std::uint32_t>(source - sources.begin());
    frames.back().designed = scenes[frames.back().group].designed;
    frames.back().seconds = spent_s += frames.back().seconds;
    if (spent_s < next_look_s) continue;
    next_look_s += kLookEvery_s;
    if (enough && enough(frames)) break;
  }
  return frames;
}

}  // namespace standin
