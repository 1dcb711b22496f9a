#include "render/device/renderer.h"

#include <string>

#include "render/base/error.h"
#include "render/device/bound_state.h"
#include "render/device/frame_buffer.h"
#include "render/device/gl_functions.h"
#include "render/device/impostor_drawer.h"
#include "render/device/programs.h"
#include "render/device/scene_drawer.h"

namespace standin {
namespace {

// OpenGL's depth -w (near) .. w (far) becomes w .. 0: float has its precision near zero, which is where the far depths are.
Mat4 with_reversed_depth(Mat4 clip_from_world) {
  for (int column = 0; column < 4; ++column) clip_from_world[column][2] = 0.5 * (clip_from_world[column][3] - clip_from_world[column][2]);
  return clip_from_world;
}

void check_id(const char* kind, std::uint32_t id, std::size_t count) {
  if (id < count) return;
  throw Failure(ErrorWord::kInternal,
                std::string("the draw list names ") + kind + " " + std::to_string(id) + " of " + std::to_string(count));
}

}  // namespace

struct Renderer::State {
  State(const Context& context, const Scene& scene_, const Camera& camera_)
      : gl(context), scene(scene_), camera(camera_), frame_buffer(gl, camera.width, camera.height), programs(gl), objects(gl, scene) {
    gl.check("uploading the scene");
  }

  FrameCounts draw(const Mat4& clip_from_world, const Vec3& eye, const DrawList& list) {
    const Mat4 reversed = with_reversed_depth(clip_from_world);
    BoundState bound(gl, programs);
    frame_buffer.begin();
    objects.draw(bound, reversed, eye, list.objects, list.levels);
    impostors->draw(bound, reversed, list.impostors);
    gl.Finish();
    return bound.counts;
  }

  void check_ids(const DrawList& list) const {
    for (const std::uint32_t id : list.objects) check_id("object", id, scene.objects.size());
    if (!list.levels.empty() && list.levels.size() != list.objects.size())
      throw Failure(ErrorWord::kInternal, "the draw list has " + std::to_string(list.levels.size()) + " levels for " +
                                              std::to_string(list.objects.size()) + " objects");
    for (std::size_t i = 0; i < list.levels.size(); ++i)
      check_id("level", list.levels[i], scene.objects[list.objects[i]].levels.size() + 1);
    for (const std::uint32_t id : list.impostors) check_id("impostor", id, impostors->count());
  }

  /// The part of the list that may be in the frustum.
  const DrawList& culled(const View& view, const DrawList& list) {
    check_ids(list);
    const Frustum frustum = frustum_of(view, camera);
    visible.objects.clear();
    visible.levels.clear();
    visible.impostors.clear();
    for (std::size_t i = 0; i < list.objects.size(); ++i) {
      if (!may_intersect(frustum, scene.objects[list.objects[i]].bounds)) continue;
      visible.objects.push_back(list.objects[i]);
      if (!list.levels.empty()) visible.levels.push_back(list.levels[i]);
    }
    for (const std::uint32_t id : list.impostors)
      if (const Box& box = impostors->bounds(id); !box.empty() && may_intersect(frustum, box)) visible.impostors.push_back(id);
    return visible;
  }

  const Gl gl;
  const Scene& scene;
  const Camera camera;
  FrameBuffer frame_buffer;
  Programs programs;
  SceneDrawer objects;
  std::unique_ptr<ImpostorDrawer> impostors = std::make_unique<ImpostorDrawer>(gl, ImpostorSet{});
  DrawList visible;  // of the last frame; kept for its capacity
};

Renderer::Renderer(Context& context, const Scene& scene, const Camera& camera) : state_(std::make_unique<State>(context, scene, camera)) {}

Renderer::~Renderer() = default;

void Renderer::upload(const ImpostorSet& impostors) {
  state_->impostors = std::make_unique<ImpostorDrawer>(state_->gl, impostors);
  state_->gl.check("uploading impostors");
}

FrameCounts Renderer::draw(const View& view, const DrawList& list) {
  return state_->draw(clip_from_eye(state_->camera) * eye_from_world(view), view.position, state_->culled(view, list));
}

FrameCounts Renderer::draw_projected(const Mat4& clip_from_world, const Vec3& eye, const DrawList& list) {
  state_->check_ids(list);
  return state_->draw(clip_from_world, eye, list);
}

Texture Renderer::read_pixels() {
  return state_->frame_buffer.read();
}

std::uint64_t Renderer::count_passed_pixels(const View& view, const DrawList& list) {
  const Gl& gl = state_->gl;
  GLuint query = 0;
  gl.CreateQueries(GL_SAMPLES_PASSED, 1, &query);
  gl.BeginQuery(GL_SAMPLES_PASSED, query);
  draw(view, list);
  gl.EndQuery(GL_SAMPLES_PASSED);
  GLuint64 passed = 0;
  gl.GetQueryObjectui64v(query, GL_QUERY_RESULT, &passed);
  gl.DeleteQueries(1, &query);
  return passed;
}

}  // namespace standin
