#include "sightcell/bake/unseen.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bound/clopper_pearson.h"
#include "cells/overrides.h"
#include "file/caster_sets.h"
#include "file/light_sets.h"
#include "file/readable_file.h"
#include "sightcell/bake/settings.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {
namespace {

// Returns which polygons are in some set, by source id.
std::vector<bool> in_some_set(const format::reader& file, const std::string& name) {
  format::set_reader sets;
  require_readable(sets.open(file), name);
  for (std::uint32_t chunk = 0; chunk < file.chunk_count(); ++chunk) require_readable(file.check_chunk(chunk), name);
  // The number of runs that begin at each stored polygon, less those that end before it.
  std::vector<std::int64_t> border(std::size_t{file.polygon_count()} + 1, 0);
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    std::span<const format::run> runs;
    require_readable(sets.runs(cell, runs), name);
    for (const format::run& r : runs) ++border[r.first], --border[std::size_t{r.first} + r.count];
  }
  std::vector<bool> out(file.polygon_count(), false);
  std::int64_t open = 0;
  for (std::uint32_t stored = 0; stored < file.polygon_count(); ++stored) {
    open += border[stored];
    out[sets.source_of_stored()[stored]] = open > 0;
  }
  return out;
}

// Returns which polygons cast a shadow on what a cell sees, or are reached by a light, by source id.
std::vector<bool> in_shadow_maps(const format::reader& file, const std::string& name) {
  std::vector<bool> out(file.polygon_count(), false);
  std::vector<std::uint32_t> set;
  const auto add = [&](format::status outcome) {
    require_readable(outcome, name);
    for (const std::uint32_t polygon : set) out[polygon] = true;
  };
  caster_set_reader casters;
  if (const format::status s = casters.open(file); s != format::status::absent) {
    require_readable(s, name);
    for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell)
      for (std::uint32_t sun = 0; sun < casters.table().sun_count(); ++sun) add(casters.source_ids(cell, sun, set));
  }
  light_set_reader lights;
  if (const format::status s = lights.open(file); s != format::status::absent) {
    require_readable(s, name);
    for (std::uint32_t light = 0; light < lights.table().light_count(); ++light) add(lights.source_ids(light, set));
  }
  return out;
}

// Returns the polygons about which the sets state nothing, by source id. Animated draws without a mark are among them,
// whatever --animated was: in another pose other polygons are visible.
std::vector<bool> exempt_polygons(const scene::scene& s, std::string_view settings) {
  std::vector<bool> out(s.polygon_count, false);
  const auto add = [&](std::uint32_t first, std::uint32_t count) {
    const auto begin = out.begin() + static_cast<std::ptrdiff_t>(first);
    std::fill(begin, begin + static_cast<std::ptrdiff_t>(count), true);
  };
  for (const scene::draw& d : s.draws)
    if (d.moves || d.tags.dynamic || d.tags.always || d.tags.never) add(d.first_source, d.polygon_count);
  const overrides given = stored_overrides(settings, s.polygon_count);
  for (const overrides::ranges* ranges : {&given.always, &given.never})
    for (const scene::polygon_range& r : *ranges) add(r.first, r.count);
  return out;
}

std::vector<unseen_object> objects_of(const scene::scene& s, const std::vector<bool>& is_unseen) {
  std::vector<unseen_object> objects;
  for (const scene::draw& d : s.draws) {
    if (objects.empty() || objects.back().node != d.node) {
      objects.emplace_back().node = d.node;
      if (d.node < s.node_names.size()) objects.back().name = s.node_names[d.node];
    }
    unseen_object& object = objects.back();
    object.polygons += d.polygon_count;
    const auto begin = is_unseen.begin() + static_cast<std::ptrdiff_t>(d.first_source);
    object.unseen +=
        static_cast<std::uint32_t>(std::count(begin, begin + static_cast<std::ptrdiff_t>(d.polygon_count), true));
  }
  std::stable_sort(objects.begin(), objects.end(), [](const auto& a, const auto& b) { return a.unseen > b.unseen; });
  return objects;
}

// Returns the smallest number that at least the confidence's part of binomial samples do not exceed, where each of
// `cells` bounds is too low with a probability of 1 - confidence.
std::uint32_t most_that_exceed(std::uint32_t cells, double confidence) {
  std::uint32_t low = 0, high = cells;
  while (low < high) {
    const std::uint32_t middle = low + (high - low) / 2;
    // The bound at 1 - confidence is the largest p for which `middle` or fewer have the probability `confidence`.
    if (clopper_pearson_upper(middle, cells, 1.0 - confidence) >= 1.0 - confidence)
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

unseen_bound bound_of(const format::reader& file, const nlohmann::json& settings, const std::string& name) {
  unseen_bound out;
  const auto metric = settings.is_object() ? settings.find("metric") : settings.end();
  out.metric = metric_names[static_cast<std::size_t>(metric_kind::pixel)];
  if (metric != settings.end() && metric->is_string()) out.metric = metric->get<std::string>();
  const bool of_colors = out.metric == metric_names[static_cast<std::size_t>(metric_kind::color)];
  double sum = 0.0, largest = 0.0;
  for (std::uint32_t cell = 0; cell < file.certificate_count() && !of_colors; ++cell) {
    format::certificate_record c;
    require_readable(file.certificate(cell, c), name);
    if (!(c.upper_bound < 1.0) || !(c.confidence > 0.0)) continue;
    ++out.cells;
    sum += c.upper_bound;
    largest = std::max(largest, c.upper_bound);
    if (file.viewpoints().exists())
      out.outside_share = std::max(out.outside_share, static_cast<double>(file.viewpoints().outside_share(cell)));
  }
  out.without = file.cell_count() - out.cells;
  // The header is a float, which is not 0.95 exactly.
  const double confidence = std::round(static_cast<double>(file.facts().confidence) * 1e6) / 1e6;
  if (out.cells == 0 || !(confidence > 0.0)) return out;
  out.confidence = confidence;
  out.mean_upper_bound = sum / out.cells;
  out.largest_upper_bound = largest;
  out.cells_that_may_exceed = most_that_exceed(out.cells, confidence);
  return out;
}

std::vector<std::string> warnings_of(const nlohmann::json& settings) {
  std::vector<std::string> out;
  if (!settings.is_object()) return out;
  const auto above_0 = [&](const char* key) {
    const auto found = settings.find(key);
    return found != settings.end() && found->is_number() && *found > 0;
  };
  if (above_0("cell_limit"))
    out.emplace_back(
        "the file is of a trial with --cell-limit: polygons that are visible only from other cells count as unseen");
  if (above_0("time_budget"))
    out.emplace_back(
        "the file is of a bake with --time-budget: polygons that are visible only from cells that it did not reach "
        "count as unseen");
  return out;
}

}  // namespace

unseen_polygons find_unseen(const scene::scene& s, std::span<const std::byte> file, const std::string& name) {
  format::reader opened;
  require_readable(format::reader::open(file, opened), name);
  require_scene(opened, s, name);
  const nlohmann::json settings = scene::parse_json(opened.settings(), false);
  const std::vector<bool> exempt = exempt_polygons(s, opened.settings());
  unseen_polygons out;
  out.cells = opened.cell_count();
  out.polygons = s.polygon_count;
  out.is_unseen = in_some_set(opened, name);
  const std::vector<bool> shadows = in_shadow_maps(opened, name);
  for (std::uint32_t id = 0; id < s.polygon_count; ++id) {
    const bool hidden = !out.is_unseen[id] && !exempt[id];
    out.is_unseen[id] = hidden && !shadows[id];
    out.unseen += out.is_unseen[id];
    out.exempt += exempt[id];
    out.only_in_shadows += hidden && shadows[id];
  }
  out.objects = objects_of(s, out.is_unseen);
  out.bound = bound_of(opened, settings, name);
  out.warnings = warnings_of(settings);
  return out;
}

}  // namespace sightcell::bake
