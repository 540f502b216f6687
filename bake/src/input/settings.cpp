#include "sightcell/bake/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "input/sun_direction.h"
#include "input/two_scenes.h"
#include "sightcell/bake/sampler_options.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"
#include "sightcell/base/nearest_name.h"

namespace sightcell::bake {

namespace {

constexpr std::array<std::string_view, 4> source_names{"auto", "gpu", "cpu", "rays"};

[[noreturn]] void refuse(const char* option, const std::string& value, const std::string& range) {
  throw error(error_kind::wrong_use, "settings.out-of-range", option, "is " + value, "give " + range);
}

[[noreturn]] void refuse_name(const char* option, const std::string& value, std::span<const std::string_view> names) {
  refuse(option, "\"" + value + "\"", fmt::format("one of {}{}", fmt::join(names, ", "), did_you_mean(value, names)));
}

// The condition rejects NaN too.
template <typename T>
void check(const char* option, T value, T low, T high, const char* unit) {
  if (!(value >= low && value <= high))
    refuse(option, fmt::format("{}", value), fmt::format("{} to {}{}", low, high, unit));
}

void check_box(const char* option, const std::array<float, 6>& box) {
  for (const float value : box) {
    if (!(std::abs(value) <= 1e7f)) refuse(option, fmt::format("{}", value), "meters within 1e7 of the origin");
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(box[axis] < box[axis + 3]))
      refuse(option, fmt::format("{} to {} on {}", box[axis], box[axis + 3], "xyz"[axis]),
             "x0,y0,z0,x1,y1,z1 with the first corner below the second");
  }
}

// Returns the shortest text that reads back as the same number. It is valid JSON because no setting is infinite.
template <typename T>
std::string number(T value) {
  return fmt::format("{}", value);
}

void check_sampler(const settings& s) {
  const auto all = samplers();
  if (std::none_of(all.begin(), all.end(), [&](const sampler_info& one) { return s.sampler == one.name; })) {
    std::vector<std::string_view> names;
    for (const sampler_info& one : all) names.emplace_back(one.name);
    refuse_name("--sampler", s.sampler, names);
  }
  for (const sampler_option& option : sampler_options())
    std::visit(
        [&](auto member) {
          const auto value = static_cast<double>(s.*member);
          if (!(value >= option.low && value <= option.high))
            refuse(option.name, value_text(option, s), fmt::format("{} to {}", option.low, option.high));
        },
        option.value);
}

// Returns the options of the sampler that differ from their defaults.
std::string sampler_text(const settings& s) {
  std::string text;
  const settings defaults;
  for (const sampler_option& option : sampler_options()) {
    const std::string value = value_text(option, s);
    if (!option.of(s.sampler) || value == value_text(option, defaults)) continue;
    std::string key = option.name + 2;  // without its dashes
    std::replace(key.begin(), key.end(), '-', '_');
    if (key != "samples") text += fmt::format(R"(,"{}":{})", key, value);
  }
  return text;
}

// Returns the metric if it is not the default.
std::string metric_text(const metric_settings& s) {
  if (s.kind == metric_kind::pixel) return {};
  std::string text = fmt::format(R"(,"metric":"{}")", metric_names[static_cast<std::size_t>(s.kind)]);
  if (s.kind == metric_kind::view)
    text += fmt::format(R"(,"view_resolution":[{},{}],"view_fov":{},"view_pitch":[{},{}],"view_least":{})",
                        s.view_width, s.view_height, s.view_fov, s.view_pitch[0], s.view_pitch[1], s.view_least);
  return text;
}

bool names_cells(const settings& s) {
  return !s.cells.empty() || s.cells_file || s.cells_grid;
}

void check_flight(const settings& s) {
  for (const std::array<float, 6>& box : s.fly) check_box("--fly", box);
  if (s.near && !std::all_of(s.near->begin(), s.near->end(), [](float x) { return std::abs(x) <= 1e9f; }))
    refuse("--near", fmt::format("{}", fmt::join(*s.near, ",")), "meters, at most 1e9 from the origin");
  check("--path-radius", s.path_radius, 0.0f, 100.0f, " m");
  for (const camera_path& path : s.paths) {
    if (path.empty()) refuse("--path", "a path without points", "one point or more");
    for (const std::array<float, 3>& point : path)
      for (const float value : point)
        if (!(std::abs(value) <= 1e7f))
          refuse("--path", fmt::format("a path to {} m", value), "meters within 1e7 of the origin");
  }
  if (names_cells(s) && flies(s))
    throw error(error_kind::wrong_use, "settings.two-kinds-of-cells", s.fly.empty() ? "--path" : "--fly",
                "is given together with cells of a file, a grid or a host", "give one of them");
  if (s.reach == reach_kind::none && !names_cells(s) && !flies(s))
    refuse("--reach", "none, without --fly and without a path", "walk or everywhere, or --fly or --path");
}

void check_player(const settings& s) {
  if (static_cast<std::size_t>(s.reach) >= reach_names.size())
    refuse("--reach", number(static_cast<int>(s.reach)), "walk, everywhere or none");
  for (const std::array<float, 3>& start : s.starts)
    for (const float value : start)
      if (!(std::abs(value) <= 1e7f)) refuse("--start", fmt::format("{}", value), "meters within 1e7 of the origin");
  const player_settings& p = s.player;
  check("--player-height", p.height, 0.1f, 100.0f, " m");
  check("--player-step", p.step, 0.0f, 100.0f, " m");
  check("--player-jump", p.jump, 0.0f, 100.0f, " m");
  check("--player-gap", p.gap, 0.0f, 100.0f, " m");
  check("--player-slope", p.slope, 0.0f, 89.0f, " degrees");
  check("--eye-heights", p.lowest_eye, 0.0f, 100.0f, " m");
  check("--eye-heights", p.highest_eye, 0.0f, 100.0f, " m");
  if (!(p.lowest_eye <= p.highest_eye))
    refuse("--eye-heights", fmt::format("{},{}", p.lowest_eye, p.highest_eye), "the lower height first");
}

// Returns what decides where automatic cells are, as far as it differs from the default.
std::string player_text(const settings& s) {
  if (names_cells(s)) return {};
  std::string text;
  if (takes_hemicubes(s.sampler)) text += fmt::format(R"(,"merge_cells":{})", number(s.merge_cells));
  const settings standard_cells;
  if (s.most_cells != standard_cells.most_cells) text += fmt::format(R"(,"most_cells":{})", s.most_cells);
  if (s.reach != reach_kind::walk)
    text += fmt::format(R"(,"reach":"{}")", reach_names[static_cast<std::size_t>(s.reach)]);
  for (std::size_t i = 0; i < s.starts.size(); ++i)
    text += fmt::format("{}[{},{},{}]{}", i == 0 ? R"(,"starts":[)" : ",", s.starts[i][0], s.starts[i][1],
                        s.starts[i][2], i + 1 == s.starts.size() ? "]" : "");
  for (std::size_t i = 0; i < s.fly.size(); ++i)
    text += fmt::format("{}[{}]{}", i == 0 ? R"(,"fly":[)" : ",", fmt::join(s.fly[i], ","),
                        i + 1 == s.fly.size() ? "]" : "");
  // Like the boxes of a cells file, the points are left out: the file contains the cells that they lead to.
  if (s.path_file || !s.paths.empty()) text += fmt::format(R"(,"path_radius":{})", number(s.path_radius));
  const player_settings standard;
  const auto add = [&](const char* key, float value, float of_standard) {
    if (value != of_standard) text += fmt::format(R"(,"{}":{})", key, value);
  };
  add("player_height", s.player.height, standard.height);
  add("player_step", s.player.step, standard.step);
  add("player_jump", s.player.jump, standard.jump);
  add("player_gap", s.player.gap, standard.gap);
  add("player_slope", s.player.slope, standard.slope);
  add("lowest_eye", s.player.lowest_eye, standard.lowest_eye);
  add("highest_eye", s.player.highest_eye, standard.highest_eye);
  return text;
}

// A time budget needs a search that can be resumed, and a bound that selects the next cell.
void check_time_budget(const settings& s) {
  if (!(s.time_budget >= 0.0 && s.time_budget <= 1e7)) refuse("--time-budget", number(s.time_budget), "0 to 1e+07");
  if (s.time_budget == 0.0) return;
  const auto refuse_with = [](const char* cause, const char* remedy) {
    throw error(error_kind::wrong_use, "settings.time-budget", "--time-budget", cause, remedy);
  };
  if (s.sampler != "guided") refuse_with("works with the sampler guided only", "leave out --sampler, or --time-budget");
  if (s.max_pixel_error == 0.0)
    refuse_with("needs a bound to improve, and --max-pixel-error 0 has none", "give a --max-pixel-error above 0");
  if (s.seconds_per_cell > 0.0) refuse_with("is given together with --seconds-per-cell", "give one of them");
}

void check_two_scenes(const settings& s) {
  if (s.cells_from == nullptr) return;
  if (s.metric.kind == metric_kind::color) refuse_colors_of_two_scenes("--metric color");
  if (s.sampler == "importance-depth-color") refuse_colors_of_two_scenes("--sampler importance-depth-color");
}

// Steps of a cell must depend on the scene and the cell alone, and all that they see must be recorded.
void check_kept_records(const settings& s) {
  if (s.keep_found && s.since.empty() && !s.keep_records)
    throw error(error_kind::wrong_use, "settings.records", "--keep-found",
                "is given without --since and --keep-records",
                "name the earlier file with --since, or leave out --keep-found");
  if (s.keep_found && s.volumes > 0.0)
    throw error(error_kind::wrong_use, "settings.records", "--keep-found", "does not work with --volumes",
                "leave out one of the two");
  if (!s.order_from.empty() && s.since.empty())
    throw error(error_kind::wrong_use, "settings.records", "--keep-order", "is given without --since",
                "name the earlier file with --since, or leave out --keep-order");
  if (!s.order_from.empty() && s.file.granularity == set_granularity::cluster)
    throw error(error_kind::wrong_use, "settings.records", "--keep-order", "does not work with --granularity cluster",
                "leave out one of the two");
  if (!s.keep_records && s.since.empty()) return;
  const char* const option = s.since.empty() ? "--keep-records" : "--since";
  const auto refuse_with = [&](const char* other) {
    throw error(error_kind::wrong_use, "settings.records", option, fmt::format("does not work with {}", other),
                "leave out one of the two");
  };
  if (s.sampler != "guided") refuse_with("a --sampler other than guided");
  if (s.source != "cpu" && s.source != "auto") refuse_with("a --source other than cpu");
  if (s.metric.kind == metric_kind::color) refuse_with("--metric color");
  if (s.misses_file) refuse_with("--misses");
  if (s.cells_from != nullptr) refuse_with("--cells-from");
  if (s.time_budget > 0.0) refuse_with("--time-budget");
  if (s.seconds_per_cell > 0.0) refuse_with("--seconds-per-cell");
}

void check_volumes(const settings& s) {
  if (s.volumes == 0.0) return;
  if (!(s.volumes >= 0.25 && s.volumes <= 1000.0)) refuse("--volumes", number(s.volumes), "0 (none) or 0.25 to 1000 m");
  if (s.max_pixel_error == 0.0)
    throw error(error_kind::wrong_use, "settings.volumes", "--volumes",
                "are found by rays, and --max-pixel-error 0 casts none",
                "give a --max-pixel-error above 0, or leave out --volumes");
  if (s.cells_from != nullptr)
    throw error(error_kind::wrong_use, "settings.volumes", "--volumes",
                "work with one scene only, and --cells-from names a second one",
                "leave out --volumes here, and bake them with the scene of the cells");
}

void check_suns(const settings& s) {
  if (s.suns.empty()) return;
  if (s.suns.size() > most_suns) refuse("--sun", fmt::format("given {} times", s.suns.size()), "at most 64");
  for (const sun_setting& sun : s.suns) {
    for (const std::array<double, 2>& place : {sun.from, sun.to}) {
      check("--sun", place[0], -360.0, 360.0, " degrees of azimuth");
      check("--sun", place[1], -90.0, 90.0, " degrees of elevation");
    }
    const glm::dvec3 from = toward_sun(sun.from), to = toward_sun(sun.to);
    if (glm::dot(from, to) < -1e-9) refuse("--sun", "a way of more than 90 degrees", "parts of it, each as one --sun");
  }
  const auto refuse_with = [](const char* cause, const char* remedy) {
    throw error(error_kind::wrong_use, "settings.suns", "--sun", cause, remedy);
  };
  if (s.max_pixel_error == 0.0)
    refuse_with("has shadows that rays find, and --max-pixel-error 0 casts none",
                "give a --max-pixel-error above 0, or leave out --sun");
  if (s.time_budget > 0.0) refuse_with("is given together with --time-budget", "give one of them");
}

void check_lights(const settings& s) {
  if (!s.lights) return;
  const auto refuse_with = [](const char* cause, const char* remedy) {
    throw error(error_kind::wrong_use, "settings.lights", "--lights", cause, remedy);
  };
  if (s.max_pixel_error == 0.0)
    refuse_with("needs a bound, and --max-pixel-error 0 has none",
                "give a --max-pixel-error above 0, or leave out --lights");
  if (s.sampler != "guided") refuse_with("works with the sampler guided only", "leave out --sampler, or --lights");
  if (s.time_budget > 0.0) refuse_with("is given together with --time-budget", "give one of them");
}

std::string suns_text(const settings& s) {
  std::string text;
  for (const sun_setting& sun : s.suns)
    text += fmt::format("{}[{},{},{},{}]", text.empty() ? "" : ",", number(sun.from[0]), number(sun.from[1]),
                        number(sun.to[0]), number(sun.to[1]));
  return text.empty() ? text : fmt::format(R"(,"suns":[{}])", text);
}

std::string closed_text(const settings& s) {
  std::vector<std::string> names = s.closed;  // the same text in any order
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names.empty()
             ? std::string()
             : R"(,"closed":)" + nlohmann::json(names).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

const char* kind_of_cells(const settings& s) {
  if (!s.cells.empty()) return "given";
  if (s.cells_file) return "file";
  return s.cells_grid ? "grid" : "automatic";
}

}  // namespace

void validate_metric(const metric_settings& s) {
  if (static_cast<std::size_t>(s.kind) >= metric_names.size())
    refuse("--metric", number(static_cast<int>(s.kind)), "pixel, view or color");
  check<std::uint32_t>("--view-resolution", s.view_width, 16, 65536, " pixels");
  check<std::uint32_t>("--view-resolution", s.view_height, 16, 65536, " pixels");
  check("--view-fov", s.view_fov, 1.0, 170.0, " degrees");
  for (const double pitch : s.view_pitch) check("--view-pitch", pitch, -90.0, 90.0, " degrees");
  if (!(s.view_pitch[0] <= s.view_pitch[1]))
    refuse("--view-pitch", fmt::format("{},{}", s.view_pitch[0], s.view_pitch[1]), "the lower angle first");
  check("--view-least", s.view_least, 0.0, 1e6, "");
}

bool flies(const settings& s) {
  return !s.fly.empty() || s.path_file || !s.paths.empty();
}

void validate(const settings& s) {
  if (s.cells_file && s.cells_grid)
    throw error(error_kind::wrong_use, "settings.two-kinds-of-cells", "--cells-grid",
                "is given together with --cells-file", "give one of them");
  if (!s.cells.empty() && (s.cells_file || s.cells_grid))
    throw error(error_kind::wrong_use, "settings.two-kinds-of-cells", "settings.cells",
                "is given together with a file or a grid of cells", "give one of them");
  if (s.cells_grid) check_box("--cells-grid", *s.cells_grid);
  check("--cell-size", s.cell_size, 0.25f, 1000.0f, " m");
  check<std::uint32_t>("--most-cells", s.most_cells, 64, 1'000'000, "");
  check("--merge-cells", s.merge_cells, 0.0, 10.0, "");
  check_player(s);
  check_flight(s);
  check("--margin", s.margin, 0.0f, 10.0f, " m");
  check("--player-radius", s.player_radius, 0.001f, 1.0f, " m");
  check("--smallest-gap", s.smallest_gap, 0.0f, 0.1f, " m");
  check("--anisotropy", s.file.anisotropy, 1.0f, 16.0f, "");
  check_sampler(s);
  if (std::find(source_names.begin(), source_names.end(), s.source) == source_names.end())
    refuse_name("--source", s.source, source_names);
  check<std::uint32_t>("--resolution", s.resolution, 16, 4096, " pixels");
  if (s.resolution % 2 != 0) refuse("--resolution", number(s.resolution), "an even number, 16 to 4096");
  if (s.max_pixel_error != 0.0 && !(s.max_pixel_error >= 1e-7 && s.max_pixel_error <= 0.5))
    refuse("--max-pixel-error", number(s.max_pixel_error), "0 (no rays) or 1e-07 to 0.5");
  validate_metric(s.metric);
  check_two_scenes(s);
  check_time_budget(s);
  check_volumes(s);
  check_suns(s);
  check_lights(s);
  check_kept_records(s);
  if (static_cast<std::size_t>(s.animated) >= scene::animated_as_names.size())
    refuse("--animated", number(static_cast<int>(s.animated)), "always, rest or dynamic");
  if (static_cast<std::size_t>(s.safety_ring) >= safety_ring_names.size())
    refuse("--safety-ring", number(static_cast<int>(s.safety_ring)), "none, edge or vertex");
  if (static_cast<std::size_t>(s.file.profile) >= slack_profile_names.size())
    refuse("--profile", number(static_cast<int>(s.file.profile)), "exact, balanced or small");
  if (static_cast<std::size_t>(s.file.order) >= polygon_order_names.size())
    refuse("--order", number(static_cast<int>(s.file.order)), "per-mesh or per-instance");
  if (static_cast<std::size_t>(s.file.layout) >= host_layout_names.size())
    refuse("--layout", number(static_cast<int>(s.file.layout)), "instanced or merged");
  if (static_cast<std::size_t>(s.file.granularity) >= set_granularity_names.size())
    refuse("--granularity", number(static_cast<int>(s.file.granularity)), "polygon or cluster");
  if (s.file.layout == host_layout::merged && s.file.order != polygon_order_kind::per_mesh)
    refuse("--order", "per-instance",
           "per-mesh with --layout merged, where polygons of all draws of a material share an order");
}

std::string describe(const settings& s) {
  // The source is left out, because `auto` may be one of two; the bake adds the one it used (bake.cpp). The path of a
  // cells file is left out, because it has no effect and the file contains the boxes.
  std::string text = fmt::format(R"({{"cells":"{}")", kind_of_cells(s));
  if (s.cells_grid) {
    const std::array<float, 6>& g = *s.cells_grid;
    text += fmt::format(R"(,"cells_grid":[{},{},{},{},{},{}])", g[0], g[1], g[2], g[3], g[4], g[5]);
  }
  text += fmt::format(R"(,"cell_size":{},"cell_limit":{},"margin":{},"player_radius":{})", number(s.cell_size),
                      s.cell_limit, number(s.margin), number(s.player_radius));
  if (s.near && s.cell_limit > 0) text += fmt::format(R"(,"near":[{}])", fmt::join(*s.near, ","));
  text += player_text(s);
  text += fmt::format(R"(,"sampler":{},"samples":{},"resolution":{},"max_pixel_error":{},"seed":{})",
                      nlohmann::json(s.sampler).dump(), s.samples, s.resolution, number(s.max_pixel_error), s.seed);
  text += sampler_text(s);
  if (s.time_budget > 0.0) text += fmt::format(R"(,"time_budget":{})", number(s.time_budget));
  text += fmt::format(R"(,"all_double_sided":{})", s.all_double_sided);
  text += fmt::format(R"(,"smallest_gap":{})", number(s.smallest_gap));
  text += metric_text(s.metric);
  if (s.animated != scene::animated_as::always)
    text += fmt::format(R"(,"animated":"{}")", scene::animated_as_names[static_cast<std::size_t>(s.animated)]);
  text += closed_text(s);
  if (s.safety_ring != safety_ring::none)
    text += fmt::format(R"(,"safety_ring":"{}")", safety_ring_names[static_cast<std::size_t>(s.safety_ring)]);
  if (s.volumes != 0.0) text += fmt::format(R"(,"volumes":{})", number(s.volumes));
  text += suns_text(s);
  if (s.lights) text += R"(,"lights":true)";
  text += fmt::format(R"(,"profile":"{}")", slack_profile_names[static_cast<std::size_t>(s.file.profile)]);
  if (s.file.order != polygon_order_kind::per_mesh)
    text += fmt::format(R"(,"order":"{}")", polygon_order_names[static_cast<std::size_t>(s.file.order)]);
  if (s.file.layout != host_layout::instanced)
    text += fmt::format(R"(,"layout":"{}")", host_layout_names[static_cast<std::size_t>(s.file.layout)]);
  if (s.file.granularity != set_granularity::polygon)
    text += fmt::format(R"(,"granularity":"{}")", set_granularity_names[static_cast<std::size_t>(s.file.granularity)]);
  if (s.scene >= 0) text += fmt::format(R"(,"scene":{})", s.scene);
  if (s.cells_from != nullptr) text += fmt::format(R"(,"{}":"{}")", cells_from_member, fingerprint_text(*s.cells_from));
  text += "}";
  return text;
}

file_settings file_settings_of(std::string_view settings) {
  file_settings how{.profile = slack_profile::exact};
  const auto text = scene::parse_json(settings, false);
  if (!text.is_object()) return how;
  const auto named = [&](const char* key) {
    const auto found = text.find(key);
    return found != text.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  how.profile = kind_of<slack_profile>(slack_profile_names, named("profile")).value_or(how.profile);
  how.order = kind_of<polygon_order_kind>(polygon_order_names, named("order")).value_or(how.order);
  how.layout = kind_of<host_layout>(host_layout_names, named("layout")).value_or(how.layout);
  how.granularity = kind_of<set_granularity>(set_granularity_names, named("granularity")).value_or(how.granularity);
  return how;
}

}  // namespace sightcell::bake
