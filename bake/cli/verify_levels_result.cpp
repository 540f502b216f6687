#include "verify_levels_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "number_text.h"
#include "sightcell/scene/scene.h"

namespace sightcell::cli {

using nlohmann::ordered_json;

namespace {

constexpr std::size_t levels_on_terminal = 10;  // --json has all that verify keeps

std::string quoted_node(const scene::scene& s, std::uint32_t draw) {
  const std::uint32_t node = s.draws[draw].node;
  return fmt::format("node {} \"{}\"", node, node < s.node_names.size() ? s.node_names[node] : std::string());
}

const char* kind_name(bake::level_miss kind) {
  return kind == bake::level_miss::of_set ? "set" : kind == bake::level_miss::at_level ? "level" : "revealed";
}

std::string missing_text(const bake::missing_at_levels& m, const scene::scene& s) {
  switch (m.kind) {
    case bake::level_miss::of_set:
      return fmt::format("polygon {} of {}, which the set lacks without levels too", m.polygon, quoted_node(s, m.draw));
    case bake::level_miss::at_level:
      return fmt::format("level {} of {}, of which the set has no polygon", m.level, quoted_node(s, m.draw));
    case bake::level_miss::revealed:
      break;
  }
  const std::string before = m.before == scene::no_index
                                 ? std::string()
                                 : fmt::format(", behind a coarser level of {}", quoted_node(s, m.before));
  return fmt::format("polygon {} of {}{}", m.polygon, quoted_node(s, m.draw), before);
}

ordered_json node_json(const scene::scene& s, std::uint32_t draw) {
  if (draw == scene::no_index) return nullptr;
  const std::uint32_t node = s.draws[draw].node;
  return {
      {"draw", draw}, {"node", node}, {"node_name", node < s.node_names.size() ? s.node_names[node] : std::string()}};
}

}  // namespace

void report_levels(const bake::level_verification& v, const scene::scene& s, double bound, progress_line& line) {
  for (std::size_t i = 0; i < std::min(v.missing.size(), levels_on_terminal); ++i)
    line.message(fmt::format("missing in cell {}: {}: {} rays", v.missing[i].cell, missing_text(v.missing[i], s),
                             v.missing[i].rays));
  line.message(fmt::format(
      "{} objects with {} coarser levels; {:.2f} % of the rays hit one", grouped(v.objects), grouped(v.levels),
      100.0 * static_cast<double>(v.rays_at_levels) / static_cast<double>(std::max<std::uint64_t>(v.rays, 1))));
  if (v.levels_without_switch > 0)
    line.message(fmt::format("{} of the levels have no distance or coverage where they begin, and are not drawn",
                             grouped(v.levels_without_switch)));
  line.message(
      fmt::format("{}: with levels {} misses of {} rays in {} cells; miss probability {:.2e}, at most {:.2e} ({:g} % "
                  "sure); asked for {:g}",
                  v.upper_bound <= bound ? "passed" : "FAILED", grouped(v.misses), grouped(v.rays),
                  grouped(v.cells.size()), v.pixel_error, v.upper_bound, 100.0 * v.confidence, bound));
  if (v.misses > 0)
    line.message(
        fmt::format("of the misses, {} are of the sets without levels too, {} hit levels of objects that the "
                    "sets lack, {} show what a finer level occludes",
                    grouped(v.misses_of_set), grouped(v.misses_at_levels), grouped(v.misses_revealed)));
}

ordered_json levels_json(const bake::level_verification& v, const scene::scene& s, double bound) {
  ordered_json out = {{"rays", v.rays},
                      {"misses", v.misses},
                      {"misses_of_set", v.misses_of_set},
                      {"misses_at_levels", v.misses_at_levels},
                      {"misses_revealed", v.misses_revealed},
                      {"rays_at_levels", v.rays_at_levels},
                      {"pixel_error", v.pixel_error},
                      {"upper_bound", v.upper_bound},
                      {"confidence", v.confidence},
                      {"max_pixel_error", bound},
                      {"passed", v.upper_bound <= bound},
                      {"cells", v.cells.size()},
                      {"objects", v.objects},
                      {"levels", v.levels},
                      {"levels_without_switch", v.levels_without_switch},
                      {"missing", ordered_json::array()}};
  for (const bake::missing_at_levels& m : v.missing) {
    ordered_json one = {{"kind", kind_name(m.kind)}, {"cell", m.cell}};
    one.update(node_json(s, m.draw));
    one["level"] = m.level;
    one["polygon"] = m.polygon == scene::no_index ? ordered_json() : ordered_json(m.polygon);
    one["before"] = node_json(s, m.before);
    one["rays"] = m.rays;
    one["eye"] = m.eye;
    one["target"] = m.target;
    out["missing"].push_back(std::move(one));
  }
  return out;
}

}  // namespace sightcell::cli
