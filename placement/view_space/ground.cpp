#include "placement/view_space/ground.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace standin {
namespace {

class GroundFinder {
 public:
  GroundFinder(const HeightField& field, double max_rise_m)
      : field_(field),
        max_rise_m_(max_rise_m),
        ground_(field.height_m.size(), 0),
        ground_height_m_(field.height_m.size(), HeightField::kNone) {}

  std::vector<std::uint8_t> run() {
    const auto seed = largest_level_region();
    if (seed.empty()) return std::move(ground_);
    for (const std::size_t sample : seed) claim(sample);
    grow(seed);
    find_pockets();
    return std::move(ground_);
  }

 private:
  [[nodiscard]] bool has_surface(std::size_t sample) const { return field_.height_m[sample] != HeightField::kNone; }
  [[nodiscard]] double height(std::size_t sample) const { return field_.height_m[sample]; }

  template <class Visit>
  void for_neighbours(std::size_t sample, const Visit& visit) const {
    const auto width = static_cast<std::size_t>(field_.width);
    const std::size_t ix = sample % width;
    if (ix > 0) visit(sample - 1);
    if (ix + 1 < width) visit(sample + 1);
    if (sample >= width) visit(sample - width);
    if (sample + width < field_.height_m.size()) visit(sample + width);
  }

  // Samples joined by steps no higher than the limit, up or down; ties go to the region met first.
  [[nodiscard]] std::vector<std::size_t> largest_level_region() const {
    std::vector<bool> seen(field_.height_m.size(), false);
    std::vector<std::size_t> largest;
    for (std::size_t start = 0; start < seen.size(); ++start) {
      if (seen[start] || !has_surface(start)) continue;
      std::vector<std::size_t> region = {start};
      seen[start] = true;
      for (std::size_t next = 0; next < region.size(); ++next) {
        const std::size_t from = region[next];
        for_neighbours(from, [&](std::size_t to) {
          if (seen[to] || !has_surface(to) || std::abs(height(to) - height(from)) > max_rise_m_) return;
          seen[to] = true;
          region.push_back(to);
        });
      }
      if (region.size() > largest.size()) largest = std::move(region);
    }
    return largest;
  }

  void claim(std::size_t sample) {
    ground_[sample] = 1;
    ground_height_m_[sample] = height(sample);
  }

  // All that can be walked to from `sources`, up a step or down any; returns what was added.
  std::vector<std::size_t> grow(std::vector<std::size_t> sources) {
    std::vector<std::size_t> added;
    while (!sources.empty()) {
      const std::size_t from = sources.back();
      sources.pop_back();
      for_neighbours(from, [&](std::size_t to) {
        if (ground_[to] || !has_surface(to) || height(to) > height(from) + max_rise_m_) return;
        claim(to);
        added.push_back(to);
        sources.push_back(to);
      });
    }
    return added;
  }

  // Breadth first over what is not ground, carrying the height of the ground it started from.
  void find_pockets() {
    std::vector<std::size_t> front;
    for (std::size_t sample = 0; sample < ground_.size(); ++sample)
      if (ground_[sample]) front.push_back(sample);
    for (std::size_t next = 0; next < front.size(); ++next) {
      const std::size_t from = front[next];
      for_neighbours(from, [&](std::size_t to) {
        if (ground_height_m_[to] != HeightField::kNone) return;
        ground_height_m_[to] = ground_height_m_[from];
        front.push_back(to);
        if (!has_surface(to) || height(to) > ground_height_m_[to] + max_rise_m_) return;
        claim(to);
        for (const std::size_t added : grow({to})) front.push_back(added);
      });
    }
  }

  const HeightField& field_;
  double max_rise_m_;
  std::vector<std::uint8_t> ground_;
  std::vector<double> ground_height_m_;  // of the ground nearest to each sample, once known
};

}  // namespace

std::vector<std::uint8_t> find_ground(const HeightField& field, double max_rise_m) {
  return GroundFinder(field, max_rise_m).run();
}

}  // namespace standin
