#include "render/scene/load.h"

#include <algorithm>
#include <cmath>
#include <future>

#include "render/base/error.h"
#include "render/base/sha256.h"
#include "render/scene/import.h"

namespace standin {
namespace {

namespace fs = std::filesystem;
using Kind = LoadNote::Kind;

bool is_gltf(const fs::path& file, std::span<const std::uint8_t> bytes) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const bool binary = bytes.size() >= 4 && std::equal(bytes.begin(), bytes.begin() + 4, "glTF");
  return binary || ending == ".gltf" || ending == ".glb";
}

// A rotation: x up and z up become y up, handedness stays.
Mat4 world_from_up(UpAxis up) {
  Mat4 matrix(1.0);
  if (up == UpAxis::kZ) matrix = Mat4(Vec4(1, 0, 0, 0), Vec4(0, 0, -1, 0), Vec4(0, 1, 0, 0), Vec4(0, 0, 0, 1));
  if (up == UpAxis::kX) matrix = Mat4(Vec4(0, 1, 0, 0), Vec4(-1, 0, 0, 0), Vec4(0, 0, 1, 0), Vec4(0, 0, 0, 1));
  return matrix;
}

const char* axis_name(UpAxis up) {
  return up == UpAxis::kX ? "x" : (up == UpAxis::kZ ? "z" : "y");
}

// The user's word, else the file's, else y up and metres; each with its reason.
void place(Import& import) {
  const Placing& asked = import.options.placing;
  const FileStatement& stated = import.statement;
  const auto reason = [&](bool by_user, bool by_file) {
    return by_user ? std::string("as asked") : (by_file ? "stated by " + stated.source : std::string("the file does not say; assumed"));
  };
  const bool up_asked = asked.up != UpAxis::kAuto;
  const bool up_stated = stated.up != UpAxis::kAuto;
  const UpAxis up = up_asked ? asked.up : (up_stated ? stated.up : UpAxis::kY);
  const bool unit_asked = asked.metres_per_unit > 0.0;
  const bool unit_stated = stated.metres_per_unit > 0.0;
  const double unit = unit_asked ? asked.metres_per_unit : (unit_stated ? stated.metres_per_unit : 1.0);
  add_note(import.scene, Kind::kChosen, std::string("up axis ") + axis_name(up), 1, reason(up_asked, up_stated));
  add_note(import.scene, Kind::kChosen, std::to_string(unit) + " metres per unit", 1, reason(unit_asked, unit_stated));
  Mat4 scaled = world_from_up(up);
  for (int axis = 0; axis < 3; ++axis) scaled[axis] *= unit;
  import.scene.world_from_file = scaled;
  for (Object& object : import.scene.objects) object.world_from_object = scaled * object.world_from_object;
}

// Readers name the place within the file; which file it is, is said here.
void read(Import& import, const fs::path& file, const std::vector<std::uint8_t>& bytes) {
  try {
    if (is_gltf(file, bytes))
      read_gltf(import, bytes);
    else
      read_by_assimp(import, file);
  } catch (const Failure& failure) {
    const std::string sentence = failure.what();
    const bool named = sentence.find(file.string()) != std::string::npos;
    throw Failure(failure.word(), named ? sentence : file.string() + ": " + sentence);
  }
}

bool drawable(const Object& object) {
  const Vec3 extent = object.bounds.size();
  return object.area_m2 > 0.0 && std::isfinite(object.area_m2) && std::isfinite(extent.x + extent.y + extent.z);
}

// Returns how many there were; the scene has no bounds of theirs.
std::size_t drop_undrawable(Scene& scene) {
  const std::size_t dropped = std::erase_if(scene.objects, [](const Object& object) { return !drawable(object); });
  add_note(scene, Kind::kDropped, "objects", dropped, "transform flattens them to nothing or is not finite");
  if (dropped > 0) scene.bounds = Box();
  for (const Object& object : scene.objects) scene.bounds.extend(object.bounds);
  return dropped;
}

void check_not_empty(const Scene& scene, const fs::path& file) {
  if (!scene.objects.empty()) return;
  std::string why;
  for (const LoadNote& note : scene.notes) {
    if (note.kind == Kind::kDropped) why += "; dropped " + std::to_string(note.count) + " " + note.what + " (" + note.why + ")";
  }
  throw Failure(ErrorWord::kSceneEmpty, file.string() + " holds nothing that can be drawn" + why);
}

void check_size(const Scene& scene, const LoadOptions& options) {
  if (scene.triangle_count() <= options.max_triangles) return;
  throw Failure(ErrorWord::kTooLarge, "the scene draws " + std::to_string(scene.triangle_count()) + " triangles, more than the " +
                                          std::to_string(options.max_triangles) + " allowed");
}

}  // namespace

Scene load_scene(const fs::path& file, const LoadOptions& options) {
  const std::vector<std::uint8_t> bytes = read_bytes(file);
  auto digest = std::async(std::launch::async, [&] { return sha256_hex({reinterpret_cast<const char*>(bytes.data()), bytes.size()}); });
  Import import{{}, SceneFolder(file), options, {}};
  Scene& scene = import.scene;
  read(import, file, bytes);
  recentre(scene);
  place(import);
  update_derived(scene);
  (void)drop_undrawable(scene);
  check_not_empty(scene, file);
  check_size(scene, options);
  const bool split = split_objects(scene, options);
  prune(scene);
  if (split) {
    update_derived(scene);
    if (drop_undrawable(scene) > 0) prune(scene);  // pieces may be flat, though the whole is not
  }
  scene.name = file.filename().string();
  scene.sha256 = digest.get();
  return std::move(import.scene);
}

}  // namespace standin
