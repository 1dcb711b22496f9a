// Rays against triangles, behind one header (the only file pair that includes Embree).
//
// Robust scenes (no leaks through shared edges); positions are stored relative to a local origin given in double. Alpha-masked texels count
// as transparent where `honour_masks`. Objects that look like others are instances of one tree; all
// others lie as plain triangles in the tree of the world, which is two to three times faster to search than instances whose boxes overlap.
// Thread-safe for queries. The scene must outlive the raytracer.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "render/scene/scene.h"

namespace standin {

struct Hit {
  double distance_m = 0.0;
  std::uint32_t object = 0;
};

class Raytracer {
 public:
  struct Options {
    bool honour_masks = true;
    int threads = 1;  // of the build
  };
  explicit Raytracer(const Scene& scene) : Raytracer(scene, Options{}) {}
  Raytracer(const Scene& scene, const Options& options);
  /// Only the named objects.
  Raytracer(const Scene& scene, const std::vector<std::uint32_t>& objects, const Options& options);
  ~Raytracer();
  Raytracer(Raytracer&&) noexcept;
  Raytracer& operator=(Raytracer&&) noexcept;

  /// Nearest hit with distance in (from_m, infinity); `direction` of unit length. Ties: lowest object id.
  [[nodiscard]] std::optional<Hit> nearest(const Vec3& origin, const Vec3& direction, double from_m = 0.0) const;
  /// Every hit along the ray in [from_m, to_m], ascending, coincident ones included. Distances are single precision: leave room at the
  /// ends.
  [[nodiscard]] std::vector<Hit> all(const Vec3& origin, const Vec3& direction, double from_m, double to_m) const;

  struct State;  // Embree's side, in the source file

 private:
  std::unique_ptr<State> state_;
};

}  // namespace standin
