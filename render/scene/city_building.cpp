// Buildings: a body with painted windows to which ornaments are added, floor by floor, while the budget lasts; finally every triangle is
// quartered as often as the budget allows.

#include <cmath>
#include <functional>

#include "render/scene/city_parts.h"
#include "render/scene/mesh_builder.h"

namespace standin {
namespace {

constexpr double kRoofHeight_m = 3.2;
// Where the painted window lies within its bay and floor (city_textures.cpp, in 64ths of a cell).
constexpr double kWindowLeft = 16.0 / 64.0;
constexpr double kWindowRight = 48.0 / 64.0;
constexpr double kWindowFoot = 10.0 / 64.0;
constexpr double kWindowHead = 54.0 / 64.0;

class Building {
 public:
  explicit Building(const BuildingShape& shape)
      : shape_(shape),
        bays_(std::max(1, static_cast<int>(std::lround(shape.width_m / kBayWidth_m)))),
        eaves_m_(shape.floors * kFloorHeight_m),
        half_(0.5 * shape.width_m, 0.5 * shape.depth_m) {
    add_walls();
    shape_.gabled ? add_gabled_roof() : add_mansard_roof();
  }

  // Each ornament that still fits, in order of how much it changes the picture.
  void adorn(std::uint64_t triangles) {
    const auto within = [&](std::size_t cost, const std::function<void()>& add) {
      if (count() + cost <= triangles) add();
    };
    for (const int side : {1, -1}) within(10, [&] { add_course(side, eaves_m_ - 0.35, 0.35, 0.45); });
    for (const double x : {-0.3, 0.35}) within(10, [&] { add_chimney(x * shape_.width_m); });
    for (const int side : {1, -1}) {
      for (int floor = 0; floor < shape_.floors; ++floor) {
        within(10, [&] { add_course(side, floor * kFloorHeight_m, 0.22, 0.12); });
        within(10 * bays(), [&] { add_sills(side, floor); });
        within(30 * bays(), [&] { add_frames(side, floor); });
      }
      within(10 * bays(), [&] { add_dormers(side); });
    }
    for (int floor = 1; floor < shape_.floors; ++floor) within(bays() / 2 * kBalconyTriangles, [&] { add_balconies(floor); });
  }

  [[nodiscard]] Model finish(std::uint64_t triangles) {
    Model model;
    model.parts.push_back({walls_.finish("walls"), Surface::kFacade});
    model.parts.push_back({roof_.finish("roof"), Surface::kRoof});
    if (trim_.triangle_count() > 0) model.parts.push_back({trim_.finish("trim"), Surface::kTrim});
    while (4 * model.triangle_count() <= triangles) {
      for (ModelPart& part : model.parts) part.mesh = refined(part.mesh);
    }
    return model;
  }

 private:
  static constexpr int kBars = 7;
  static constexpr std::size_t kBalconyTriangles = 20 + 8 * kBars;

  [[nodiscard]] std::size_t count() const { return walls_.triangle_count() + roof_.triangle_count() + trim_.triangle_count(); }
  [[nodiscard]] std::size_t bays() const { return static_cast<std::size_t>(bays_); }
  [[nodiscard]] double bay_width_m() const { return shape_.width_m / bays_; }
  [[nodiscard]] double bay_left_m(int bay) const { return -half_.x + bay * bay_width_m(); }

  void add_walls() {
    const auto wall = [&](const Vec3& a, const Vec3& b, double width_m) {
      const double bays = std::max(1.0, std::round(width_m / kBayWidth_m));
      const UvRect uv{{0.0, 0.0}, {bays / kFacadeBays, static_cast<double>(shape_.floors) / kFacadeFloors}};
      const Vec3 up(0.0, eaves_m_, 0.0);
      walls_.patch(a, b, b + up, a + up, 1, 1, uv);
    };
    const auto [x, z] = std::pair(half_.x, half_.y);
    wall({-x, 0, z}, {x, 0, z}, shape_.width_m);
    wall({x, 0, z}, {x, 0, -z}, shape_.depth_m);
    wall({x, 0, -z}, {-x, 0, -z}, shape_.width_m);
    wall({-x, 0, -z}, {-x, 0, z}, shape_.depth_m);
  }

  [[nodiscard]] UvRect tiles(double width_m, double height_m) const { return {{0.0, 0.0}, {width_m / 4.0, height_m / 4.0}}; }

  void add_gabled_roof() {
    const auto [x, z, e, r] = std::tuple(half_.x, half_.y, eaves_m_, eaves_m_ + kRoofHeight_m);
    const double slope_m = std::hypot(z, kRoofHeight_m);
    roof_.patch({-x, e, z}, {x, e, z}, {x, r, 0}, {-x, r, 0}, 1, 1, tiles(shape_.width_m, slope_m));
    roof_.patch({x, e, -z}, {-x, e, -z}, {-x, r, 0}, {x, r, 0}, 1, 1, tiles(shape_.width_m, slope_m));
    roof_.triangle({x, e, z}, {x, e, -z}, {x, r, 0});
    roof_.triangle({-x, e, -z}, {-x, e, z}, {-x, r, 0});
  }

  void add_mansard_roof() {
    const auto [x, z, e, r] = std::tuple(half_.x, half_.y, eaves_m_, eaves_m_ + kRoofHeight_m);
    const double inset = 1.6;
    const auto [u, w] = std::pair(x - inset, z - inset);
    const double slope_m = std::hypot(inset, kRoofHeight_m);
    roof_.patch({-x, e, z}, {x, e, z}, {u, r, w}, {-u, r, w}, 1, 1, tiles(shape_.width_m, slope_m));
    roof_.patch({x, e, z}, {x, e, -z}, {u, r, -w}, {u, r, w}, 1, 1, tiles(shape_.depth_m, slope_m));
    roof_.patch({x, e, -z}, {-x, e, -z}, {-u, r, -w}, {u, r, -w}, 1, 1, tiles(shape_.width_m, slope_m));
    roof_.patch({-x, e, -z}, {-x, e, z}, {-u, r, w}, {-u, r, -w}, 1, 1, tiles(shape_.depth_m, slope_m));
    roof_.patch({-u, r, w}, {u, r, w}, {u, r, -w}, {-u, r, -w}, 1, 1, tiles(2 * u, 2 * w));
  }

  // A box on the front (side 1) or the back (side -1), standing out of the wall.
  void add_on_wall(int side, double left, double right, double low, double high, double out_m) {
    const double wall = side * half_.y;
    const double face = wall + side * out_m;
    trim_.box({left, low, std::min(wall, face)}, {right, high, std::max(wall, face)});
  }

  void add_course(int side, double foot_m, double height_m, double out_m) {
    add_on_wall(side, -half_.x, half_.x, foot_m, foot_m + height_m, out_m);
  }

  void add_chimney(double x) { trim_.box({x - 0.4, eaves_m_, -0.6}, {x + 0.4, eaves_m_ + kRoofHeight_m + 1.1, 0.6}); }

  void add_sills(int side, int floor) {
    const double foot = (floor + kWindowFoot) * kFloorHeight_m;
    for (int bay = 0; bay < bays_; ++bay) {
      const double left = bay_left_m(bay);
      add_on_wall(side, left + (kWindowLeft - 0.04) * bay_width_m(), left + (kWindowRight + 0.04) * bay_width_m(), foot - 0.1, foot, 0.2);
    }
  }

  void add_frames(int side, int floor) {
    const double foot = (floor + kWindowFoot) * kFloorHeight_m;
    const double head = (floor + kWindowHead) * kFloorHeight_m;
    for (int bay = 0; bay < bays_; ++bay) {
      const double left = bay_left_m(bay) + kWindowLeft * bay_width_m();
      const double right = bay_left_m(bay) + kWindowRight * bay_width_m();
      add_on_wall(side, left - 0.12, left, foot, head, 0.1);
      add_on_wall(side, right, right + 0.12, foot, head, 0.1);
      add_on_wall(side, left - 0.2, right + 0.2, head, head + 0.18, 0.22);
    }
  }

  void add_dormers(int side) {
    for (int bay = 0; bay < bays_; ++bay) {
      const double middle = bay_left_m(bay) + 0.5 * bay_width_m();
      const double face = side * (half_.y - 0.7);
      const double back = side * (half_.y - 2.6);
      trim_.box({middle - 0.6, eaves_m_ + 0.5, std::min(face, back)}, {middle + 0.6, eaves_m_ + 2.1, std::max(face, back)});
    }
  }

  void add_balconies(int floor) {
    const double foot = floor * kFloorHeight_m + 0.3;
    for (int bay = 1; bay < bays_; bay += 2) {
      const double left = bay_left_m(bay) + 0.1;
      const double right = bay_left_m(bay + 1) - 0.1;
      add_on_wall(1, left, right, foot - 0.15, foot, 0.9);
      add_on_wall(1, left, right, foot + 0.95, foot + 1.0, 0.9);
      for (int bar = 0; bar < kBars; ++bar) {
        const double x = left + 0.05 + (right - left - 0.1) * bar / (kBars - 1);
        const double z = half_.y + 0.86;
        trim_.tube({x, foot, z}, {x, foot + 0.95, z}, 0.02, 0.02, 4, 1);
      }
    }
  }

  BuildingShape shape_;
  int bays_;
  double eaves_m_;
  Vec2 half_;
  MeshBuilder walls_;
  MeshBuilder roof_;
  MeshBuilder trim_;
};

}  // namespace

Model make_building(const BuildingShape& shape, std::uint64_t triangles) {
  Building building(shape);
  building.adorn(triangles);
  return building.finish(triangles);
}

}  // namespace standin
