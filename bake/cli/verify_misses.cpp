#include "verify_misses.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "number_text.h"
#include "sightcell/scene/scene.h"

namespace sightcell::cli {
namespace {

constexpr std::size_t named_on_terminal = 10;  // --json has all

std::string name_of_node(const scene::scene& s, std::uint32_t node) {
  return node < s.node_names.size() ? s.node_names[node] : std::string();
}

}  // namespace

void report_misses(const bake::miss_check& found, const scene::scene& s, const std::string& file, progress_line& line) {
  const std::size_t named = std::min(found.list.size(), named_on_terminal);
  for (std::size_t i = 0; i < named; ++i) {
    const bake::reproduced_miss& miss = found.list[i];
    const scene::draw& draw = s.draws[scene::draw_of(s, miss.polygon)];
    line.message(fmt::format("reproduced: polygon {} (node {} \"{}\") is missing in cell {} and seen from {},{},{}",
                             miss.polygon, draw.node, name_of_node(s, draw.node), miss.cell, miss.eye[0], miss.eye[1],
                             miss.eye[2]));
  }
  if (found.list.size() > named)
    line.message(fmt::format("... and {} more (--json lists them)", found.list.size() - named));
  line.message(
      fmt::format("{}: {} of {} reports reproduced; {} not missing, {} not visible, {} from no free place, {} from no "
                  "cell",
                  file, grouped(found.reproduced), grouped(found.reports), grouped(found.not_missing),
                  grouped(found.not_visible), grouped(found.not_free), grouped(found.outside)));
}

nlohmann::ordered_json misses_json(const bake::miss_check& found, const scene::scene& s) {
  nlohmann::ordered_json result = {{"reports", found.reports},         {"reproduced", found.reproduced},
                                   {"not_missing", found.not_missing}, {"not_visible", found.not_visible},
                                   {"not_free", found.not_free},       {"outside", found.outside}};
  nlohmann::ordered_json& list = result["list"] = nlohmann::ordered_json::array();
  for (const bake::reproduced_miss& miss : found.list) {
    const std::uint32_t draw = scene::draw_of(s, miss.polygon), node = s.draws[draw].node;
    list.push_back({{"cell", miss.cell},
                    {"polygon", miss.polygon},
                    {"draw", draw},
                    {"node", node},
                    {"node_name", name_of_node(s, node)},
                    {"eye", miss.eye}});
  }
  return result;
}

}  // namespace sightcell::cli
