#include "any_contents.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "cluster_samples.h"
#include "random_source.h"
#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/grid_boxes.h"
#include "viewpoint_samples.h"

namespace sightcell::test {

format::file_contents any_contents::contents_to_write() const {
  format::file_contents all = view();
  if (orders_left_out) all.order = {{}, {}, clusters};
  all.slack = slack_to_add;
  return all;
}

std::vector<std::byte> any_contents::write() const {
  std::vector<std::byte> bytes;
  const format::status s = format::encode(contents_to_write(), bytes);
  EXPECT_EQ(s, format::status::ok) << format::status_text(s);
  return bytes;
}

namespace {

// Random choices that are the same on every machine, unlike those of the standard library.
class choices {
 public:
  explicit choices(std::uint32_t seed) : random_(seed) {}

  std::uint32_t bits() { return random_(); }
  std::uint64_t wide() { return std::uint64_t{random_()} << 32 | random_(); }
  std::uint32_t below(std::uint32_t count) { return count == 0 ? 0 : random_() % count; }
  std::int32_t between(std::int32_t least, std::int32_t most) {
    return least + static_cast<std::int32_t>(below(static_cast<std::uint32_t>(most - least + 1)));
  }
  bool one_in(std::uint32_t count) { return below(count) == 0; }
  template <class Value>
  Value one_of(std::initializer_list<Value> values) {
    return values.begin()[below(static_cast<std::uint32_t>(values.size()))];
  }
  template <class Items>
  void shuffle(Items& items) {
    for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[below(static_cast<std::uint32_t>(i))]);
  }

 private:
  random_source random_;
};

void choose_facts(choices& choose, any_contents& out) {
  out.facts.margin = choose.one_of({0.0f, 0.125f, 0.25f, 2.5f, 1.0e6f});
  out.facts.max_pixel_error = choose.one_of({0.0f, 0.0001f, 0.5f, 1.0f});
  out.facts.confidence = choose.one_of({0.0f, 0.95f, 1.0f});
  out.facts.repeatable = !choose.one_in(4);
  out.facts.slack = choose.one_of({0.0f, 0.0f, 0.0625f, 0.1f});
  for (std::uint8_t& byte : out.facts.scene_fingerprint) byte = static_cast<std::uint8_t>(choose.bits());
  out.slack_to_add = choose.one_of({0.0, 0.0, 0.0, 0.05, 0.1, 0.5});
  if (choose.one_in(3)) return;
  out.settings = "{\"note\":\"";
  for (std::uint32_t left = choose.below(100); left > 0; --left) out.settings += choose.one_of({"a", " ", "\xC3\xA9"});
  out.settings += "\"}";
}

// The draws in source order: instances of a few meshes, some without polygons.
void choose_draws(choices& choose, any_contents& out) {
  std::vector<std::uint32_t> meshes(1 + choose.below(5));
  for (std::uint32_t& polygons : meshes) {
    polygons = choose.one_in(5) ? 0 : 1 + choose.below(choose.one_of({3u, 40u, 40u, 250u}));
  }
  const std::uint32_t draws = choose.one_in(25) ? 0 : 1 + choose.below(choose.one_of({1u, 4u, 14u}));
  std::uint32_t vertices = 0;
  for (std::uint32_t i = 0; i < draws; ++i) {
    const std::uint32_t mesh = choose.below(static_cast<std::uint32_t>(meshes.size()));
    format::draw_record d;
    d.node = choose.one_in(9) ? choose.bits() : i;
    d.mesh = mesh;
    d.primitive = choose.below(3);
    d.instance = choose.one_in(4) ? choose.below(1000) : 0;
    d.material = choose.one_in(4) ? 0xFFFFFFFFu : choose.below(4);
    d.first_source = out.facts.polygon_count;
    d.polygon_count = meshes[mesh];
    d.base_vertex = vertices;
    d.host_tag = choose.one_in(3) ? choose.wide() : 0;
    d.flags = choose.one_in(6) ? format::draw_moves : 0;
    out.facts.polygon_count += d.polygon_count;
    vertices += 3 * d.polygon_count;
    out.draws.push_back(d);
  }
}

// Each draw begins where the one before it ends.
void lay_out(any_contents& out) {
  std::uint32_t next = 0;
  for (format::draw_record& d : out.draws) {
    d.first_stored = next;
    next += d.polygon_count;
  }
}

// Near the source order, far from it, or any order.
std::vector<std::uint32_t> choose_order(choices& choose, std::uint32_t polygons) {
  std::vector<std::uint32_t> order(polygons);
  std::iota(order.begin(), order.end(), 0u);
  if (choose.one_in(4)) std::reverse(order.begin(), order.end());
  if (choose.one_in(2)) {
    choose.shuffle(order);
  } else {
    for (std::uint32_t swaps = choose.below(6); swaps > 0 && polygons > 1; --swaps) {
      const std::uint32_t at = choose.below(polygons - 1);
      std::swap(order[at], order[at + 1]);
    }
  }
  return order;
}

// Draws of a mesh share an order, or none do, or some of equal length.
void order_draws(choices& choose, any_contents& out) {
  enum class sharing { per_mesh, per_draw, free };
  const sharing how = choose.one_of({sharing::per_mesh, sharing::per_draw, sharing::free});
  if (!choose.one_in(3)) choose.shuffle(out.draws);
  std::map<std::uint32_t, std::uint32_t> order_of_mesh;
  for (const format::draw_record& d : out.draws) {
    const auto next = static_cast<std::uint32_t>(out.orders.size());
    std::uint32_t number = next;
    if (how == sharing::per_mesh) number = order_of_mesh.try_emplace(d.mesh, next).first->second;
    if (how == sharing::free) {
      const std::uint32_t other = choose.below(next);
      if (next > 0 && out.orders[other].size() == d.polygon_count) number = other;
    }
    if (number == next) out.orders.push_back(choose_order(choose, d.polygon_count));
    out.order_of_draw.push_back(number);
  }
}

// Groups of one material each, and each draw that moves in a group of its own; some groups may have the same material.
void order_groups(choices& choose, any_contents& out) {
  std::vector<std::vector<format::draw_record>> groups(1 + choose.below(4));
  const auto fixed = static_cast<std::uint32_t>(groups.size());
  for (format::draw_record& d : out.draws) {
    if (d.flags != 0) {
      groups.push_back({d});
      continue;
    }
    std::vector<format::draw_record>& group = groups[choose.below(fixed)];
    if (!group.empty()) d.material = group.front().material;
    group.push_back(d);
  }
  std::erase_if(groups, [](const auto& group) { return group.empty(); });
  choose.shuffle(groups);
  out.draws.clear();
  for (std::uint32_t number = 0; number < groups.size(); ++number) {
    std::uint32_t polygons = 0;
    for (format::draw_record& d : groups[number]) {
      d.group = number;
      polygons += d.polygon_count;
      out.draws.push_back(d);
      out.order_of_draw.push_back(number);
    }
    out.orders.push_back(choose_order(choose, polygons));
  }
}

// A name may have any bytes. All draws of a draw group are in the same named group.
void choose_named_groups(choices& choose, any_contents& out) {
  const std::uint32_t count = 1 + choose.below(choose.one_of({1u, 5u, 300u}));
  for (std::uint32_t i = 0; i < count; ++i) {
    std::string name = std::to_string(i);
    for (std::uint32_t more = choose.below(9); more > 0; --more) name += static_cast<char>(choose.bits());
    out.named_groups.push_back(std::move(name));
  }
  const bool merged = out.facts.layout == format::host_layout::merged;
  for (std::size_t i = 0; i < out.draws.size(); ++i) {
    format::draw_record& d = out.draws[i];
    if (merged && i > 0 && d.group == out.draws[i - 1].group)
      d.named_group = out.draws[i - 1].named_group;
    else
      d.named_group = choose.one_in(3) ? format::no_named_group : choose.below(count);
  }
}

// Without orders, each draw or draw group has its source order.
void leave_orders_out(any_contents& out) {
  out.orders_left_out = true;
  if (out.facts.layout == format::host_layout::instanced) {
    std::iota(out.order_of_draw.begin(), out.order_of_draw.end(), 0u);
    out.orders.clear();
    for (const format::draw_record& d : out.draws) out.orders.emplace_back(d.polygon_count);
  }
  for (auto& order : out.orders) std::iota(order.begin(), order.end(), 0u);
}

void work_out_stored(any_contents& out) {
  const bool merged = out.facts.layout == format::host_layout::merged;
  for (std::size_t first = 0; first < out.draws.size();) {
    std::size_t behind = first + 1;
    while (merged && behind < out.draws.size() && out.draws[behind].group == out.draws[first].group) ++behind;
    std::vector<std::uint32_t> sources;
    for (std::size_t d = first; d < behind; ++d) {
      for (std::uint32_t i = 0; i < out.draws[d].polygon_count; ++i) sources.push_back(out.draws[d].first_source + i);
    }
    out.unit_begins.push_back(static_cast<std::uint32_t>(out.source_of_stored.size()));
    for (const std::uint32_t place : out.orders[out.order_of_draw[first]]) {
      out.source_of_stored.push_back(sources.at(place));
    }
    first = behind;
  }
  out.unit_begins.push_back(static_cast<std::uint32_t>(out.source_of_stored.size()));
}

format::box choose_box(choices& choose) {
  format::box b;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    b.min[axis] = 0.5f * static_cast<float>(choose.between(-20, 20));
    b.max[axis] = b.min[axis] + 0.5f * static_cast<float>(choose.between(1, 8));
  }
  return b;
}

format::box grid_box(std::uint32_t number) {
  const auto x = static_cast<float>(number % 8);
  const auto y = static_cast<float>(number / 64);
  const auto z = static_cast<float>(number / 8 % 8);
  return {{x, y, z}, {x + 1, y + 1, z + 1}};
}

// A grid; arbitrary boxes; or a grid that contains boxes of another size. Some occur twice.
void choose_boxes(choices& choose, std::uint32_t cells, any_contents& out) {
  const std::uint32_t free_in = choose.one_of({1u, 4u, 1000u});
  for (std::uint32_t i = 0; i < cells; ++i) {
    const bool again = i > 0 && choose.one_in(30);
    const format::box b = again                    ? out.cells[choose.below(i)]
                          : choose.one_in(free_in) ? choose_box(choose)
                                                   : grid_box(i);
    out.cells.push_back(b);
  }
}

// Around the origin or far away, on one level or on several that overlap.
void choose_lattice(choices& choose, std::uint32_t cells, any_contents& out) {
  out.lattice = format::lattice_shape{choose.one_of({4.0, 0.75, 1.0 / 3.0}), choose.one_of({2.0, 1.5, 0.7})};
  const std::uint32_t levels = choose.one_of({1u, 2u, 4u});
  const std::int32_t middle = choose.one_of({0, 0, 5, -100000, 1 << 20});
  std::set<std::tuple<std::uint32_t, std::int32_t, std::int32_t, std::int32_t>> taken;
  while (out.places.size() < cells) {
    const format::lattice_place place{middle + choose.between(-9, 9), choose.between(-2, 2), choose.between(-9, 9),
                                      choose.below(levels)};
    if (taken.emplace(place.level, place.x, place.y, place.z).second) out.places.push_back(place);
  }
  std::sort(out.places.begin(), out.places.end(), format::lattice_comes_before);
  for (const format::lattice_place& place : out.places) out.cells.push_back(format::box_of(*out.lattice, place));
}

// Around the origin or far away, of a few steps or many. Some occur twice.
void choose_grid(choices& choose, std::uint32_t cells, any_contents& out) {
  out.grid = format::lattice_shape{choose.one_of({4.0, 0.75, 1.0 / 3.0}), choose.one_of({0.5, 0.09375, 0.7})};
  const std::uint32_t most_steps = choose.one_of({1u, 8u, 1000u});
  const std::int32_t middle = choose.one_of({0, 0, 5, -100000, 1 << 20});
  const auto steps = [&] { return 1 + choose.below(most_steps); };
  while (out.grid_places.size() < cells) {
    const auto at = [&] { return choose.between(-9, 9); };
    format::grid_box place{middle + at(), at(), at(), steps(), steps(), steps()};
    if (!out.grid_places.empty() && choose.one_in(30)) place = out.grid_places.back();
    out.grid_places.push_back(place);
    out.cells.push_back(format::box_of(*out.grid, place));
  }
}

void choose_certificate(choices& choose, any_contents& out) {
  for (std::uint32_t cell = 0; cell < out.cells.size(); ++cell) {
    const std::uint64_t rays = choose.one_of<std::uint64_t>({0, choose.below(100000), choose.wide()});
    const std::uint64_t misses = choose.one_in(5) ? rays : std::min<std::uint64_t>(rays, choose.below(4));
    // Floats, since a file has no other values here.
    const double bound = static_cast<double>(choose.one_of({0.0f, 0.001f, 1.0f}));
    const double confidence = static_cast<double>(choose.one_of({0.0f, 0.95f, 1.0f}));
    out.certificate.push_back({cell, rays, misses, bound, confidence, choose.one_in(2) ? choose.wide() : cell});
  }
}

using members = std::vector<bool>;

void fill(choices& choose, std::uint32_t runs, std::uint32_t longest, bool value, members& set) {
  const auto polygons = static_cast<std::uint32_t>(set.size());
  for (; runs > 0; --runs) {
    const std::uint32_t first = choose.below(polygons);
    std::fill_n(set.begin() + first, std::min(polygons - first, 1 + choose.below(longest)), value);
  }
}

members like(choices& choose, members set) {
  fill(choose, choose.below(3), 6, true, set);
  fill(choose, choose.below(3), 6, false, set);
  return set;
}

members choose_set(choices& choose, std::uint32_t polygons, std::uint32_t strange_in,
                   const std::vector<members>& sets) {
  members set(polygons, false);
  const auto others = static_cast<std::uint32_t>(sets.size());
  if (choose.one_in(strange_in)) {
    const std::uint32_t kind = choose.below(3);  // 0: empty
    if (kind == 1) set.assign(polygons, true);
    if (kind == 2 && polygons > 0) set[choose.below(polygons)] = true;
    return set;
  }
  if (others == 0 || choose.one_in(20)) {
    const std::uint32_t runs = 1 + polygons / choose.one_of({5u, 12u, 60u});
    fill(choose, runs, choose.one_of({2u, 12u}), true, set);
    return set;
  }
  const members& near = sets[others - 1 - choose.below(std::min(others, 8u))];
  return choose.one_in(6) ? near : like(choose, near);
}

// Sets that resemble each other, so that rows are differences to rows that are differences too. Runs are of stored
// polygons or in source order.
void choose_sets(choices& choose, any_contents& out) {
  const std::uint32_t polygons = out.facts.polygon_count;
  const std::uint32_t strange_in = choose.one_of({2u, 8u, 30u, 1000u});
  const bool by_source = choose.one_in(3);
  std::vector<members> sets;
  for (std::size_t cell = 0; cell < out.cells.size(); ++cell) {
    sets.push_back(choose_set(choose, polygons, strange_in, sets));
    std::vector<std::uint32_t>& ids = out.sets.emplace_back();
    for (std::uint32_t i = 0; i < polygons; ++i) {
      if (sets.back()[i]) ids.push_back(by_source ? i : out.source_of_stored[i]);
    }
    std::sort(ids.begin(), ids.end());
  }
}

// Around the origin or far away; in sets like polygons.
void choose_volumes(choices& choose, any_contents& out) {
  out.volume_shape = {choose.one_of({4.0, 0.75, 1.0 / 3.0}), choose.one_of({2.0, 1.5, 0.7})};
  const std::int32_t middle = choose.one_of({0, 0, 5, -100000, 1 << 20});
  const std::uint32_t count = choose.one_of({1u, 2u, 30u, 64u, 200u});
  std::set<std::tuple<std::int32_t, std::int32_t, std::int32_t>> taken;
  while (out.volumes.size() < count) {
    const format::lattice_place place{middle + choose.between(-9, 9), choose.between(-2, 2), choose.between(-9, 9), 0};
    if (taken.emplace(place.x, place.y, place.z).second) out.volumes.push_back(place);
  }
  const std::uint32_t strange_in = choose.one_of({2u, 8u, 30u, 1000u});
  std::vector<members> sets;
  for (std::vector<std::uint32_t>& ids : out.sets) {
    sets.push_back(choose_set(choose, count, strange_in, sets));
    for (std::uint32_t volume = 0; volume < count; ++volume) {
      if (sets.back()[volume]) ids.push_back(out.facts.polygon_count + volume);
    }
  }
}

}  // namespace

any_contents make_any_contents(std::uint32_t seed) {
  choices choose(seed);
  any_contents out;
  if (seed % 3 == 0) out.chunk_bytes = 20 + 7 * (seed % 50);
  choose_facts(choose, out);
  choose_draws(choose, out);
  if (choose.one_in(2)) {
    out.facts.layout = format::host_layout::merged;
    order_groups(choose, out);
  } else {
    order_draws(choose, out);
  }
  lay_out(out);
  if (choose.one_in(3)) choose_named_groups(choose, out);
  if (choose.one_in(5)) leave_orders_out(out);
  work_out_stored(out);
  const std::uint32_t cells = choose.one_of({0u, 1u, 2u, 5u, 30u, 63u, 64u, 65u, 130u, 200u});
  switch (choose.below(3)) {
    case 0:
      choose_boxes(choose, cells, out);
      break;
    case 1:
      choose_lattice(choose, cells, out);
      break;
    default:
      choose_grid(choose, cells, out);
      break;
  }
  if (!choose.one_in(3)) choose_certificate(choose, out);
  choose_sets(choose, out);
  if (choose.one_in(3)) choose_volumes(choose, out);
  if (choose.one_in(3)) add_viewpoints(out, choose.bits());
  if (seed % 4 == 1) put_in_clusters(out, seed, choose.one_of({1u, 4u, 30u, 256u}));
  return out;
}

}  // namespace sightcell::test
