#include "sightcell/bake/sampler_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace sightcell::bake {
namespace {

using names = std::string_view;

constexpr std::array importance_samplers{names("importance-depth"), names("importance-depth-color")};
constexpr std::array nir04_alone{names("nir04")};
constexpr std::array hemicube_samplers{names("importance-depth"), names("importance-depth-color"), names("nir04"),
                                       names("uniform"), names("halton")};
constexpr std::array every_sampler{names("importance-depth"), names("importance-depth-color"), names("nir04"),
                                   names("uniform"), names("halton")};

constexpr std::array<sampler_info, 5> all_samplers{{
    {"importance-depth", "hemicubes on the cell's faces, toward where depth shows gaps", "the thesis (METHOD.md)"},
    {"importance-depth-color", "the same, and gaps count more where what is new changes the picture's colors",
     "the thesis (METHOD.md)"},
    {"nir04", "hemicubes on the cell's faces, between those that see different polygons", "Nirenstein and Blake 2004"},
    {"uniform", "hemicubes on a regular grid over the cell's faces", ""},
    {"halton", "hemicubes evenly spread over the cell's faces",
     "Halton 1964, shifted as by Cranley and Patterson 1976"},
}};

constexpr std::array<sampler_option, 8> all_options{{
    {"--samples", "N", "hemicubes per cell, at most", &settings::samples, 6, 100'000, hemicube_samplers},
    {"--seconds-per-cell", "S",
     "seconds of one core after which a cell is sampled no more, so that its set depends on the machine; 0: no limit",
     &settings::seconds_per_cell, 0, 1e6, every_sampler},
    {"--interior-share", "Q",
     "of the hemicubes of a cell with geometry inside: they become full cubes at free places in it",
     &settings::interior_share, 0, 0.9, hemicube_samplers},
    {"--jitter", "", "turn every hemicube at random by up to half a pixel", &settings::jitter, 0, 1, hemicube_samplers},
    {"--reliability", "R", "a face is done when its map of reliability is nowhere below this", &settings::reliability,
     0.01, 1, importance_samplers},
    {"--start-grid", "N", "hemicubes along each side of a face that come first; 0: 1 to 3, by --samples",
     &settings::start_grid, 0, 16, importance_samplers},
    {"--difference", "D", "between corners of a quad: where it is at most this, the quad is not divided",
     &settings::difference, 0, 1, nir04_alone},
    {"--part-polygons", "N", "a cell that sees more polygons is sampled again in two halves, and those too; 0: never",
     &settings::part_polygons, 0, 4294967295.0, nir04_alone},
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

std::string value_text(const sampler_option& option, const settings& s) {
  return std::visit([&](auto member) { return fmt::format("{}", s.*member); }, option.value);
}

}  // namespace sightcell::bake
