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
    {"guided", "hemicubes and rays beside what they saw, by turns, until what is missing is below the error asked for",
     "ours (METHOD.md)"},
    {"importance-depth", "hemicubes on the cell's faces, toward where depth shows gaps", "the thesis (METHOD.md)"},
    {"importance-depth-color", "the same, and gaps count more where what is new changes the picture's colors",
     "the thesis (METHOD.md)"},
    {"nir04", "hemicubes on the cell's faces, between those that see different polygons", "Nirenstein and Blake 2004"},
    {"uniform", "hemicubes on a regular grid over the cell's faces", ""},
    {"halton", "hemicubes evenly spread over the cell's faces",
     "Halton 1964, shifted as by Cranley and Patterson 1976"},
    {"gvs", "rays: at random, then past the borders of what they found and past what hides it", "Wonka et al. 2006"},
    {"gvs++", "rays: very many at random, then in bulk past the borders of all they found and from the cell's edges",
     "Koch and Wimmer 2021"},
    {"agvs", "rays for all cells at once: at random, and beside those that found something", "Bittner et al. 2009"},
}};

constexpr std::array<sampler_option, 15> all_options{{
    {"--samples", "N",
     "hemicubes per cell, at most; of guided with an error to reach those of its first round: it takes more as it "
     "needs "
     "them",
     &settings::samples, 6, 100'000, hemicube_samplers},
    {"--seconds-per-cell", "S",
     "seconds of one core after which a cell is sampled no more, so that its set depends on the machine; 0: no limit",
     &settings::seconds_per_cell, 0, 1e6, every_sampler},
    {"--interior-share", "Q",
     "of the hemicubes (as full cubes) or random rays of a cell with geometry inside: they start at free places in it",
     &settings::interior_share, 0, 0.9, sharing_samplers},
    {"--jitter", "", "turn every hemicube at random by up to half a pixel", &settings::jitter, 0, 1, jittered_samplers},
    {"--reliability", "R", "a face is done when its map of reliability is nowhere below this", &settings::reliability,
     0.01, 1, importance_samplers},
    {"--start-grid", "N", "hemicubes along each side of a face that come first; 0: 1 to 3, by --samples",
     &settings::start_grid, 0, 16, importance_samplers},
    {"--difference", "D", "between corners of a quad: where it is at most this, the quad is not divided",
     &settings::difference, 0, 1, nir04_alone},
    {"--part-polygons", "N", "a cell that sees more polygons is sampled again in two halves, and those too; 0: never",
     &settings::part_polygons, 0, 4294967295.0, nir04_alone},
    {"--sampling-rays", "N", "rays per cell, all of them, at most", &settings::sampling_rays, 1000, 1e11, ray_samplers},
    {"--rays-per-round", "N",
     "random rays, before what they found is followed; of agvs all rays that are cast before their finds count",
     &settings::rays_per_round, 512, 1e9, ray_samplers},
    {"--fewest-new", "N",
     "a cell is done when a round (gvs++: three in a row), with all it led to, found fewer new polygons; 0: when its "
     "rays are spent; of agvs all cells are, when a round found fewer in their mean",
     &settings::fewest_new, 0, 4294967295.0, ray_samplers},
    {"--border-depth", "N", "how often a stretch of a polygon's border is halved where its ends see different polygons",
     &settings::border_depth, 0, 12, gvs_alone},
    {"--border-samples", "N",
     "rays past each edge of a found polygon, and from each edge of the cell toward what is hidden there",
     &settings::border_samples, 1, 1000, gvs_plus_plus_alone},
    {"--border-offset", "D", "how far past a border rays go, as a share of the distance to it",
     &settings::border_offset, 1e-6, 0.1, border_samplers},
    {"--filter", "M",
     "metres: what cells within so much of a cell's box see joins its set unverified, seen from there or not; 0: "
     "nothing",
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

std::string value_text(const sampler_option& option, const settings& s) {
  return std::visit([&](auto member) { return fmt::format("{}", s.*member); }, option.value);
}

}  // namespace sightcell::bake
