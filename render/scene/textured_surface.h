// How far a simpler form of a textured mesh lies off, picture and all (not in the paper, which takes a scene's levels as given).
//
// Texture coordinates become metres by the greatest stretch s of the mesh's triangles: metres of surface per unit of coordinate, in the
// direction in which that is most. Then a bound e on the deviation in five dimensions (surface_deviation.h) bounds the place and the slip
// of the picture: where a point p of the original wears coordinates t, the other surface has a point within e of p that wears some t' with
// |t' - t| <= e / s, and under the map of p's own triangle t' belongs no farther than s |t' - t| <= e from p. The same holds the other way
// round. A mean stretch would not do: where the picture is stretched more than that, it may slip by more than e.
//
// Two kinds of triangles have no such map, or a useless one, and so no share in s:
// - Of one colour: all three corners wear the same coordinates (palettes). They are held against those of the very same coordinates alone,
//   by place: within e of every point of a colour there is one of that colour, both ways, so no border between colours has moved by more. A
//   triangle that mixes colours is none of them. It counts among the others, and is infinitely far off where the original has no others.
// - Stretched without bound (coordinates on a line), or many times more than the median: one of them would make s, and so every error, too
//   great for any use. A simpler form must hold each of these as it is, or its deviation is infinite.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "render/scene/surface_deviation.h"

namespace standin {

/// Metres of surface per unit of texture coordinate in the direction in which that is most; infinite where coordinates lie on a line.
[[nodiscard]] double metres_per_uv(const std::array<Vec3, 3>& places, const std::array<Vec2, 3>& uvs);

/// Per mesh: whether some part wears it with a texture. Coordinates of others mean nothing.
[[nodiscard]] std::vector<bool> worn_with_texture(const Scene& scene);

/// A mesh that simpler forms are held against.
class TexturedSurface {
 public:
  TexturedSurface(const Mesh& mesh, bool textured);

  /// Per triangle: whether every simpler form must hold it as it is.
  [[nodiscard]] const std::vector<bool>& kept() const { return kept_; }

  /// The greater of both ways' deviations; `limits.pieces` is not looked at: `pieces_per_triangle` of both meshes is the most, each way.
  [[nodiscard]] Deviation deviation_of(const Mesh& simple, DeviationLimits limits, double pieces_per_triangle) const;

 private:
  /// Coordinates that all corners wear; none: they differ, or mean nothing.
  using Colour = std::optional<std::array<float, 2>>;
  using Groups = std::map<Colour, ComparedSurface>;

  [[nodiscard]] Colour colour_of(const Mesh& mesh, std::size_t t) const;
  void measure_stretch(const Mesh& mesh);
  [[nodiscard]] SurfaceTriangle corners_of(const Mesh& mesh, std::size_t t, double metres_per_uv) const;
  [[nodiscard]] Groups groups_of(const Mesh& mesh, const std::vector<bool>& left_out) const;
  [[nodiscard]] bool holds_kept(const Mesh& simple, std::vector<bool>& held) const;

  bool textured_;
  double metres_per_uv_ = 0.0;  // s; 0 where coordinates mean nothing
  std::vector<bool> kept_;
  std::vector<ComparedSurface::Key> kept_keys_;  // sorted; coordinates as they are
  Groups groups_;                                // but for what is kept
};

}  // namespace standin
