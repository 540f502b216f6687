// sightcell verify SCENE FILE.pvs
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>
#include <utility>

#include "exit_codes.h"
#include "help.h"
#include "metric_options.h"
#include "number_text.h"
#include "progress_line.h"
#include "pvs_file.h"
#include "scene_options.h"
#include "sightcell/bake/misses.h"
#include "sightcell/bake/verify.h"
#include "sightcell/bake/verify_casters.h"
#include "sightcell/bake/verify_cut.h"
#include "sightcell/bake/verify_levels.h"
#include "sightcell/bake/verify_lights.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/object_levels.h"
#include "sightcell/scene/scene.h"
#include "verbs.h"
#include "verify_cut_result.h"
#include "verify_levels_result.h"
#include "verify_misses.h"
#include "verify_result.h"
#include "worst_view.h"

namespace sightcell::cli {

namespace {

using nlohmann::ordered_json;

constexpr std::size_t named_on_terminal = 10;  // missing polygons; --json has all that verify keeps

struct verify_options {
  scene_options scenes;
  std::filesystem::path file, picture, from;
  bool with_rays = true;  // --from, --cut and --levels take their place; with --from they can be asked for too
  bake::verify_settings how;
  metric_options metric;
  std::optional<std::uint64_t> rays;
  std::optional<double> max_pixel_error;  // without it: the bound that the bake was asked for
  double bound = 0.0;                     // the one that decides
  bool json = false;
  bool suns = false;    // the shadow casters too
  bool lights = false;  // likewise
  bake::cut_settings cut;
  bool cuts = false;    // levels of detail in place of the polygons of the sets
  bool levels = false;  // levels of detail of objects in their place
  double levels_fov = 60.0;
};

// Pictures are an aid: a machine that cannot draw still gets its numbers.
ordered_json try_worst_view(const scene::scene& s, const pvs_file& file, const std::vector<named_miss>& missing,
                            const verify_options& options, progress_line& line) {
  if (missing.empty()) return nullptr;
  ordered_json view = miss_json(missing.front());
  view["pictures"] = ordered_json::array();
  if (options.scenes.two()) {
    line.message("the worst view is not drawn: pictures are of one scene, and what hides is in the other one too");
    return view;
  }
  try {
    std::string prefix = options.file.string();
    if (!options.picture.empty()) {
      std::filesystem::create_directories(options.picture);
      prefix = (options.picture / options.file.filename()).string();
    }
    const worst_view drawn = draw_worst_view(s, file, missing.front().miss, prefix);
    for (const auto& path : drawn.pictures) view["pictures"].push_back(path.string());
    view["differing_pixels"] = drawn.differing_pixels;
    view["color_error"] = drawn.color_error;
    line.message(fmt::format("worst view: {} (culled, difference beside it), {} pixels differ",
                             drawn.pictures.front().string(), grouped(drawn.differing_pixels)));
  } catch (const error& e) {
    line.message(fmt::format("the worst view could not be drawn: {}", e.what()));
  } catch (const std::filesystem::filesystem_error& e) {
    line.message(fmt::format("the worst view could not be drawn: {}", e.what()));
  }
  return view;
}

void report(const bake::verification& v, const std::vector<named_miss>& missing, const verify_options& options,
            progress_line& line) {
  const std::string error = error_name(options.how.metric);
  for (std::size_t i = 0; i < std::min(missing.size(), named_on_terminal); ++i) {
    const named_miss& named = missing[i];
    line.message(fmt::format("missing: polygon {} (draw {}, node {} \"{}\") in cell {}: {} rays, {:.2e} of the cell's",
                             named.miss.polygon, named.draw, named.node, named.node_name, named.miss.cell,
                             named.miss.rays, named.share));
  }
  if (missing.size() > named_on_terminal)
    line.message(fmt::format("... and {} more (--json lists them)", missing.size() - named_on_terminal));
  if (const bake::cell_verification* worst = worst_cell(v))
    line.message(
        fmt::format("worst cell: {}, {} {:.2e}, at most {:.2e}", worst->cell, error, worst->error, worst->upper_bound));
  if (v.misses_of_volumes > 0)
    line.message(fmt::format("{} of the misses lack visibility volumes only", grouped(v.misses_of_volumes)));
  line.message(
      fmt::format("{}: {} misses of {} rays in {} cells; {} {:.2e}, at most {:.2e} ({:g} % sure); asked for {:g}",
                  v.upper_bound <= options.bound ? "passed" : "FAILED", grouped(v.misses), grouped(v.rays),
                  grouped(v.cells.size()), error, v.pixel_error, v.upper_bound, 100.0 * v.confidence, options.bound));
  if (v.upper_bound > options.bound && 3.0 / static_cast<double>(v.rays) > options.bound)
    line.message(fmt::format("{} rays are too few to prove {:g}: give --rays {} or more", grouped(v.rays),
                             options.bound, rays_for(options.bound)));
}

// Returns the result for --json, and whether the bound was met.
std::pair<ordered_json, bool> verify_with_rays(const scene::scene& s, const pvs_file& file,
                                               const verify_options& options, progress_line& line) {
  if (file.metric() != options.metric.metric)
    line.message(fmt::format("bounds in the file are of the {}, this measures the {}", error_name(file.metric()),
                             error_name(options.how.metric)));
  const bake::verification v =
      bake::verify(s, file.bytes(), options.file.string(), options.how,
                   [&line](std::uint32_t done, std::uint32_t total) { line.update(done, total); });
  std::vector<named_miss> missing;
  for (const bake::missing_polygon& miss : v.missing) missing.push_back(name_miss(s, v, miss));
  const ordered_json view = try_worst_view(s, file, missing, options, line);
  report(v, missing, options, line);
  return {verify_json(v, missing, view, {options.metric.metric, options.bound, options.how.seed}),
          v.upper_bound <= options.bound};
}

// Lists polygons beside those that cells lack. what: such a polygon; place: what it is missing for.
ordered_json list_missing(const scene::scene& s, const std::vector<bake::missing_polygon>& missing, const char* what,
                          const char* place, progress_line& line) {
  ordered_json list = ordered_json::array();
  for (std::size_t i = 0; i < missing.size(); ++i) {
    const bake::missing_polygon& miss = missing[i];
    const std::uint32_t draw = scene::draw_of(s, miss.polygon);
    const std::uint32_t node = s.draws[draw].node;
    const std::string node_name = node < s.node_names.size() ? s.node_names[node] : std::string();
    list.push_back({{place, miss.cell},
                    {"polygon", miss.polygon},
                    {"draw", draw},
                    {"node", node},
                    {"node_name", node_name},
                    {"rays", miss.rays},
                    {"eye", miss.eye},
                    {"target", miss.target}});
    if (i < named_on_terminal)
      line.message(fmt::format("missing {}: polygon {} (draw {}, node {} \"{}\") in {} {}: {} rays", what, miss.polygon,
                               draw, node, node_name, place, miss.cell, miss.rays));
  }
  return list;
}

// Returns the result for --json, and whether the bound was met for each sun.
std::pair<ordered_json, bool> verify_suns(const scene::scene& s, const pvs_file& file, const verify_options& options,
                                          progress_line& line) {
  const bake::caster_verification v =
      bake::verify_casters(s, file.bytes(), options.file.string(), options.how,
                           [&line](std::uint32_t done, std::uint32_t total) { line.update(done, total); });
  ordered_json result = {{"suns", ordered_json::array()}};
  bool passed = true;
  for (std::size_t sun = 0; sun < v.suns.size(); ++sun) {
    const bake::sun_verification& one = v.suns[sun];
    const bool met = one.upper_bound <= options.bound;
    line.message(
        fmt::format("{}: sun {}: {} rays of {} show a point without its shadow; at most {:.2e} ({:g} % sure); "
                    "asked for {:g}",
                    met ? "passed" : "FAILED", sun, grouped(one.misses), grouped(one.rays), one.upper_bound,
                    100.0 * v.confidence, options.bound));
    line.message(
        fmt::format("sun {}: with the sets alone {} of these rays would; {:.2f} % of all polygons drawn per cell, "
                    "{:.2f} % without casters",
                    sun, grouped(one.misses_of_sets), one.drawn_percent, one.set_percent));
    result["suns"].push_back({{"rays", one.rays},
                              {"misses", one.misses},
                              {"upper_bound", one.upper_bound},
                              {"misses_of_sets", one.misses_of_sets},
                              {"drawn_percent", one.drawn_percent},
                              {"set_percent", one.set_percent}});
    passed = passed && met;
  }
  result["missing"] = list_missing(s, v.missing, "caster", "cell", line);
  return {std::move(result), passed};
}

// Returns the result for --json, and whether the bound was met.
std::pair<ordered_json, bool> verify_levels_of(const scene::scene& s, const pvs_file& file,
                                               const verify_options& options, progress_line& line) {
  const scene::object_levels levels = scene::load_object_levels(options.scenes.scene, s, file.scene());
  const bake::level_verification v =
      bake::verify_levels(s, levels, file.bytes(), options.file.string(), options.how, options.levels_fov,
                          [&line](std::uint32_t done, std::uint32_t total) { line.update(done, total); });
  report_levels(v, s, options.bound, line);
  return {levels_json(v, s, options.bound), v.upper_bound <= options.bound};
}

// Likewise.
std::pair<ordered_json, bool> verify_lights(const scene::scene& s, const pvs_file& file, const verify_options& options,
                                            progress_line& line) {
  const bake::light_verification v =
      bake::verify_lights(s, file.bytes(), options.file.string(), options.how,
                          [&line](std::uint32_t done, std::uint32_t total) { line.update(done, total); });
  const bool met = v.lights == 0 || v.upper_bound <= options.bound;
  line.message(
      fmt::format("{}: {} lights: {} of {} rays meet a polygon that the set of the light lacks; at most {:.2e} ({:g} % "
                  "sure); asked for {:g}",
                  met ? "passed" : "FAILED", grouped(v.lights), grouped(v.misses), grouped(v.rays), v.upper_bound,
                  100.0 * v.confidence, options.bound));
  if (v.inside_solids > 0)
    line.message(fmt::format("{} further lights are inside solids and were not measured", grouped(v.inside_solids)));
  return {{{"lights", v.lights},
           {"inside_solids", v.inside_solids},
           {"rays", v.rays},
           {"misses", v.misses},
           {"upper_bound", v.upper_bound},
           {"missing", list_missing(s, v.missing, "polygon of a light", "light", line)}},
          met};
}

int run_verify(verify_options options) {
  options.how.metric = metric_of(options.metric);
  if (options.max_pixel_error && !(*options.max_pixel_error > 0.0 && *options.max_pixel_error <= 1.0))
    throw error(error_kind::wrong_use, "settings.out-of-range", "--max-pixel-error",
                fmt::format("is {}", *options.max_pixel_error), "give a number above 0, at most 1");
  if (options.rays == std::uint64_t{0})
    throw error(error_kind::wrong_use, "settings.out-of-range", "--rays", "is 0", "give at least 1");
  progress_line line(progress_mode::automatic);
  const pvs_file file = pvs_file::open_or_embedded(options.file);
  options.bound = options.max_pixel_error.value_or(file.requested_bound());
  options.how.rays = options.rays.value_or(std::max(options.how.rays, rays_for(options.bound)));
  line.loading(options.scenes.scene);
  const scene::scene s = scene::load_gltf(options.scenes.scene, file.scene());
  for (const std::string& warning : s.warnings) line.message("warning: " + warning);
  const std::optional<scene::scene> of_cells = load_scene_of_cells(options.scenes, line);
  if (of_cells) options.how.cells_from = &*of_cells;
  // First, because a file without casters or lights is refused.
  std::optional<std::pair<ordered_json, bool>> of_suns, of_lights;
  if (options.suns) of_suns = verify_suns(s, file, options, line);
  if (options.lights) of_lights = verify_lights(s, file, options, line);
  ordered_json result;
  bool passed = true;
  if (options.with_rays) std::tie(result, passed) = verify_with_rays(s, file, options, line);
  if (!options.from.empty()) {
    const bake::miss_check found =
        bake::check_misses(s, file.bytes(), options.file.string(), options.from, options.how,
                           [&line](std::uint32_t done, std::uint32_t total) { line.update(done, total); });
    report_misses(found, s, options.from.string(), line);
    passed = passed && found.reproduced == 0;
    result["passed"] = passed;
    result["from"] = misses_json(found, s);
  }
  if (options.cuts) {
    const std::vector<bake::cut_verification> cuts =
        bake::verify_cut(s, file.bytes(), options.file.string(), options.how, options.cut,
                         [&line](std::uint32_t done, std::uint32_t total) { line.update(done, total); });
    report_cuts(cuts, s, options.bound, line);
    for (const bake::cut_verification& cut : cuts) passed = passed && cut.upper_bound <= options.bound;
    result["passed"] = passed;
    result["cuts"] = cuts_json(cuts, s, options.bound);
  }
  if (options.levels) {
    std::tie(result["levels"], passed) = verify_levels_of(s, file, options, line);
    result["passed"] = passed;
  }
  if (of_suns) {
    passed = passed && of_suns->second;
    result["passed"] = passed;
    result["casters"] = std::move(of_suns->first);
  }
  if (of_lights) {
    passed = passed && of_lights->second;
    result["passed"] = passed;
    result["lights"] = std::move(of_lights->first);
  }
  if (options.json) fmt::print("{}\n", result.dump(2, ' ', false, ordered_json::error_handler_t::replace));
  return passed ? exit_done : exit_bound_not_met;
}

// A user who gives a bound and no rays would take silence for a bound that was met.
void refuse_options_of_rays(const CLI::App& verb) {
  for (const char* name : {"--cells", "--seed", "--max-pixel-error", "--metric", "--picture"})
    if (verb.get_option(name)->count() > 0)
      throw CLI::ValidationError(name, "is for rays, and --from takes their place unless --rays is given");
}

void add_level_options(CLI::App& verb, verify_options& options) {
  const char* const group = "Levels of detail";
  bake::cut_settings& cut = options.cut;
  CLI::Option* const pixels =
      add_plain_option(verb, group, "--cut", cut.pixels, "PIXELS",
                       "Measures what a host draws with levels of detail in clusters, in place of the sets alone: the "
                       "coarsest clusters with an error of up to this many pixels. Several numbers: separated by "
                       "commas. Counts misses by kind, and openings of the cut where level 0 is solid. "
                       "docs/meshlets.md has the rule.")
          ->delimiter(',')
          ->allow_extra_args(false);
  for (const char* other : {"--from", "--sun", "--lights", "--metric", "--cells-from"})
    pixels->excludes(verb.get_option(other));
  add_option(verb, group, "--cut-rows", cut.rows, "N", "Rows of the picture that has these pixels.")->needs(pixels);
  add_option(verb, group, "--cut-fov", cut.fov, "DEGREES", "Vertical field of view of this picture.")->needs(pixels);
  CLI::Option* const levels =
      verb.add_flag(
              "--levels", options.levels,
              "Measures what a host draws with levels of detail of objects (MSFT_lod, extras.sightcell.level_of), "
              "in place of the sets alone: of each object the level that its distance chooses. docs/levels.md has "
              "the rule.")
          ->group(group);
  for (const char* other : {"--from", "--sun", "--lights", "--metric", "--cells-from", "--cut"})
    levels->excludes(verb.get_option(other));
  add_option(verb, group, "--levels-fov", options.levels_fov, "DEGREES",
             "Vertical field of view of the picture that MSFT_screencoverage is about.")
      ->needs(levels);
}

}  // namespace

void add_verify_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<verify_options>();
  CLI::App& verb = add_verb(
      program, "verify",
      {.summary = "Measures the error of a .pvs file with independent rays",
       .usage = "SCENE FILE.pvs [options]",
       .description = "Casts verification rays from random valid viewpoints and counts those that hit a polygon which "
                      "the set of the cell lacks. Uses nothing of the bake but the file. Lists the missing polygons "
                      "and draws pictures of the worst view. Exit code 3: the upper bound of the error, at 95 % "
                      "confidence, is above --max-pixel-error.",
       .examples = {"sightcell verify level.glb level.pvs",
                    "sightcell verify level.glb level.pvs --rays 10000000 --json"}});
  const char* const group = "Options";
  add_scene_argument(verb, options->scenes, "The scene that was baked: a .glb or .gltf file.");
  verb.add_option("FILE", options->file,
                  "The .pvs file that was baked from it, or a scene that contains it (bake --embed).");
  add_plain_option(
      verb, group, "--rays", options->rays, "N",
      "Verification rays over all cells, the same number for each. Default: 1000000, or 10 / bound if that "
      "is more.");
  add_option(verb, group, "--cells", options->how.cells, "N",
             "Verifies this many cells, spread evenly over the file. 0: all cells.");
  add_plain_option(verb, group, "--max-pixel-error", options->max_pixel_error, "E",
                   "Bound of the error over all verified cells, above 0 and at most 1. Default: the bound that the "
                   "bake was asked for, or 1e-4 if it was asked for none.");
  add_plain_option(verb, group, "--from", options->from, "FILE.json",
                   "Tries misses that a host reported instead of random rays: {\"misses\": [{\"eye\": [x, y, z], "
                   "\"polygon\": 1234}]}. Exit code 3: a polygon is visible from its eye and missing in a set. With "
                   "--rays, random rays are cast too.");
  verb.add_flag("--sun", options->suns,
                "Verifies the shadow casters too, for each sun that the file was baked with: counts rays that show a "
                "point without its shadow, and lists the casters that are missing.")
      ->group(group);
  verb.add_flag("--lights", options->lights,
                "Verifies the lights too: counts rays from the lights that meet a polygon inside range and cone which "
                "the set of the light lacks, and lists the polygons that are missing.")
      ->group(group);
  add_plain_option(verb, group, "--picture", options->picture, "FOLDER",
                   "Folder for the pictures of the worst view. Default: the folder of FILE.");
  verb.add_flag("--json", options->json, "Prints the result as one JSON object on standard output.")->group(group);
  add_two_scene_options(verb, options->scenes, "Expert: scenes");
  add_metric_options(verb, options->metric, "Expert: metric");
  add_option(verb, "Expert: rays", "--seed", options->how.seed, "N", "Seed of the random numbers.");
  add_level_options(verb, *options);
  verb.callback([options, &chosen, &verb] {
    settle_scenes(options->scenes, &options->file);
    options->cuts = verb.get_option("--cut")->count() > 0;
    const bool in_place = options->cuts || options->levels;
    options->with_rays = !in_place && (options->from.empty() || verb.get_option("--rays")->count() > 0);
    if (!options->with_rays && !in_place) refuse_options_of_rays(verb);
    chosen = [options] { return run_verify(*options); };
  });
}

}  // namespace sightcell::cli
