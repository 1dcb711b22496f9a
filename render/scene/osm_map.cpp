#include "render/scene/osm_map.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <regex>
#include <set>

#include "render/base/error.h"
#include "render/scene/city_parts.h"
#include "render/scene/file_access.h"
#include "render/scene/osm_tile.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

constexpr double kEquator_m = 40'075'016.686;
constexpr double kStep_m = 100.0;  // of the search for the densest part
constexpr double kLeastBuilding_m2 = 12.0;
constexpr double kMostFloors = 120.0;
constexpr double kOneWayShare = 0.6;  // dual carriageways are two one-way lines

struct TileName {
  fs::path file;
  int zoom = 0;
  std::int64_t column = 0;
  std::int64_t row = 0;
};

std::vector<TileName> tiles_in(const fs::path& folder) {
  static const std::regex kName(R"((\d{1,2})-(\d{1,8})-(\d{1,8})\.(mvt|pbf)(\.gz)?)");
  std::error_code error;
  std::vector<TileName> tiles;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::smatch match;
    const std::string name = entry.path().filename().string();
    if (std::regex_match(name, match, kName))
      tiles.push_back({entry.path(), std::stoi(match[1]), std::stoll(match[2]), std::stoll(match[3])});
  }
  if (error) throw Failure(ErrorWord::kFileMissing, folder.string() + ": " + error.message());
  if (tiles.empty()) throw Failure(ErrorWord::kFileMissing, folder.string() + " holds no tile (ZOOM-COLUMN-ROW.mvt)");
  std::sort(tiles.begin(), tiles.end(), [](const TileName& a, const TileName& b) { return a.file < b.file; });
  for (const TileName& tile : tiles) {
    if (tile.zoom != tiles.front().zoom)
      throw Failure(ErrorWord::kFileBroken, tile.file.string() + " is of another zoom level than " + tiles.front().file.string());
  }
  return tiles;
}

double number_in(const std::string& text) {
  double number = 0.0;
  const char* end = text.data() + text.size();
  return std::from_chars(text.data(), end, number).ec == std::errc() && std::isfinite(number) ? number : 0.0;
}

// Web Mercator on the spot: metres from the north-western corner of all tiles, at the latitude of their middle.
class Projection {
 public:
  explicit Projection(const std::vector<TileName>& tiles) {
    column_ = tiles.front().column;
    row_ = tiles.front().row;
    std::int64_t last = row_;
    for (const TileName& tile : tiles) {
      column_ = std::min(column_, tile.column);
      row_ = std::min(row_, tile.row);
      last = std::max(last, tile.row);
    }
    const double world = std::exp2(tiles.front().zoom);
    const double middle = 0.5 * static_cast<double>(row_ + last + 1) / world;
    const double latitude = std::atan(std::sinh(std::numbers::pi * (1.0 - 2.0 * middle)));
    tile_m_ = kEquator_m / world * std::cos(latitude);
  }

  [[nodiscard]] Path metres(const Path& path, const TileName& tile) const {
    const Vec2 corner(static_cast<double>(tile.column - column_), static_cast<double>(tile.row - row_));
    Path result;
    for (const Vec2& point : path) result.push_back((corner + point) * tile_m_);
    return result;
  }

 private:
  std::int64_t column_ = 0;
  std::int64_t row_ = 0;
  double tile_m_ = 1.0;
};

// Rings that run as the first one does open a polygon, the others are its holes (specification, 4.3.4.4; old tiles run the other way).
std::vector<Polygon> polygons_of(const std::vector<Path>& rings) {
  std::vector<Polygon> polygons;
  double outer = 0.0;
  for (const Path& ring : rings) {
    const double area = signed_area(ring);
    if (area == 0.0) continue;
    if (outer == 0.0) outer = area;
    if ((area > 0.0) == (outer > 0.0))
      polygons.push_back({ring, {}});
    else
      polygons.back().holes.push_back(ring);
  }
  return polygons;
}

// Carriageways with their parking lanes; 0: not a street.
double street_width_m(const std::string& highway) {
  static const std::map<std::string, double> kWidths{{"motorway", 24},      {"trunk", 22},        {"primary", 20},     {"secondary", 16},
                                                     {"tertiary", 13},      {"motorway_link", 8}, {"trunk_link", 8},   {"primary_link", 8},
                                                     {"secondary_link", 8}, {"tertiary_link", 8}, {"unclassified", 9}, {"residential", 9},
                                                     {"living_street", 8},  {"service", 6},       {"track", 4},        {"pedestrian", 6},
                                                     {"footway", 2.6},      {"path", 2.0},        {"cycleway", 2.4},   {"steps", 2.6}};
  const auto found = kWidths.find(highway);
  return found == kWidths.end() ? 0.0 : found->second;
}

bool for_vehicles(const std::string& highway) {
  static const std::set<std::string> kOnFoot{"pedestrian", "footway", "path", "cycleway", "steps"};
  return !kOnFoot.contains(highway);
}

bool is_green(const TileFeature& feature) {
  static const std::set<std::string> kLanduse{"grass", "village_green", "forest", "meadow", "recreation_ground", "orchard"};
  static const std::set<std::string> kLeisure{"park", "garden", "common"};
  static const std::set<std::string> kNatural{"scrub", "grassland", "wood"};
  return kLanduse.contains(feature.tag("landuse")) || kLeisure.contains(feature.tag("leisure")) ||
         kNatural.contains(feature.tag("natural"));
}

bool is_water(const TileFeature& feature) {
  return feature.tag("natural") == "water" || feature.tag("waterway") == "riverbank";
}

bool is_underground(const TileFeature& feature) {
  const std::string& tunnel = feature.tag("tunnel");
  return (!tunnel.empty() && tunnel != "no") || number_in(feature.tag("layer")) < 0.0;
}

struct RawArea {
  std::vector<Polygon> polygons;
  PlanBox bounds;
  double floors = 0.0;

  void add(const Polygon& polygon) {
    polygons.push_back(polygon);
    bounds.extend(polygon.shell);
  }
};

// Everything in the tiles, before the densest part is known.
class Survey {
 public:
  void add(const TileFeature& feature, const TileName& tile, const Projection& projection) {
    std::vector<Path> paths;
    for (const Path& path : feature.paths) paths.push_back(projection.metres(path, tile));
    for (const Path& path : paths) all_.extend(path);
    if (feature.kind == TileFeature::Kind::kLine && !is_underground(feature)) add_street(feature, paths);
    if (feature.kind != TileFeature::Kind::kPolygon) return;
    const std::string& building = feature.tag("building");
    if (!building.empty() && building != "no")
      add_building(feature, paths);
    else if (is_green(feature) || is_water(feature))
      add_area(is_water(feature) ? waters_ : greens_, paths);
  }

  [[nodiscard]] bool has_buildings() const { return !buildings_.empty(); }

  [[nodiscard]] StreetMap cut() const {
    const PlanBox box = densest();
    StreetMap map;
    map.bounds = {Vec2(0.0), box.size()};
    for (const RawArea& raw : buildings_) add_building(map, raw, box);
    for (const MapStreet& street : streets_) {
      if (PlanBox bounds = bounds_of(street.line); bounds.meets(box))
        map.streets.push_back({moved(street.line, -box.min), street.width_m, street.vehicles});
    }
    add_areas(map.greens, greens_, box);
    add_areas(map.waters, waters_, box);
    return map;
  }

 private:
  static PlanBox bounds_of(const Path& path) {
    PlanBox bounds;
    bounds.extend(path);
    return bounds;
  }

  static Path moved(Path path, const Vec2& by) {
    for (Vec2& point : path) point += by;
    return path;
  }

  static Region region_of(const RawArea& raw, const Vec2& by) {
    std::vector<Region> parts;
    for (Polygon polygon : raw.polygons) {
      polygon.shell = moved(std::move(polygon.shell), by);
      for (Path& hole : polygon.holes) hole = moved(std::move(hole), by);
      parts.push_back(Region::of(polygon));
    }
    return parts.size() == 1 ? std::move(parts.front()) : Region::united(parts);
  }

  void add_street(const TileFeature& feature, const std::vector<Path>& paths) {
    const std::string& highway = feature.tag("highway");
    double width_m = street_width_m(highway);
    if (width_m == 0.0) return;
    if (const double lanes = number_in(feature.tag("lanes")); lanes >= 1.0 && lanes <= 12.0)
      width_m = 3.5 * lanes + 1.0;
    else if (feature.tag("oneway") == "yes" && width_m > 9.0)
      width_m *= kOneWayShare;
    for (const Path& path : paths) {
      if (path.size() >= 2) streets_.push_back({path, width_m, for_vehicles(highway)});
    }
  }

  // A building on the border of two tiles is in both, with the same identity.
  void add_building(const TileFeature& feature, const std::vector<Path>& rings) {
    const std::vector<Polygon> polygons = polygons_of(rings);
    if (polygons.empty()) return;
    const std::string identity = feature.tag("@type") + feature.tag("@id");
    const auto [place, fresh] =
        identity.empty() ? std::pair(by_identity_.end(), true) : by_identity_.try_emplace(identity, buildings_.size());
    if (fresh) buildings_.emplace_back();
    RawArea& raw = fresh ? buildings_.back() : buildings_[place->second];
    double area_m2 = 0.0;
    for (const Polygon& polygon : polygons) {
      raw.add(polygon);
      area_m2 += std::abs(signed_area(polygon.shell));
    }
    const std::string& height = feature.tag("building:height").empty() ? feature.tag("height") : feature.tag("building:height");
    raw.floors = std::max(raw.floors, floors_of(feature.tag("building:levels"), height, area_m2));
  }

  static void add_area(std::vector<RawArea>& areas, const std::vector<Path>& rings) {
    for (const Polygon& polygon : polygons_of(rings)) {
      areas.emplace_back();
      areas.back().add(polygon);
    }
  }

  static void add_building(StreetMap& map, const RawArea& raw, const PlanBox& box) {
    if (!box.holds(raw.bounds)) return;
    MapBuilding building{region_of(raw, -box.min), {raw.bounds.min - box.min, raw.bounds.max - box.min}, raw.floors};
    const double area_m2 = building.footprint.area_m2();
    if (area_m2 < kLeastBuilding_m2) return;
    for (const MapBuilding& other : map.buildings) {
      if (other.bounds.meets(building.bounds) && other.footprint.common(building.footprint).area_m2() > 0.5 * area_m2) return;
    }
    map.buildings.push_back(std::move(building));
  }

  static void add_areas(std::vector<Region>& to, const std::vector<RawArea>& areas, const PlanBox& box) {
    for (const RawArea& raw : areas) {
      if (raw.bounds.meets(box)) to.push_back(region_of(raw, -box.min));
    }
  }

  // Every 100 m, and the end.
  static std::vector<double> steps(double end_m) {
    std::vector<double> result;
    for (int i = 0; i * kStep_m < end_m; ++i) result.push_back(i * kStep_m);
    result.push_back(end_m);
    return result;
  }

  // Of the boxes on a grid of 100 m the one whose buildings have the most floors in sum; the first of equals.
  [[nodiscard]] PlanBox densest() const {
    const Vec2 room = glm::max(all_.size() - kMapSize_m, Vec2(0.0));
    PlanBox best{all_.min, all_.min + kMapSize_m};
    double most = -1.0;
    for (const double y : steps(room.y)) {
      for (const double x : steps(room.x)) {
        const PlanBox box{all_.min + Vec2(x, y), all_.min + Vec2(x, y) + kMapSize_m};
        double floors = 0.0;
        for (const RawArea& raw : buildings_) {
          if (box.holds(raw.bounds)) floors += raw.floors;
        }
        if (floors <= most) continue;
        most = floors;
        best = box;
      }
    }
    return best;
  }

  PlanBox all_;
  std::vector<RawArea> buildings_;
  std::map<std::string, std::size_t> by_identity_;
  std::vector<MapStreet> streets_;
  std::vector<RawArea> greens_;
  std::vector<RawArea> waters_;
};

}  // namespace

double floors_of(const std::string& levels, const std::string& height, double area_m2) {
  if (const double floors = number_in(levels); floors > 0.0) return std::clamp(floors, 1.0, kMostFloors);
  if (const double height_m = number_in(height); height_m > 0.0) return std::clamp(std::round(height_m / kFloorHeight_m), 1.0, kMostFloors);
  return area_m2 < 300.0 ? 1.0 : 2.0;
}

StreetMap read_street_map(const fs::path& folder) {
  const std::vector<TileName> tiles = tiles_in(folder);
  const Projection projection(tiles);
  Survey survey;
  for (const TileName& tile : tiles) {
    for (const TileFeature& feature : read_vector_tile(read_bytes(tile.file), tile.file.string())) survey.add(feature, tile, projection);
  }
  if (!survey.has_buildings())
    throw Failure(ErrorWord::kSceneEmpty, folder.string() + ": no building in " + std::to_string(tiles.size()) + " tiles");
  StreetMap map = survey.cut();
  if (map.buildings.empty()) throw Failure(ErrorWord::kSceneEmpty, folder.string() + ": no building fits the map's 1.5 x 1.0 km");
  return map;
}

}  // namespace standin
