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
#include <vector>

#include "exit_codes.h"
#include "number_text.h"
#include "pvs_file.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/scene/error.h"
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
};

struct file_difference {
  std::vector<cell_difference> cells;  // in the order of the first file
  std::uint64_t cells_before = 0, cells_after = 0;
  std::uint64_t polygons_before = 0, polygons_after = 0;  // in the sets of the cells that both have

  std::uint64_t gained() const { return sum(&cell_difference::gained); }
  std::uint64_t lost() const { return sum(&cell_difference::lost); }
  std::uint64_t changed() const {
    return static_cast<std::uint64_t>(
        std::count_if(cells.begin(), cells.end(), [](const auto& c) { return c.gained + c.lost > 0; }));
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

file_difference compare(const pvs_file& before, const pvs_file& after) {
  file_difference all;
  all.cells_before = before.content().cell_count();
  all.cells_after = after.content().cell_count();
  auto unmatched = cells_by_box(after);
  format::set_reader sets_before = before.sets(), sets_after = after.sets();
  std::vector<std::uint32_t> a, b, only;
  for (std::uint32_t cell = 0; cell < all.cells_before; ++cell) {
    const auto found = unmatched.find(key_of(before.cell_box(cell)));
    if (found == unmatched.end()) continue;
    cell_difference one{.before = cell, .after = found->second};
    unmatched.erase(found);
    before.check(sets_before.source_ids(one.before, a));
    after.check(sets_after.source_ids(one.after, b));
    all.polygons_before += a.size();
    all.polygons_after += b.size();
    only.clear();
    std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(only));
    one.lost = only.size();
    one.gained = b.size() - (a.size() - only.size());
    all.cells.push_back(one);
  }
  return all;
}

// The cells with the largest changes.
std::vector<cell_difference> most_changed(const file_difference& all) {
  std::vector<cell_difference> cells = all.cells;
  std::stable_sort(cells.begin(), cells.end(),
                   [](const auto& a, const auto& b) { return a.gained + a.lost > b.gained + b.lost; });
  while (!cells.empty() && (cells.size() > shown_cells || cells.back().gained + cells.back().lost == 0))
    cells.pop_back();
  return cells;
}

ordered_json to_json(const file_difference& all) {
  ordered_json changed = ordered_json::array();
  for (const cell_difference& c : all.cells)
    if (c.gained + c.lost > 0)
      changed.push_back({{"cell", c.before}, {"other_cell", c.after}, {"gained", c.gained}, {"lost", c.lost}});
  return {{"cells_in_both", all.cells.size()},
          {"cells_gained", all.cells_after - all.cells.size()},
          {"cells_lost", all.cells_before - all.cells.size()},
          {"cells_changed", all.changed()},
          {"polygons_before", all.polygons_before},
          {"polygons_after", all.polygons_after},
          {"polygons_gained", all.gained()},
          {"polygons_lost", all.lost()},
          {"changed", changed}};
}

void print(const file_difference& all) {
  fmt::print("cells     {} in both, {} gained, {} lost, {} with another set\n", grouped(all.cells.size()),
             grouped(all.cells_after - all.cells.size()), grouped(all.cells_before - all.cells.size()),
             grouped(all.changed()));
  fmt::print("polygons  {} -> {} in the sets of the cells in both: {} gained, {} lost\n", grouped(all.polygons_before),
             grouped(all.polygons_after), grouped(all.gained()), grouped(all.lost()));
  for (const cell_difference& c : most_changed(all))
    fmt::print("  cell {} ({}): {} gained, {} lost\n", c.before, c.after, grouped(c.gained), grouped(c.lost));
}

int run_diff(const diff_options& options) {
  const pvs_file before = pvs_file::open(options.before), after = pvs_file::open(options.after);
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
  CLI::App& verb = *program.add_subcommand("diff", "cells and polygons that one .pvs file has and another has not");
  verb.add_option("BEFORE", options->before, "a .pvs file")->type_name("A.pvs")->required();
  verb.add_option("AFTER", options->after, "another of the same scene")->type_name("B.pvs")->required();
  verb.add_flag("--json", options->json, "print one JSON object on standard output");
  verb.callback([options, &chosen] { chosen = [options] { return run_diff(*options); }; });
}

}  // namespace sightcell::cli
