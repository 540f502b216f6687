#include "report/suggestions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "number_text.h"
#include "report/html.h"

namespace sightcell::cli {
namespace {

using nlohmann::ordered_json;

constexpr float touching_distance = 0.3f;  // meters between boxes of connected cells
constexpr float least_rise = 2.0f;         // meters above other cells, from which on a part may be a roof
constexpr float beside_distance = 8.0f;    // meters from these cells in plan
constexpr double much_unseen = 0.1;        // share of the polygons
constexpr double much_visible = 50.0;      // percent of the polygons in the mean set
constexpr double much_slower = 20.0;       // the slowest cell over the median
constexpr double slow_share = 0.1;         // of the time of all cells

const ordered_json& settings_in(const report_data& data) {
  static const ordered_json none = ordered_json::object();
  const auto found = data.info.find("settings");
  return found != data.info.end() && found->is_object() ? *found : none;
}

std::string text_at(const ordered_json& object, const char* key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::string bake_command(const report_data& data, const std::string& options) {
  return fmt::format("sightcell bake {} -o {} {}", shell_word(data.scene_path), shell_word(data.file_path), options);
}

bool is_trial(const report_data& data) {
  return number_at(settings_in(data), "cell_limit") > 0.0;
}

void add_missed_bounds(const report_data& data, std::vector<suggestion>& out) {
  const ordered_json& settings = settings_in(data);
  const double asked = number_at(settings, "max_pixel_error");
  if (!(asked > 0.0)) return;
  const auto over = std::count_if(data.cells.begin(), data.cells.end(),
                                  [&](const report_cell& c) { return !c.bounded() || c.bound > asked; });
  if (over == 0) return;
  const double budget = number_at(settings, "time_budget"), limit = number_at(settings, "seconds_per_cell"),
               samples = number_at(settings, "samples");
  std::string remedy = "take more hemicubes in the first round", option;
  if (budget > 0.0)
    remedy = "give the bake more time", option = fmt::format("--time-budget {:g}", 2.0 * budget);
  else if (limit > 0.0)
    remedy = "give each cell more time", option = fmt::format("--seconds-per-cell {:g}", 2.0 * limit);
  else if (samples > 0.0)
    option = fmt::format("--samples {:g}", 2.0 * samples);
  out.push_back({fmt::format("{} of {} cells missed their bound", grouped(static_cast<std::uint64_t>(over)),
                             grouped(data.cells.size())),
                 fmt::format("Their bound is above the requested {}. Bake again and {}, with the other options of the "
                             "bake as before.",
                             probability_text(asked), remedy),
                 option.empty() ? std::string() : bake_command(data, option)});
}

void add_misses(const report_data& data, std::vector<suggestion>& out) {
  const double bound = number_at(data.verify, "upper_bound"), asked = number_at(data.verify, "max_pixel_error");
  if (!(bound > asked)) return;
  out.push_back({fmt::format("Verification did not confirm the bound {}", probability_text(asked)),
                 fmt::format("Its own bound over all cells is {}. If it had many misses, the sets lack polygons: bake "
                             "with a smaller bound. If it had few, cast more rays.",
                             probability_text(bound)),
                 bake_command(data, "--quality final")});
}

void add_raised_cells(const report_data& data, std::vector<suggestion>& out) {
  if (data.raised.cells == 0 || is_trial(data) || text_at(settings_in(data), "cells") != "automatic") return;
  const auto& at = data.raised.start;
  out.push_back(
      {fmt::format("{} cells are on roofs or other places out of reach", grouped(data.raised.cells)),
       "No path of cells leads up to them, and they are under the open sky. If no player comes there, name the points "
       "where players begin: then only what can be reached from there has cells.",
       bake_command(data, fmt::format("--start={:.1f},{:.1f},{:.1f}", at[0], at[1], at[2]))});
}

void add_trial(const report_data& data, std::vector<suggestion>& out) {
  if (!is_trial(data)) return;
  out.push_back({fmt::format("This is a trial of {} cells", grouped(data.cells.size())),
                 "Bake without --cell-limit for a release. Outside its cells, the runtime draws everything. Bits per "
                 "visible polygon and unseen polygons of a trial are not those of the whole bake.",
                 {}});
}

void add_unseen(const report_data& data, std::vector<suggestion>& out) {
  if (!data.unseen || data.unseen->polygons == 0 || is_trial(data)) return;
  const double share = static_cast<double>(data.unseen->unseen) / data.unseen->polygons;
  if (share < much_unseen) return;
  out.push_back(
      {fmt::format("{} of all polygons are visible from no cell", percent_text(100.0 * share)),
       "strip writes the scene without them. Shadows, mirrors and collision may need them, so keep the "
       "original.",
       fmt::format("sightcell strip {} {} -o stripped.glb", shell_word(data.scene_path), shell_word(data.file_path))});
}

void add_large_sets(const report_data& data, std::vector<suggestion>& out) {
  const double percent = number_at(data.info, "visible_set_percent"), width = number_at(settings_in(data), "cell_size");
  if (!(percent > much_visible) || data.cells.size() < 2) return;
  out.push_back({fmt::format("Cells contain {} of all polygons in the mean", percent_text(percent)),
                 "Culling saves little here. Smaller cells have smaller sets. Walls that do not occlude (BLEND "
                 "materials, single-sided backs, gaps) make sets large.",
                 text_at(settings_in(data), "cells") == "automatic" && width > 0.0
                     ? bake_command(data, fmt::format("--cell-size {:g} --merge-cells 0", 0.5 * width))
                     : std::string()});
}

void add_slow_cell(const report_data& data, std::vector<suggestion>& out) {
  const auto found = data.bake.is_object() ? data.bake.find("cell_seconds") : data.bake.end();
  if (!data.bake.is_object() || found == data.bake.end()) return;
  const double median = number_at(*found, "median"), longest = number_at(*found, "longest"),
               all = number_at(data.bake, "cpu_seconds");
  if (!(median > 0.0) || !(longest > much_slower * median) || !(longest > slow_share * all)) return;
  out.push_back({fmt::format("One cell took {}, the median cell {}", seconds_text(longest), seconds_text(median)),
                 "A limit keeps one cell from holding up the bake. A cell that reaches it has the bound that it came "
                 "to.",
                 bake_command(data, fmt::format("--seconds-per-cell {:.0f}", std::ceil(5.0 * median)))});
}

void add_smaller_file(const report_data& data, std::vector<suggestion>& out) {
  if (text_at(settings_in(data), "profile") != "exact") return;
  out.push_back({"The file has no slack",
                 "With slack up to 10 %, a file is a third smaller in the median. Pictures stay the same.",
                 fmt::format("sightcell recode {} --profile small -o small.pvs", shell_word(data.file_path))});
}

// Sets of cells that are connected.
class connected_cells {
 public:
  explicit connected_cells(std::size_t cells) : parent_(cells) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t root(std::uint32_t cell) {
    while (parent_[cell] != cell) cell = parent_[cell] = parent_[parent_[cell]];
    return cell;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[std::max(root(a), root(b))] = std::min(root(a), root(b)); }

 private:
  std::vector<std::uint32_t> parent_;
};

bool is_within(const report_cell& a, const report_cell& b, std::size_t axis, float distance) {
  return a.min[axis] <= b.max[axis] + distance && b.min[axis] <= a.max[axis] + distance;
}

// Calls take for each pair of cells that are within a distance of each other in plan.
template <typename Take>
void for_pairs_in_plan(const std::vector<report_cell>& cells, float distance, const Take& take) {
  std::vector<std::uint32_t> order(cells.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return cells[a].min[0] < cells[b].min[0]; });
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size() && cells[order[j]].min[0] <= cells[order[i]].max[0] + distance; ++j)
      if (is_within(cells[order[i]], cells[order[j]], 2, distance)) take(order[i], order[j]);
}

}  // namespace

double number_at(const ordered_json& object, const char* key) {
  if (!object.is_object()) return std::nan("");
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : std::nan("");
}

std::string shell_word(const std::string& word) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("_-./=,:+@%").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string out = "'";
  for (const char c : word) {
    if (c == '\'')
      out += "'\\''";
    else
      out += c;
  }
  return out + "'";
}

raised_cells find_raised_cells(const std::vector<report_cell>& cells, std::span<const bake::cell_view> views) {
  connected_cells parts(cells.size());
  for_pairs_in_plan(cells, touching_distance, [&](std::uint32_t a, std::uint32_t b) {
    if (is_within(cells[a], cells[b], 1, touching_distance)) parts.join(a, b);
  });
  std::vector<std::uint32_t> sizes(cells.size(), 0);
  for (std::uint32_t cell = 0; cell < cells.size(); ++cell) ++sizes[parts.root(cell)];
  raised_cells found;
  if (cells.empty()) return found;
  const auto largest = static_cast<std::uint32_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  std::vector<bool> is_raised(cells.size(), false);  // by the root of a part
  for_pairs_in_plan(cells, beside_distance, [&](std::uint32_t a, std::uint32_t b) {
    for (const auto& [high, low] : {std::pair(a, b), std::pair(b, a)})
      if (parts.root(low) == largest && parts.root(high) != largest &&
          cells[high].min[1] >= cells[low].min[1] + least_rise)
        is_raised[parts.root(high)] = true;
  });
  bool started = false;
  for (const bake::cell_view& view : views) {
    const std::uint32_t part = parts.root(view.cell);
    if (is_raised[part] && std::isinf(view.above)) ++found.cells;
    if (part == largest && !started) found.start = view.eye;
    started = started || part == largest;
  }
  if (!started) found.cells = 0;  // there is no start to propose
  return found;
}

std::vector<suggestion> suggestions_of(const report_data& data) {
  std::vector<suggestion> all;
  for (const auto add : {add_missed_bounds, add_misses, add_trial, add_raised_cells, add_unseen, add_large_sets,
                         add_slow_cell, add_smaller_file})
    add(data, all);
  if (all.size() > most_suggestions) all.resize(most_suggestions);
  return all;
}

}  // namespace sightcell::cli
