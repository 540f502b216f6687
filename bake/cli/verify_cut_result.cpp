#include "verify_cut_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "number_text.h"
#include "sightcell/scene/scene.h"

namespace sightcell::cli {

using nlohmann::ordered_json;

namespace {

constexpr std::size_t clusters_on_terminal = 5;  // of each cut; --json has all that verify keeps

std::string node_name_of(const scene::scene& s, std::uint32_t draw) {
  const std::uint32_t node = s.draws[draw].node;
  return node < s.node_names.size() ? s.node_names[node] : std::string();
}

const char* kind_name(bake::cut_miss kind) {
  return kind == bake::cut_miss::of_set ? "set" : kind == bake::cut_miss::at_coarse ? "coarse" : "revealed";
}

const char* kind_text(bake::cut_miss kind) {
  switch (kind) {
    case bake::cut_miss::of_set:
      return ", which the set lacks without levels too";
    case bake::cut_miss::at_coarse:
      return ", of which the set has no cluster below";
    case bake::cut_miss::revealed:
      break;
  }
  return ", which level 0 occludes";
}

void report_outcomes(const bake::cut_verification& cut, progress_line& line) {
  if (cut.misses > 0)
    line.message(
        fmt::format("{:g} pixels: of the misses, {} are of the sets without levels too, {} hit coarse "
                    "clusters that the sets lack, {} show what level 0 occludes; {} are at polygons of the "
                    "scene",
                    cut.pixels, grouped(cut.misses_of_set), grouped(cut.misses_at_coarse), grouped(cut.misses_revealed),
                    grouped(cut.misses_of_leaves)));
  if (cut.rays_in_gaps > 0)
    line.message(fmt::format("{:g} pixels: {} more rays pass gaps of the scene that are too narrow to count",
                             cut.pixels, grouped(cut.rays_in_gaps)));
  line.message(
      fmt::format("{:g} pixels: {} rays pass openings of the whole cut where level 0 blocks them; {} of them farther "
                  "from the cut than its error",
                  cut.pixels, grouped(cut.rays_opened), grouped(cut.rays_opened_beyond_error)));
}

std::string rounded(double mean) {
  return grouped(static_cast<std::uint64_t>(mean + 0.5));
}

}  // namespace

void report_cuts(const std::vector<bake::cut_verification>& cuts, const scene::scene& s, double bound,
                 progress_line& line) {
  for (const bake::cut_verification& cut : cuts) {
    for (std::size_t i = 0; i < std::min(cut.missing.size(), clusters_on_terminal); ++i) {
      const bake::missing_cluster& m = cut.missing[i];
      line.message(fmt::format("missing at {:g} pixels: {} {} (draw {}, node \"{}\") in cell {}{}: {} rays", cut.pixels,
                               m.leaf ? "cluster" : "coarse cluster", m.cluster, m.draw, node_name_of(s, m.draw),
                               m.cell, kind_text(m.kind), m.rays));
    }
    line.message(
        fmt::format("{}: {:g} pixels: {} misses of {} rays in {} cells; miss "
                    "probability {:.2e}, at most {:.2e} ({:g} % sure); asked for {:g}",
                    cut.upper_bound <= bound ? "passed" : "FAILED", cut.pixels, grouped(cut.misses), grouped(cut.rays),
                    grouped(cut.cells.size()), cut.pixel_error, cut.upper_bound, 100.0 * cut.confidence, bound));
    report_outcomes(cut, line);
    line.message(
        fmt::format("{:g} pixels: a cut has {} clusters and {} triangles, of which {} and {} are visible; "
                    "without levels {} clusters and {} polygons are",
                    cut.pixels, rounded(cut.cut_clusters), rounded(cut.cut_triangles), rounded(cut.drawn_clusters),
                    rounded(cut.drawn_triangles), rounded(cut.set_clusters), rounded(cut.set_cluster_polygons)));
  }
}

ordered_json cuts_json(const std::vector<bake::cut_verification>& cuts, const scene::scene& s, double bound) {
  ordered_json out = ordered_json::array();
  for (const bake::cut_verification& cut : cuts) {
    ordered_json one = {{"pixels", cut.pixels},
                        {"rays", cut.rays},
                        {"misses", cut.misses},
                        {"leaf_misses", cut.misses_of_leaves},
                        {"misses_of_set", cut.misses_of_set},
                        {"misses_at_coarse", cut.misses_at_coarse},
                        {"misses_revealed", cut.misses_revealed},
                        {"gap_rays", cut.rays_in_gaps},
                        {"opened_rays", cut.rays_opened},
                        {"opened_rays_beyond_error", cut.rays_opened_beyond_error},
                        {"pixel_error", cut.pixel_error},
                        {"upper_bound", cut.upper_bound},
                        {"confidence", cut.confidence},
                        {"max_pixel_error", bound},
                        {"passed", cut.upper_bound <= bound},
                        {"cells", cut.cells.size()},
                        {"leaf_clusters", cut.leaf_clusters},
                        {"coarse_clusters", cut.coarse_clusters},
                        {"cut_clusters", cut.cut_clusters},
                        {"cut_triangles", cut.cut_triangles},
                        {"drawn_clusters", cut.drawn_clusters},
                        {"drawn_triangles", cut.drawn_triangles},
                        {"set_clusters", cut.set_clusters},
                        {"set_cluster_polygons", cut.set_cluster_polygons},
                        {"set_polygons", cut.set_polygons},
                        {"missing", ordered_json::array()}};
    for (const bake::missing_cluster& m : cut.missing)
      one["missing"].push_back({{"kind", kind_name(m.kind)},
                                {"cell", m.cell},
                                {"draw", m.draw},
                                {"node", s.draws[m.draw].node},
                                {"node_name", node_name_of(s, m.draw)},
                                {"cluster", m.cluster},
                                {"leaf", m.leaf},
                                {"rays", m.rays},
                                {"eye", m.eye},
                                {"target", m.target}});
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace sightcell::cli
