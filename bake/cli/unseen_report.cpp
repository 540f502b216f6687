#include "unseen_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "number_text.h"
#include "whole_file.h"

namespace sightcell::cli {
namespace {

using nlohmann::ordered_json;

double share_of(std::uint32_t part, std::uint32_t all) {
  return all > 0 ? static_cast<double>(part) / all : 0.0;
}

// Source ids as in a cells file: 12, [100, 199].
ordered_json ids_json(const std::vector<bool>& is_in) {
  ordered_json list = ordered_json::array();
  for (std::size_t first = 0; first < is_in.size(); ++first) {
    if (!is_in[first]) continue;
    std::size_t last = first;
    while (last + 1 < is_in.size() && is_in[last + 1]) ++last;
    list.push_back(first == last ? ordered_json(first) : ordered_json::array({first, last}));
    first = last;
  }
  return list;
}

ordered_json objects_json(const std::vector<bake::unseen_object>& objects) {
  ordered_json list = ordered_json::array();
  for (const bake::unseen_object& o : objects)
    list.push_back({{"node", o.node},
                    {"node_name", o.name},
                    {"polygons", o.polygons},
                    {"unseen", o.unseen},
                    {"share", share_of(o.unseen, o.polygons)}});
  return list;
}

ordered_json bound_json(const bake::unseen_bound& b) {
  const auto or_null = [&](double value) { return b.cells > 0 ? ordered_json(value) : ordered_json(nullptr); };
  return {{"metric", b.metric},
          {"cells", b.cells},
          {"cells_without", b.without},
          {"mean_upper_bound", or_null(b.mean_upper_bound)},
          {"largest_upper_bound", or_null(b.largest_upper_bound)},
          {"confidence", or_null(b.confidence)},
          {"cells_that_may_exceed", b.cells_that_may_exceed},
          {"outside_share", b.outside_share},
          {"text", unseen_bound_text(b)}};
}

}  // namespace

std::string unseen_text(const bake::unseen_polygons& found) {
  std::string text = fmt::format("{} of {} polygons ({:.1f} %) are visible from no cell", grouped(found.unseen),
                                 grouped(found.polygons), 100.0 * share_of(found.unseen, found.polygons));
  if (found.only_in_shadows > 0)
    text += fmt::format(", apart from {} that shadows need", grouped(found.only_in_shadows));
  return text;
}

std::string unseen_bound_text(const bake::unseen_bound& b) {
  const std::string colors =
      b.metric == "color" ? ": the bounds in the file are differences of colors, which do not limit this" : "";
  if (b.cells == 0) return "No cell has a bound on the part of the view that unseen polygons can cover" + colors + ".";
  std::string text = fmt::format(
      "Averaged over the valid viewpoints of a cell, unseen polygons cover at most {:.2g} % of {} in the worst cell, "
      "and {:.2g} % in the mean of {} cells. Each of these bounds holds with {:g} % confidence by itself; with {:g} % "
      "confidence, at most {} of them are too low.",
      100.0 * b.largest_upper_bound,
      b.metric == "view"
          ? "the directions that the camera of --metric view shows, apart from polygons too small to count,"
          : "all directions of view",
      100.0 * b.mean_upper_bound, grouped(b.cells), 100.0 * b.confidence, 100.0 * b.confidence,
      grouped(b.cells_that_may_exceed));
  if (b.outside_share > 0.0)
    text += fmt::format(" They leave out up to {:.2g} % of the valid viewpoints of a cell.", 100.0 * b.outside_share);
  if (b.without > 0) text += fmt::format(" {} cells have no bound.", grouped(b.without));
  return text;
}

ordered_json unseen_json(const bake::unseen_polygons& found) {
  return {{"polygons", found.polygons},
          {"unseen", found.unseen},
          {"share", share_of(found.unseen, found.polygons)},
          {"exempt", found.exempt},
          {"only_in_shadows", found.only_in_shadows},
          {"cells", found.cells},
          {"bound", bound_json(found.bound)},
          {"warnings", found.warnings},
          {"objects", objects_json(found.objects)},
          {"unseen_polygons", ids_json(found.is_unseen)}};
}

void write_unseen_report(const bake::unseen_polygons& found, const std::filesystem::path& path) {
  std::string text = unseen_json(found).dump(1, ' ', false, ordered_json::error_handler_t::replace);
  text += '\n';
  write_whole_file(path, text);
}

}  // namespace sightcell::cli
