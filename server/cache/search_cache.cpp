#include "server/cache/search_cache.h"

#include <algorithm>
#include <numeric>

#include "estimation/feature_table.h"
#include "server/cache/camera_content.h"
#include "server/cache/object_content.h"

namespace standin {
namespace {

// Which kinds of pixels any part of the scene has: they bound what all pixels of a frame cost.
void add_pixel_kinds(const Scene& scene, Fingerprinter& to) {
  for (const PixelKind kind : {PixelKind::kPlain, PixelKind::kTextured, PixelKind::kMasked})
    to.add(std::ranges::any_of(scene.parts, [&](const Part& part) { return pixel_kind(scene, part) == kind; }));
}

Fingerprint shared_inputs(const SearchScene& job) {
  Fingerprinter to;
  add_camera(job.camera, to);
  for (const double ms : job.model.milliseconds_per_unit) to.add(ms);
  to.add(job.model.combination).add(job.options.interval_deg).add(job.options.bounds);
  add_pixel_kinds(job.scene, to);
  return to.fingerprint();
}

template <class Bytes, class Interval>
void pass_interval(Bytes& bytes, Interval& interval) {
  bytes.pass(interval.face);
  bytes.pass(interval.level);
  bytes.pass(interval.i);
  bytes.pass(interval.j);
}

template <class Bytes, class Region>
void pass_region(Bytes& bytes, Region& region) {
  pass_interval(bytes, region.interval);
  bytes.pass(region.pixels_capped);
  bytes.pass(region.constant_ms);
  bytes.pass(region.predicted_ms);
}

// Of a search but for its regions, which follow, and their number.
template <class Bytes, class Search>
void pass_summary(Bytes& bytes, Search& search, std::uint64_t& regions) {
  bytes.pass(search.predicted_budget_ms);
  bytes.pass(search.found.worst_predicted_ms);
  pass_interval(bytes, search.found.worst_interval);
  bytes.pass(regions);
}

std::vector<RegionTerm> read_terms(ByteReader& bytes, const std::vector<std::uint32_t>& by_rank) {
  const auto positions = bytes.list<std::uint32_t>();
  const auto costs_ms = bytes.list<double>();
  if (positions.size() != costs_ms.size()) throw Failure(ErrorWord::kFileBroken, "a region has not as many costs as objects");
  std::vector<RegionTerm> terms;
  terms.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (positions[i] >= by_rank.size()) throw Failure(ErrorWord::kFileBroken, "no visible object " + std::to_string(positions[i]));
    terms.push_back({by_rank[positions[i]], costs_ms[i]});
  }
  return terms;
}

RememberedSearch read_search(ByteReader& bytes, const std::vector<std::uint32_t>& by_rank) {
  RememberedSearch search;
  std::uint64_t regions = 0;
  pass_summary(bytes, search, regions);
  for (std::uint64_t i = 0; i < regions; ++i) {
    HotRegion region;
    pass_region(bytes, region);
    search.found.add(region, read_terms(bytes, by_rank));
  }
  search.found.terms.shrink_to_fit();
  return search;
}

}  // namespace

SearchCache::SearchCache(StageCache& cache, const SearchScene& scene)
    : cache_(cache),
      job_(scene),
      shared_(shared_inputs(scene)),
      contents_(cost_contents(scene.scene)),
      visible_(scene.visibility.sets.size() + 1) {}

const SearchCache::VisibleObjects& SearchCache::visible_from(std::int32_t visible_set) {
  VisibleObjects& objects = visible_set < 0 ? visible_.back() : visible_[static_cast<std::size_t>(visible_set)];
  std::call_once(objects.once, [&] { look_up(visible_set, objects); });
  return objects;
}

void SearchCache::look_up(std::int32_t visible_set, VisibleObjects& objects) const {
  if (visible_set < 0) {
    objects.by_rank.resize(job_.scene.objects.size());
    std::iota(objects.by_rank.begin(), objects.by_rank.end(), 0U);
  } else {
    objects.by_rank = job_.visibility.sets[static_cast<std::size_t>(visible_set)];
  }
  std::ranges::sort(objects.by_rank, {}, [&](std::uint32_t id) { return job_.hierarchy_rank[id]; });
  Fingerprinter to;
  to.add(std::uint64_t{objects.by_rank.size()});
  for (const std::uint32_t id : objects.by_rank) to.add(contents_[id]);
  objects.content = to.fingerprint();
}

Fingerprint SearchCache::inputs_of(const SearchRequest& request) {
  Fingerprinter to;
  to.add(shared_).add(visible_from(request.visible_set).content).add(std::uint64_t{request.chain.size()});
  for (const Box& box : request.chain) to.add(box);
  return to.fingerprint();
}

std::shared_ptr<const RememberedSearch> SearchCache::recall(const SearchRequest& request) {
  if (auto known = SearchMemory::recall(request)) return known;
  const auto& by_rank = visible_from(request.visible_set).by_rank;
  const auto spares_the_search = [&](const RememberedSearch& search) { return search.predicted_budget_ms <= request.predicted_budget_ms; };
  const auto stored = cache_.recall(
      kSearches, inputs_of(request), [&](ByteReader& bytes) { return read_search(bytes, by_rank); }, spares_the_search);
  if (!stored) return nullptr;
  SearchRequest as_stored = request;
  as_stored.predicted_budget_ms = stored->predicted_budget_ms;
  SearchMemory::keep(as_stored, stored->found);
  return SearchMemory::recall(request);
}

void SearchCache::keep(const SearchRequest& request, const DirectionSearchResult& found) {
  SearchMemory::keep(request, found);
  cache_.keep(kSearches, inputs_of(request), bytes_of({request.predicted_budget_ms, found}, visible_from(request.visible_set).by_rank));
}

// The terms of a region are in hierarchy order, as the list is.
std::string SearchCache::bytes_of(const RememberedSearch& search, const std::vector<std::uint32_t>& by_rank) const {
  const auto rank_of = [&](std::uint32_t id) { return job_.hierarchy_rank[id]; };
  ByteWriter bytes;
  std::uint64_t regions = search.found.hot.size();
  pass_summary(bytes, search, regions);
  for (const HotRegion& region : search.found.hot) {
    pass_region(bytes, region);
    std::vector<std::uint32_t> positions;
    std::vector<double> costs_ms;
    for (const RegionTerm& term : search.found.terms_of(region)) {
      positions.push_back(
          static_cast<std::uint32_t>(std::ranges::lower_bound(by_rank, rank_of(term.object), {}, rank_of) - by_rank.begin()));
      costs_ms.push_back(term.predicted_ms);
    }
    bytes.list(positions);
    bytes.list(costs_ms);
  }
  return bytes.bytes();
}

}  // namespace standin
