#include "verify_result.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace sightcell::cli {

using nlohmann::ordered_json;

named_miss name_miss(const scene::scene& s, const bake::verification& v, const bake::missing_polygon& miss) {
  named_miss named;
  named.miss = miss;
  named.draw = scene::draw_of(s, miss.polygon);
  named.node = s.draws[named.draw].node;
  if (named.node < s.node_names.size()) named.node_name = s.node_names[named.node];
  const auto cell = std::find_if(v.cells.begin(), v.cells.end(), [&](const auto& c) { return c.cell == miss.cell; });
  if (cell != v.cells.end() && cell->rays > 0)
    named.share = static_cast<double>(miss.rays) / static_cast<double>(cell->rays);
  return named;
}

const bake::cell_verification* worst_cell(const bake::verification& v) {
  const auto worse = [](const bake::cell_verification& a, const bake::cell_verification& b) {
    return a.error != b.error ? a.error < b.error : a.upper_bound < b.upper_bound;
  };
  const auto worst = std::max_element(v.cells.begin(), v.cells.end(), worse);
  return worst == v.cells.end() ? nullptr : &*worst;
}

ordered_json miss_json(const named_miss& named) {
  return {{"cell", named.miss.cell}, {"polygon", named.miss.polygon}, {"draw", named.draw},
          {"node", named.node},      {"node_name", named.node_name},  {"rays", named.miss.rays},
          {"share", named.share},    {"eye", named.miss.eye},         {"target", named.miss.target}};
}

ordered_json verify_json(const bake::verification& v, const std::vector<named_miss>& missing,
                         const ordered_json& worst_view, const asked_of_verify& asked) {
  const bake::cell_verification* worst = worst_cell(v);
  ordered_json result = {{"metric", asked.metric},
                         {"pixel_error", v.pixel_error},
                         {"upper_bound", v.upper_bound},
                         {"confidence", v.confidence},
                         {"rays", v.rays},
                         {"misses", v.misses},
                         {"volume_misses", v.misses_of_volumes},
                         {"cells", v.cells.size()},
                         {"visible_set_percent", v.visible_set_percent},
                         {"max_pixel_error", asked.bound},
                         {"passed", v.upper_bound <= asked.bound},
                         {"seed", asked.seed},
                         {"worst_view", worst_view}};
  result["worst_cell"] = worst != nullptr ? ordered_json(worst->cell) : ordered_json(nullptr);
  result["worst_cell_error"] = worst != nullptr ? worst->error : 0.0;
  result["worst_cell_upper_bound"] = worst != nullptr ? worst->upper_bound : 1.0;
  ordered_json& list = result["missing"] = ordered_json::array();
  for (const named_miss& named : missing) list.push_back(miss_json(named));
  return result;
}

std::uint64_t rays_for(double bound) {
  return static_cast<std::uint64_t>(std::ceil(10.0 / bound));
}

}  // namespace sightcell::cli
