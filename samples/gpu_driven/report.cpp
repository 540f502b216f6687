#include "report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

namespace gpu_driven {
namespace {

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

double pixels_of(const renderer& draws, const section& own) {
  return static_cast<double>(draws.size().width) * draws.size().height * static_cast<double>(own.frames);
}

std::vector<std::pair<const char*, const section*>> named(const sections& all) {
  std::vector<std::pair<const char*, const section*>> out;
  for (const auto& [name, own] :
       {std::pair("cuts", &all.cuts), {"settled", &all.settled}, {"walk", &all.walk}, {"turns", &all.turns}}) {
    if (own->frames > 0) out.emplace_back(name, own);
  }
  return out;
}

nlohmann::ordered_json json_of(const section& own, const renderer& draws, std::size_t m) {
  const mode_sums& sums = own.modes[m];
  const auto frames = static_cast<double>(own.frames);
  nlohmann::ordered_json out;
  if (m != static_cast<std::size_t>(draw_mode::everything) || draws.has_levels()) {
    out = {{"clusters", static_cast<double>(sums.clusters) / frames},
           {"triangles", static_cast<double>(sums.triangles) / frames},
           {"in_set_share", share(sums.clusters_in_set, sums.clusters)},
           {"missed", sums.missed},
           {"missed_with_wrong", sums.missed_with_wrong},
           {"wrong_pixels", sums.wrong_pixels},
           {"wrong_share", static_cast<double>(sums.wrong_pixels) / pixels_of(draws, own)},
           {"most_wrong_share", static_cast<double>(sums.most_wrong_pixels) * frames / pixels_of(draws, own)},
           {"beyond_bound", own.beyond_bound(static_cast<draw_mode>(m))},
           {"ties", sums.ties},
           {"differing_share", static_cast<double>(sums.differing) / pixels_of(draws, own)},
           {"mean_difference", sums.difference / pixels_of(draws, own)}};
  }
  out["multi_draws"] = draws.multi_draws(static_cast<draw_mode>(m));
  out["device_ms"] = sums.device_milliseconds / frames;
  out["host_ms"] = sums.host_milliseconds / frames;
  return out;
}

void print_row(const section& own, const renderer& draws, std::size_t m) {
  const mode_sums& sums = own.modes[m];
  const auto frames = static_cast<double>(own.frames);
  fmt::print("{:<14}{:>10.1f}{:>12.1f}{:>9.2f}{:>9}{:>8}{:>10.1e}{:>10.1e}{:>11.0f}{:>9.3f}{:>9.3f}\n", mode_names[m],
             static_cast<double>(sums.clusters) / frames, static_cast<double>(sums.triangles) / frames,
             100.0 * share(sums.clusters_in_set, sums.clusters), sums.missed, sums.missed_with_wrong,
             static_cast<double>(sums.wrong_pixels) / pixels_of(draws, own),
             static_cast<double>(sums.most_wrong_pixels) * frames / pixels_of(draws, own),
             own.beyond_bound(static_cast<draw_mode>(m)), sums.device_milliseconds / frames,
             sums.host_milliseconds / frames);
}

}  // namespace

void print_json(const run_facts& facts, const host_scene& host, const sightcell::db& db, const renderer& draws,
                const sections& all) {
  const auto info = db.info();
  nlohmann::ordered_json out{{"scene", facts.scene},
                             {"device", facts.device},
                             {"software", facts.is_software},
                             {"count_in_buffer", draws.counts()},
                             {"width", draws.size().width},
                             {"height", draws.size().height},
                             {"seed", facts.seed},
                             {"polygons", db.polygon_count()},
                             {"draws", host.draws},
                             {"triangles", host.triangles},
                             {"clusters", host.clusters.size() - host.coarse_clusters},
                             {"coarse_clusters", host.coarse_clusters},
                             {"bins", host.bins.size()},
                             {"textures", host.textures.size()},
                             {"cells", db.cell_count()},
                             {"max_pixel_error", info ? info->max_pixel_error : 0.0f},
                             {"jumps", facts.jumps}};
  if (draws.has_levels()) out["cut_pixels"] = draws.size().most_pixels;
  for (const auto& [name, own] : named(all)) {
    nlohmann::ordered_json& made = out["sections"][name];
    made = {{"frames", own->frames},
            {"seen", static_cast<double>(own->seen) / static_cast<double>(own->frames)},
            {"seen_in_set_share", share(own->seen_in_set, own->seen)},
            {"allowed_pixels", own->allowed_pixels}};
    for (std::size_t m = 0; m < mode_count; ++m) {
      if (draws.draws(static_cast<draw_mode>(m))) made["modes"][mode_names[m]] = json_of(*own, draws, m);
    }
  }
  fmt::print("{}\n", out.dump(2));
}

void print_table(const run_facts& facts, const host_scene& host, const sightcell::db& db, const renderer& draws,
                 const sections& all) {
  const auto info = db.info();
  fmt::print("{}: {} polygons, {} draws, {} clusters, {} bins, {} cells, bound {:.1e}; {} x {} pixels; {}{}\n",
             facts.scene, db.polygon_count(), host.draws, host.clusters.size() - host.coarse_clusters, host.bins.size(),
             db.cell_count(), info ? info->max_pixel_error : 0.0f, draws.size().width, draws.size().height,
             facts.device, draws.counts() ? "" : ", no count in a buffer");
  if (draws.has_levels())
    fmt::print("a cut of {} coarser clusters at {} pixels\n", host.coarse_clusters, draws.size().most_pixels);
  for (const auto& [name, own] : named(all)) {
    fmt::print("\n{}: {} frames, {:.1f} clusters seen per frame, {:.3f} % of them in the PVS", name, own->frames,
               static_cast<double>(own->seen) / static_cast<double>(own->frames),
               100.0 * share(own->seen_in_set, own->seen));
    if (own == &all.walk && facts.jumps > 0) fmt::print(", {} jumps", facts.jumps);
    fmt::print("\n{:<14}{:>10}{:>12}{:>9}{:>9}{:>8}{:>10}{:>10}{:>11}{:>9}{:>9}\n", "mode", "clusters", "triangles",
               "% in PVS", "missed", "wrong", "pixels", "worst", "beyond", "GPU ms", "host ms");
    for (std::size_t m = 0; m < mode_count; ++m) {
      if (!draws.draws(static_cast<draw_mode>(m))) continue;
      if (m == static_cast<std::size_t>(draw_mode::everything) && !draws.has_levels()) {
        fmt::print("{:<14}{:>10}{:>12}{:>9}{:>9}{:>8}{:>10}{:>10}{:>8}{:>9.3f}{:>9.3f}\n", mode_names[m],
                   host.clusters.size(), host.triangles, "", "", "", "", "", "",
                   own->modes[m].device_milliseconds / static_cast<double>(own->frames),
                   own->modes[m].host_milliseconds / static_cast<double>(own->frames));
      } else {
        print_row(*own, draws, m);
        if (m == static_cast<std::size_t>(draw_mode::leaves))
          fmt::print("  leaves: {:.3f} % of the pixels have another color than the cut, {:.4f} % in the mean\n",
                     100.0 * static_cast<double>(own->modes[m].differing) / pixels_of(draws, *own),
                     100.0 * own->modes[m].difference / pixels_of(draws, *own));
      }
    }
  }
}

}  // namespace gpu_driven
