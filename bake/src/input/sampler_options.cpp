#include "sightcell/bake/sampler_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace sightcell::bake {
namespace {

using names = std::string_view;

constexpr std::array importance_samplers{names("importance-depth"), names("importance-depth-color")};
constexpr std::array nir04_alone{names("nir04")};
constexpr std::array hemicube_samplers{names("guided"), names("importance-depth"), names("importance-depth-color"),
                                       names("nir04"),  names("uniform"),          names("halton")};
constexpr std::array jittered_samplers{names("importance-depth"), names("importance-depth-color"), names("nir04"),
                                       names("uniform"), names("halton")};
constexpr std::array gvs_alone{names("gvs")};
constexpr std::array gvs_plus_plus_alone{names("gvs++")};
constexpr std::array agvs_alone{names("agvs")};
constexpr std::array border_samplers{names("gvs"), names("gvs++")};
constexpr std::array ray_samplers{names("gvs"), names("gvs++"), names("agvs")};
constexpr std::array sharing_samplers{names("importance-depth"),
                                      names("importance-depth-color"),
                                      names("nir04"),
                                      names("uniform"),
                                      names("halton"),
                                      names("gvs"),
                                      names("gvs++")};
constexpr std::array every_sampler{names("guided"),
                                   names("importance-depth"),
                                   names("importance-depth-color"),
                                   names("nir04"),
                                   names("uniform"),
                                   names("halton"),
                                   names("gvs"),
                                   names("gvs++"),
                                   names("agvs")};

constexpr std::array<sampler_info, 9> all_samplers{{
    {"guided", "hemicubes and verified dilation in turns, until the estimated pixel error is below the target", "ours"},
    {"importance-depth", "hemicubes on the cell's faces, toward gaps in depth", "the thesis"},
    {"importance-depth-color", "the same; gaps count more where new polygons change the picture's colors",
     "the thesis"},
    {"nir04", "hemicubes on the cell's faces, between those that see different polygons", "Nirenstein and Blake 2004"},
    {"uniform", "hemicubes on a regular grid over the cell's faces", ""},
    {"halton", "hemicubes evenly spread over the cell's faces",
     "Halton 1964, shifted as by Cranley and Patterson 1976"},
    {"gvs", "random rays, then rays past the borders of the polygons they found and past their occluders",
     "Wonka et al. 2006"},
    {"gvs++", "very many random rays, then rays past the borders of all polygons they found and from the cell's edges",
     "Koch and Wimmer 2021"},
    {"agvs", "rays for all cells at once: random ones, and mutations of those that found something",
     "Bittner et al. 2009"},
}};

constexpr std::array<sampler_option, 15> all_options{{
    {"--samples", "N",
     "maximum hemicubes per cell; with an error target, guided takes this many in its first round and more as needed",
     &settings::samples, 6, 100'000, hemicube_samplers},
    {"--seconds-per-cell", "S",
     "maximum seconds of one core per cell, so that its set depends on the machine; 0: no limit",
     &settings::seconds_per_cell, 0, 1e6, every_sampler},
    {"--interior-share", "Q",
     "in a cell with geometry inside, the share of hemicubes (as full cubes) or random rays that start inside",
     &settings::interior_share, 0, 0.9, sharing_samplers},
    {"--jitter", "", "turn every hemicube at random by up to half a pixel", &settings::jitter, 0, 1, jittered_samplers},
    {"--reliability", "R", "a face is done when its reliability map is at least this everywhere",
     &settings::reliability, 0.01, 1, importance_samplers},
    {"--start-grid", "N", "initial hemicubes along each side of a face; 0: 1 to 3, by --samples", &settings::start_grid,
     0, 16, importance_samplers},
    {"--difference", "D", "a quad is not divided where its corners differ by at most this", &settings::difference, 0, 1,
     nir04_alone},
    {"--part-polygons", "N",
     "a cell that sees more polygons than this is sampled again in two halves, and so on; 0: never",
     &settings::part_polygons, 0, 4294967295.0, nir04_alone},
    {"--sampling-rays", "N", "maximum rays per cell", &settings::sampling_rays, 1000, 1e11, ray_samplers},
    {"--rays-per-round", "N", "random rays before the polygons they found are followed; for agvs, all rays of a round",
     &settings::rays_per_round, 512, 1e9, ray_samplers},
    {"--fewest-new", "N",
     "a cell is done when a round (gvs++: three in a row) and what followed it found fewer new polygons than this "
     "(agvs: all cells, by their mean); 0: when its rays are spent",
     &settings::fewest_new, 0, 4294967295.0, ray_samplers},
    {"--border-depth", "N", "how often a stretch of a polygon's border is halved where its ends see different polygons",
     &settings::border_depth, 0, 12, gvs_alone},
    {"--border-samples", "N",
     "rays past each edge of a found polygon, and from each edge of the cell toward the hidden points there",
     &settings::border_samples, 1, 1000, gvs_plus_plus_alone},
    {"--border-offset", "D", "how far past a border rays go, as a share of the distance to it",
     &settings::border_offset, 1e-6, 0.1, border_samplers},
    {"--filter", "M", "meters: polygons that cells within this distance see join the cell's set, unverified; 0: none",
     &settings::filter, 0, 100, agvs_alone},
}};

}  // namespace

bool sampler_option::of(std::string_view sampler) const {
  return std::find(samplers.begin(), samplers.end(), sampler) != samplers.end();
}

std::span<const sampler_info> samplers() {
  return all_samplers;
}

std::span<const sampler_option> sampler_options() {
  return all_options;
}

bool takes_hemicubes(std::string_view sampler) {
  return std::find(hemicube_samplers.begin(), hemicube_samplers.end(), sampler) != hemicube_samplers.end();
}

bool uses_importance(std::string_view sampler) {
  return std::find(importance_samplers.begin(), importance_samplers.end(), sampler) != importance_samplers.end();
}

std::string value_text(const sampler_option& option, const settings& s) {
  return std::visit([&](auto member) { return fmt::format("{}", s.*member); }, option.value);
}

}  // namespace sightcell::bake
