#include "order/kept_order.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

namespace sightcell::bake {
namespace {

constexpr std::uint32_t unknown = UINT32_MAX;
constexpr std::uint32_t new_draw = UINT32_MAX - 1, empty_draw = UINT32_MAX;  // places behind all others

struct shaped_draw {
  const format::draw_record* record = nullptr;
  std::uint64_t hash = 0;  // of its geometry; 0 if none is known
  std::string node;        // its name; empty if none is known
};

// Returns draws in source order. hashes: of those with polygons.
std::vector<shaped_draw> shaped(std::span<const format::draw_record> draws, const std::vector<std::uint64_t>& hashes,
                                const std::vector<std::string>& node_names) {
  std::vector<shaped_draw> all;
  for (const format::draw_record& d : draws) all.push_back({.record = &d, .hash = 0, .node = {}});
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return source_place(*a.record) < source_place(*b.record); });
  std::size_t with_polygons = 0;
  for (shaped_draw& d : all) {
    if (d.record->polygon_count > 0 && with_polygons < hashes.size()) d.hash = hashes[with_polygons++];
    if (d.record->node < node_names.size()) d.node = node_names[d.record->node];
  }
  return all;
}

class order_keeper {
 public:
  order_keeper(std::span<const format::draw_record> table, bool merged, const draw_identity& identity,
               const earlier_order& before)
      : before_(before),
        now_(shaped(table, identity.hashes, identity.node_names)),
        then_(shaped(before.file.draws, before.file.geometry_hashes, before.file.node_names)) {
    for (std::size_t i = 0; i < then_.size(); ++i) {
      if (then_[i].hash == 0) continue;
      by_shape_.try_emplace({then_[i].hash, std::string()}, i);
      by_shape_.try_emplace({then_[i].hash, then_[i].node}, i);
    }
    std::uint32_t polygons = 0;
    for (const shaped_draw& d : now_) polygons = std::max(polygons, d.record->first_source + d.record->polygon_count);
    stored_.assign(polygons, unknown);
    old_.assign(polygons, unknown);
    note_stored_numbers(merged);
  }

  const std::vector<shaped_draw>& draws() const { return now_; }

  // Returns the order of the polygons of some draws, one after the other.
  std::vector<std::uint32_t> order_of(std::span<const std::size_t> draws) const {
    std::vector<std::uint32_t> ranks, order;
    for (const std::size_t d : draws) {
      const format::draw_record& r = *now_[d].record;
      ranks.insert(ranks.end(), stored_.begin() + r.first_source, stored_.begin() + r.first_source + r.polygon_count);
    }
    const auto known = std::find_if(ranks.begin(), ranks.end(), [](std::uint32_t rank) { return rank != unknown; });
    std::uint32_t last = known != ranks.end() ? *known : 0;
    for (std::uint32_t& rank : ranks) last = rank = rank != unknown ? rank : last;
    order.resize(ranks.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return ranks[a] < ranks[b]; });
    return order;
  }

  // Returns the order of the earlier draw that a draw is now; null if there is none.
  const std::vector<std::uint32_t>* same_order(std::size_t draw) const {
    const std::optional<std::size_t> found = earlier(draw);
    if (!found) return nullptr;
    const format::draw_record &then = *then_[*found].record, &now = *now_[draw].record;
    if (then.polygon_count != now.polygon_count) return nullptr;
    for (std::uint32_t i = 0; i < now.polygon_count; ++i) {
      const std::uint32_t old = old_[now.first_source + i];
      if (old != unknown && old != then.first_source + i) return nullptr;
    }
    const auto place = static_cast<std::size_t>(&then - before_.file.draws.data());
    return &before_.file.orders[before_.file.order_of_draw[place]];
  }

  // Returns the number of polygons of a draw that were there.
  std::size_t known(std::size_t draw) const {
    const format::draw_record& r = *now_[draw].record;
    return r.polygon_count -
           static_cast<std::size_t>(std::count(stored_.begin() + r.first_source,
                                               stored_.begin() + r.first_source + r.polygon_count, unknown));
  }

  // Returns where the first polygon of a draw was stored, or that of a draw with the same geometry and name.
  std::uint32_t place_of(std::size_t draw) const {
    const format::draw_record& r = *now_[draw].record;
    if (r.polygon_count == 0) return empty_draw;
    const std::uint32_t first =
        *std::min_element(stored_.begin() + r.first_source, stored_.begin() + r.first_source + r.polygon_count);
    if (first != unknown) return first;
    const auto same = by_shape_.find({now_[draw].hash, now_[draw].node});
    return same != by_shape_.end() ? then_[same->second].record->first_stored : new_draw;
  }

 private:
  // Fills in where the polygons of now were stored.
  void note_stored_numbers(bool merged) {
    const std::vector<format::draw_record>& draws = before_.file.draws;
    std::vector<std::uint32_t> sources;  // of the draws with one order, one after the other
    for (std::size_t d = 0; d < draws.size();) {
      const std::size_t first = d;
      sources.clear();
      do {
        for (std::uint32_t i = 0; i < draws[d].polygon_count; ++i) sources.push_back(draws[d].first_source + i);
        ++d;
      } while (merged && d < draws.size() && draws[d].group == draws[first].group);
      const std::vector<std::uint32_t>& order = before_.file.orders[before_.file.order_of_draw[first]];
      for (std::uint32_t i = 0; i < sources.size(); ++i) note(sources[order[i]], draws[first].first_stored + i);
    }
  }

  void note(std::uint32_t old, std::uint32_t stored) {
    const std::uint32_t now = before_.new_of[old];
    if (now == unknown) return;
    stored_[now] = stored;
    old_[now] = old;
  }

  // Returns the earlier draw that had the first known polygon of a draw, else one with the same geometry.
  std::optional<std::size_t> earlier(std::size_t draw) const {
    const format::draw_record& r = *now_[draw].record;
    for (std::uint32_t i = 0; i < r.polygon_count; ++i) {
      const std::uint32_t old = old_[r.first_source + i];
      if (old == unknown) continue;
      const auto after =
          std::upper_bound(then_.begin(), then_.end(), old,
                           [](std::uint32_t source, const shaped_draw& d) { return source < d.record->first_source; });
      return static_cast<std::size_t>(after - then_.begin()) - 1;
    }
    if (now_[draw].hash == 0) return std::nullopt;
    for (const std::string& node : {now_[draw].node, std::string()})
      if (const auto found = by_shape_.find({now_[draw].hash, node}); found != by_shape_.end()) return found->second;
    return std::nullopt;
  }

  const earlier_order& before_;
  std::vector<shaped_draw> now_, then_;                                    // in source order
  std::map<std::pair<std::uint64_t, std::string>, std::size_t> by_shape_;  // the first draw of a hash and node name
  std::vector<std::uint32_t> stored_, old_;  // by source id of now: where and as what it was; unknown: new
};

// Returns the order of draws that share one. With several, the first that is what it was decides, else the one with
// the most polygons that were there.
std::vector<std::uint32_t> shared_order(const order_keeper& keeper, const std::vector<std::size_t>& draws) {
  for (const std::size_t d : draws)
    if (const std::vector<std::uint32_t>* same = keeper.same_order(d)) return *same;
  const std::size_t most = *std::max_element(
      draws.begin(), draws.end(), [&](std::size_t a, std::size_t b) { return keeper.known(a) < keeper.known(b); });
  return keeper.order_of(std::span(&most, 1));
}

// Returns the numbers 0 .. places.size() - 1, sorted by place.
std::vector<std::uint32_t> sorted_by(const std::vector<std::uint32_t>& places) {
  std::vector<std::uint32_t> order(places.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return places[a] < places[b]; });
  return order;
}

stored_draws keep_instanced(const order_keeper& keeper, polygon_order_kind kind) {
  const std::vector<shaped_draw>& draws = keeper.draws();
  std::map<draw_unit, std::vector<std::size_t>> units;
  std::vector<std::uint32_t> places;
  for (std::uint32_t d = 0; d < draws.size(); ++d) {
    units[unit_of(*draws[d].record, d, kind)].push_back(d);
    places.push_back(keeper.place_of(d));
  }
  stored_draws out;
  std::map<draw_unit, std::uint32_t> numbers;
  for (const std::uint32_t d : sorted_by(places)) {
    const draw_unit unit = unit_of(*draws[d].record, d, kind);
    const auto [number, is_new] = numbers.try_emplace(unit, static_cast<std::uint32_t>(out.orders.size()));
    if (is_new) out.orders.push_back(shared_order(keeper, units.at(unit)));
    out.draws.push_back(*draws[d].record);
    out.order_of_draw.push_back(number->second);
  }
  return out;
}

stored_draws keep_merged(const order_keeper& keeper) {
  const std::vector<shaped_draw>& draws = keeper.draws();
  std::map<std::uint32_t, std::vector<std::size_t>> groups;
  for (std::size_t d = 0; d < draws.size(); ++d) groups[draws[d].record->group].push_back(d);
  std::vector<const std::vector<std::size_t>*> of_group;
  std::vector<std::uint32_t> places;
  for (const auto& [group, members] : groups) {
    std::uint32_t place = UINT32_MAX;
    for (const std::size_t d : members) place = std::min(place, keeper.place_of(d));
    places.push_back(place);
    of_group.push_back(&members);
  }
  stored_draws out;
  for (const std::uint32_t g : sorted_by(places)) {
    const auto number = static_cast<std::uint32_t>(out.orders.size());
    out.orders.push_back(keeper.order_of(*of_group[g]));
    for (const std::size_t d : *of_group[g]) {
      out.draws.push_back(*draws[d].record);
      out.draws.back().group = number;
      out.order_of_draw.push_back(number);
    }
  }
  return out;
}

}  // namespace

stored_draws keep_order(std::span<const format::draw_record> draws, format::host_layout layout, polygon_order_kind kind,
                        const draw_identity& identity, const earlier_order& before) {
  const bool merged = layout == format::host_layout::merged;
  const order_keeper keeper(draws, merged, identity, before);
  stored_draws out = merged ? keep_merged(keeper) : keep_instanced(keeper, kind);
  lay_end_to_end(out.draws);
  return out;
}

}  // namespace sightcell::bake
