// sightcell diff A.pvs B.pvs
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "exit_codes.h"
#include "help.h"
#include "number_text.h"
#include "pvs_file.h"
#include "sightcell/base/error.h"
#include "sightcell/format/set_reader.h"
#include "verbs.h"

namespace sightcell::cli {

namespace {

using nlohmann::ordered_json;

constexpr std::size_t shown_cells = 10;

struct diff_options {
  std::filesystem::path before, after;
  bool json = false;
};

// A cell that both files have.
struct cell_difference {
  std::uint32_t before = 0, after = 0;  // its numbers
  std::uint64_t gained = 0, lost = 0;   // polygons that only the second, only the first has
  std::uint64_t volumes_gained = 0, volumes_lost = 0;

  std::uint64_t all() const { return gained + lost + volumes_gained + volumes_lost; }
};

struct file_difference {
  std::vector<cell_difference> cells;  // in the order of the first file
  std::uint64_t cells_before = 0, cells_after = 0;
  std::uint64_t polygons_before = 0, polygons_after = 0;  // in the sets of the cells that both have
  bool with_volumes = false;                              // both have some, and of the same size
  std::uint64_t volumes_before = 0, volumes_after = 0;    // in these sets then

  std::uint64_t gained() const { return sum(&cell_difference::gained); }
  std::uint64_t lost() const { return sum(&cell_difference::lost); }
  std::uint64_t volumes_gained() const { return sum(&cell_difference::volumes_gained); }
  std::uint64_t volumes_lost() const { return sum(&cell_difference::volumes_lost); }
  std::uint64_t changed() const {
    return static_cast<std::uint64_t>(
        std::count_if(cells.begin(), cells.end(), [](const auto& c) { return c.all() > 0; }));
  }

 private:
  std::uint64_t sum(std::uint64_t cell_difference::*member) const {
    std::uint64_t total = 0;
    for (const cell_difference& c : cells) total += c.*member;
    return total;
  }
};

using box_key = std::array<float, 6>;

box_key key_of(const format::box& b) {
  return {b.min[0], b.min[1], b.min[2], b.max[0], b.max[1], b.max[2]};
}

// Explicit boxes may be there twice: their numbers are matched in turn.
std::multimap<box_key, std::uint32_t> cells_by_box(const pvs_file& file) {
  std::multimap<box_key, std::uint32_t> cells;
  for (std::uint32_t cell = 0; cell < file.content().cell_count(); ++cell)
    cells.emplace(key_of(file.cell_box(cell)), cell);
  return cells;
}

using volume_place = std::array<std::int32_t, 3>;

// By number, in a file; files may have their volumes in other orders.
std::vector<volume_place> places_of_volumes(const pvs_file& file) {
  std::vector<volume_place> places;
  const format::volume_table& volumes = file.content().volumes();
  for (std::uint32_t volume = 0; volume < volumes.count(); ++volume) {
    format::lattice_place at;
    file.check(volumes.place(volume, at) ? format::status::ok : format::status::corrupt);
    places.push_back({at.x, at.y, at.z});
  }
  return places;
}

bool have_like_volumes(const format::volume_table& a, const format::volume_table& b) {
  return a.count() > 0 && b.count() > 0 && a.shape().width == b.shape().width && a.shape().height == b.shape().height;
}

std::vector<volume_place> seen_volumes(std::span<const format::run> runs, std::span<const volume_place> places) {
  std::vector<volume_place> seen;
  for (const format::run& r : runs)
    for (std::uint32_t i = 0; i < r.count; ++i) seen.push_back(places[r.first + i]);
  std::sort(seen.begin(), seen.end());
  return seen;
}

// How many of a are not in b; both ascending.
template <class Item>
std::uint64_t count_only(const std::vector<Item>& a, const std::vector<Item>& b) {
  std::vector<Item> only;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(only));
  return only.size();
}

file_difference compare(const pvs_file& before, const pvs_file& after) {
  file_difference all;
  all.cells_before = before.content().cell_count();
  all.cells_after = after.content().cell_count();
  auto unmatched = cells_by_box(after);
  format::set_reader sets_before = before.sets(), sets_after = after.sets();
  all.with_volumes = have_like_volumes(before.content().volumes(), after.content().volumes());
  std::vector<volume_place> places_before, places_after;
  if (all.with_volumes) places_before = places_of_volumes(before), places_after = places_of_volumes(after);
  std::vector<std::uint32_t> a, b;
  for (std::uint32_t cell = 0; cell < all.cells_before; ++cell) {
    const auto found = unmatched.find(key_of(before.cell_box(cell)));
    if (found == unmatched.end()) continue;
    cell_difference one{.before = cell, .after = found->second};
    unmatched.erase(found);
    before.check(sets_before.source_ids(one.before, a));
    after.check(sets_after.source_ids(one.after, b));
    all.polygons_before += a.size();
    all.polygons_after += b.size();
    one.lost = count_only(a, b);
    one.gained = b.size() - (a.size() - one.lost);
    if (all.with_volumes) {
      format::row_parts x, y;
      before.check(sets_before.parts(one.before, x));
      after.check(sets_after.parts(one.after, y));
      const auto seen_before = seen_volumes(x.volumes, places_before),
                 seen_after = seen_volumes(y.volumes, places_after);
      all.volumes_before += seen_before.size();
      all.volumes_after += seen_after.size();
      one.volumes_lost = count_only(seen_before, seen_after);
      one.volumes_gained = count_only(seen_after, seen_before);
    }
    all.cells.push_back(one);
  }
  return all;
}

// The cells with the largest changes.
std::vector<cell_difference> most_changed(const file_difference& all) {
  std::vector<cell_difference> cells = all.cells;
  std::stable_sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) { return a.all() > b.all(); });
  while (!cells.empty() && (cells.size() > shown_cells || cells.back().all() == 0)) cells.pop_back();
  return cells;
}

ordered_json to_json(const file_difference& all) {
  ordered_json changed = ordered_json::array();
  for (const cell_difference& c : all.cells) {
    if (c.all() == 0) continue;
    ordered_json one = {{"cell", c.before}, {"other_cell", c.after}, {"gained", c.gained}, {"lost", c.lost}};
    if (all.with_volumes) one["volumes_gained"] = c.volumes_gained, one["volumes_lost"] = c.volumes_lost;
    changed.push_back(std::move(one));
  }
  const auto of_volumes = [&](std::uint64_t count) { return all.with_volumes ? ordered_json(count) : nullptr; };
  return {{"cells_in_both", all.cells.size()},
          {"cells_gained", all.cells_after - all.cells.size()},
          {"cells_lost", all.cells_before - all.cells.size()},
          {"cells_changed", all.changed()},
          {"polygons_before", all.polygons_before},
          {"polygons_after", all.polygons_after},
          {"polygons_gained", all.gained()},
          {"polygons_lost", all.lost()},
          {"volumes_before", of_volumes(all.volumes_before)},
          {"volumes_after", of_volumes(all.volumes_after)},
          {"volumes_gained", of_volumes(all.volumes_gained())},
          {"volumes_lost", of_volumes(all.volumes_lost())},
          {"changed", changed}};
}

void print(const file_difference& all) {
  fmt::print("cells     {} in both, {} gained, {} lost, {} with another set\n", grouped(all.cells.size()),
             grouped(all.cells_after - all.cells.size()), grouped(all.cells_before - all.cells.size()),
             grouped(all.changed()));
  fmt::print("polygons  {} -> {} in the sets of the cells in both: {} gained, {} lost\n", grouped(all.polygons_before),
             grouped(all.polygons_after), grouped(all.gained()), grouped(all.lost()));
  if (all.with_volumes)
    fmt::print("volumes   {} -> {} in these sets: {} gained, {} lost\n", grouped(all.volumes_before),
               grouped(all.volumes_after), grouped(all.volumes_gained()), grouped(all.volumes_lost()));
  for (const cell_difference& c : most_changed(all))
    fmt::print("  cell {} ({}): {} gained, {} lost\n", c.before, c.after, grouped(c.gained), grouped(c.lost));
}

int run_diff(const diff_options& options) {
  const pvs_file before = pvs_file::open_or_embedded(options.before), after = pvs_file::open_or_embedded(options.after);
  if (before.content().facts().scene_fingerprint != after.content().facts().scene_fingerprint)
    throw error(error_kind::bad_input, "diff.other-scene", options.after.string(),
                "was baked from another scene than " + options.before.string(),
                "compare files of one scene: polygons have other numbers in another");
  const file_difference all = compare(before, after);
  if (options.json)
    fmt::print("{}\n", to_json(all).dump(2));
  else
    print(all);
  return exit_done;
}

}  // namespace

void add_diff_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<diff_options>();
  CLI::App& verb = add_verb(program, "diff",
                            {.summary = "Compares the cell sets of two .pvs files of one scene",
                             .usage = "BEFORE.pvs AFTER.pvs [options]",
                             .description = "Counts the cells, polygons and visibility volumes that were gained and "
                                            "lost, and lists the cells that changed most.",
                             .examples = {"sightcell diff old.pvs new.pvs"}});
  verb.add_option("BEFORE", options->before, "A .pvs file, or a scene that contains one (bake --embed).")->required();
  verb.add_option("AFTER", options->after, "Another one, of the same scene.")->required();
  verb.add_flag("--json", options->json, "Prints the result as one JSON object on standard output.");
  verb.callback([options, &chosen] { chosen = [options] { return run_diff(*options); }; });
}

}  // namespace sightcell::cli
