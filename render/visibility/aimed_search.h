// The objects seen from a region, and rays aimed at those that are not yet: what builds a visible set, before any statement about it.
//
// Rays go from random positions of the region to random points of an unseen object's triangles, more of them the larger the object may
// look. They start where they leave the region: what they pass before meets the region and is in the set
// without a ray, and what lies behind it is seen from there. Around every find a few rays explore its neighbours, through the same gap and
// from about the same place (guided visibility sampling, Wonka et al. 2006), which takes uniform rays a hundred times as long.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "render/base/rng.h"
#include "render/base/work.h"
#include "render/visibility/raytracer.h"

namespace standin {

class AimedSearch {
 public:
  /// Everything must outlive it. At most `rays` are shot, of all kinds (see spend()).
  AimedSearch(const Scene& scene, const Raytracer& raytracer, const Box& region, std::uint64_t rays, Rng& rng, const WorkBudget& budget);

  [[nodiscard]] bool is_seen(std::uint32_t object) const { return seen_[object]; }
  /// Ascending.
  [[nodiscard]] std::vector<std::uint32_t> seen() const;
  [[nodiscard]] std::uint64_t rays_left() const { return rays_left_; }
  /// Accounts for a ray shot elsewhere; false when none is left.
  [[nodiscard]] bool spend() { return rays_left_ > 0 && rays_left_-- > 0; }

  /// Rounds over all unseen objects, until one finds nothing or half of the rays left are spent.
  void aim();
  /// A ray from `position` saw it: explores around, if it is new. Returns whether it is.
  bool add(std::uint32_t object, const Vec3& position);

 private:
  struct Aim {
    std::uint32_t object = 0;
    std::uint32_t rays = 0;  // per round
  };
  [[nodiscard]] std::vector<Aim> aims() const;
  [[nodiscard]] std::uint64_t shoot(const std::vector<Aim>& aims);
  [[nodiscard]] Vec3 target_on(std::uint32_t object);
  [[nodiscard]] std::optional<Hit> shoot_at(const Vec3& target, const Vec3& position) const;

  const Scene& scene_;
  const Raytracer& raytracer_;
  const Box& region_;
  std::uint64_t rays_left_;
  std::uint64_t kept_rays_ = 0;  // not to be aimed
  Rng& rng_;
  const WorkBudget& budget_;
  std::vector<bool> seen_;
};

}  // namespace standin
