#include "bake_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <optional>
#include <type_traits>
#include <variant>

#include "help.h"
#include "one_of.h"
#include "sightcell/bake/cells.h"
#include "sightcell/bake/sampler_options.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/camera_path.h"

namespace sightcell::cli {
namespace {

constexpr std::array<std::string_view, 3> progress_names{"auto", "json", "none"};

void add_output_options(CLI::App& verb, bake_options& o) {
  const char* const group = "Output";
  add_plain_option(verb, group, "-o", o.output, "FILE.pvs", "The file to write.")->required();
  add_option(verb, group, "--volumes", o.settings.volumes, "M",
             "Also computes which boxes of space are visible from each cell, so that a host can cull objects that "
             "move. Width of the boxes in meters; 0: none. Range: 0.25 to 1000.");
  add_plain_option(
      verb, group, "--sun", o.suns, "A,E[,A,E]",
      "Also finds the polygons whose shadow can fall into the view of a cell, for the shadow map of a sun: its "
      "azimuth in degrees, clockwise from north (-z), and its elevation above the horizon. With a second "
      "pair: a sun that moves from one place to the other. May be repeated.")
      ->take_all();
  verb.add_flag("--lights", o.settings.lights,
                "Also finds the polygons that each point and spot light of the scene reaches, for its shadow map, and "
                "which lights touch what is visible from a cell, for culling lights.")
      ->group(group);
  verb.add_flag("--importance", o.settings.file.importance,
                "Stores how large a part of the view from its cell each polygon covers, so that a host can load the "
                "largest polygons first.")
      ->group(group);
  add_plain_option(
      verb, group, "--report", o.report_file, "FILE.html",
      "Writes an HTML page about the bake and its file. sightcell report writes one about an existing file.");
}

void add_cell_options(CLI::App& verb, bake_options& o) {
  const char* const group = "Cells";
  bake::settings& s = o.settings;
  CLI::Option* file =
      add_plain_option(verb, group, "--cells-file", o.cells_file, "FILE.json",
                       "View cells from a file: {\"cells\": [{\"name\", \"min\", \"max\"}]}, in meters. Without this "
                       "option and --cells-grid, the bake places cells over the floors that a player can reach.");
  add_plain_option(verb, group, "--cells-grid", o.cells_grid, "x0,y0,z0,x1,y1,z1",
                   "All lattice cells that intersect this box. Meters, the lower corner first.")
      ->delimiter(',')
      ->expected(6)
      ->excludes(file);
  add_option(verb, group, "--reach", o.reach, "NAME",
             "Which floors get cells. walk: those that a player reaches from the starts by walking, jumping and "
             "falling. everywhere: all floors with head room, roofs too. none: no floor, with --fly or --path.")
      ->check(one_of(bake::reach_names));
  add_plain_option(verb, group, "--start", o.starts, "x,y,z",
                   "A point on or above a floor where a player begins, in meters; may be repeated. Default: the nodes "
                   "with extras.sightcell.start, else the cameras of the scene, else the largest floor.")
      ->take_all();
  add_plain_option(
      verb, group, "--fly", o.fly, "x0,y0,z0,x1,y1,z1",
      "Also places cells in this box, for a camera that flies: everywhere in it that is not solid. Meters, the "
      "lower corner first; may be repeated.")
      ->take_all();
  add_option(verb, group, "--cell-size", s.cell_size, "M",
             "Width of the smallest lattice cells in meters. Cells of a grid are half as high. Range: 0.25 to 1000.");
  add_option(verb, group, "--cell-limit", s.cell_limit, "N",
             "Bakes this many cells only, spread evenly over the scene, as a trial. 0: all cells.");
}

void add_quality_options(CLI::App& verb, bake_options& o) {
  const char* const group = "Quality";
  add_option(verb, group, "--quality", o.quality, "NAME",
             "Bound of the pixel error of each cell: draft (1e-3), normal (1e-4) or final (1e-5). The pixel error is "
             "the probability that a ray from a random valid viewpoint of the cell, in a random direction, meets a "
             "polygon that the set lacks. A smaller bound takes more time.")
      ->check(one_of(bake::quality_names));
  add_plain_option(verb, group, "--max-pixel-error", o.max_pixel_error, "E",
                   "Another bound than that of --quality. 0: no verification rays and no bound. Range: 1e-7 to 0.5. "
                   "Default: that of --quality.");
}

void add_rule_options(CLI::App& verb, bake_options& o) {
  const char* const group = "Scene rules";
  bake::settings& s = o.settings;
  add_option(verb, group, "--player-radius", s.player_radius, "M",
             "Meters that the camera keeps from every surface. Sets hold for viewpoints that keep it. Range: 0.001 to "
             "1.");
  add_option(verb, group, "--animated", o.animated, "NAME",
             "Draws that an animation or a skin moves, without a mark in the scene: always (in every set, occlude "
             "nothing), rest (static, in the pose of the file) or dynamic (left out; the host draws them).")
      ->check(one_of(scene::animated_as_names));
}

void add_machine_options(CLI::App& verb, bake_options& o) {
  const char* const group = "Time and machines";
  bake::settings& s = o.settings;
  add_option(
      verb, group, "--time-budget", s.time_budget, "S",
      "Wall-clock seconds for the whole bake, spent on the cells with the largest bounds. The bake ends earlier when "
      "all cells have the bound of --quality. The result depends on the machine. 0: no limit. Range: 0 to 1e7.");
  add_option(verb, group, "--threads", s.threads, "N", "Threads to use. 0: one per core. Changes no byte of the file.");
  add_plain_option(verb, group, "--shard", o.shard, "I/N",
                   "Bakes part I of N on this machine, with I from 0 to N - 1; sightcell merge joins the parts. array "
                   "and array/N take I from the job array of Slurm, Kubernetes or AWS Batch.")
      ->excludes("--report");
  verb.add_flag("--fresh", o.fresh, "Discards an unfinished bake of the same output instead of resuming it.")
      ->group(group);
}

void add_edit_options(CLI::App& verb, bake_options& o) {
  const char* const group = "Edits";
  verb.add_flag("--keep-records", o.settings.keep_records,
                "Writes the records of all cells beside the output (FILE.pvs.records), for --since.")
      ->group(group);
  add_plain_option(verb, group, "--since", o.settings.since, "OLD.pvs",
                   "Takes the cells that an edit of the scene cannot have changed from the records of an earlier bake "
                   "with --keep-records, and bakes the others. The sets are those of a full bake, but for rare "
                   "polygons. OLD.pvs may be the output itself. Includes --keep-records.")
      ->excludes("--shard");
  verb.get_option("--keep-records")->excludes("--shard");
  verb.add_flag(
          "--keep-found", o.settings.keep_found,
          "With --since or --watch --keep-records: cells that the edit can have changed start from the polygons that "
          "they had, and rays prove their bounds again. Faster than baking them anew. The sets are not those of a full "
          "bake: they may have polygons that the edit occludes.")
      ->group(group);
  verb.add_flag(
          "--keep-order", o.keep_order,
          "With --since or --watch --keep-records: polygons and draws that are still there keep the order that they "
          "have in OLD.pvs, so that a host keeps its index buffers. The order of a full bake makes smaller files.")
      ->group(group);
  verb.add_flag(
          "--watch", o.watch,
          "Keeps running and bakes again each time that the scene is saved: first a preview of the quality draft, "
          "then the quality that is asked for. A save during a bake ends it and begins the next one. Ctrl-C ends the "
          "command.")
      ->group(group)
      ->excludes("--shard", "--since", "--time-budget");
}

// ---- With --help-all only

void add_expert_output_options(CLI::App& verb, bake_options& o) {
  const char* const group = "Expert: output";
  add_option(verb, group, "--profile", o.profile, "NAME",
             "How many invisible polygons a set may have where that makes the file smaller: exact (none), balanced (up "
             "to 5 % of the visible ones) or small (up to 10 %). Pictures stay the same.")
      ->check(one_of(bake::slack_profile_names));
  add_option(verb, group, "--layout", o.layout, "NAME",
             "How the host stores its polygons: instanced (its own meshes, drawn one by one) or merged (in world "
             "space, all static draws of a material as one list).")
      ->check(one_of(bake::host_layout_names));
  verb.add_flag("--names", o.settings.file.names,
                "Stores a hash of the geometry of each draw and the names of its node and mesh, so that a host whose "
                "importer drops glTF numbers can find its objects, and notices a file of another scene.")
      ->group(group);
  verb.add_flag("--residency", o.settings.file.residency,
                "Stores the finest mip level of each texture that a picture from a cell can need, so that a host "
                "keeps only such levels in memory.")
      ->group(group);
  add_option(verb, group, "--anisotropy", o.settings.file.anisotropy, "N",
             "The largest anisotropy of the host's texture filter, for --residency; 1: a filter without. A larger one "
             "needs finer levels on surfaces that are seen at a slant. Range: 1 to 16.");
  add_plain_option(verb, group, "--report-unseen", o.unseen_file, "FILE.json",
                   "Writes the polygons that are in the set of no cell to this file, by object, the object with the "
                   "most first: they can be deleted, which sightcell strip does.")
      ->excludes("--shard");
  add_plain_option(verb, group, "--embed", o.embed_file, "SCENE",
                   "Also writes the scene with the result: a .glb contains the .pvs file, a .gltf names it. May be the "
                   "scene itself, but not with --watch.")
      ->excludes("--shard");
  add_option(verb, group, "--granularity", o.granularity, "NAME",
             "What sets consist of: polygon, or cluster (up to 128 triangles each, for hosts that draw meshlets). A "
             "cluster is in a set if any of its polygons is.")
      ->check(one_of(bake::set_granularity_names));
  add_option(verb, group, "--order", o.order, "NAME",
             "Which draws share a stored order of polygons: per-mesh (all instances of a mesh, which share an index "
             "buffer) or per-instance (none: fewer ranges, but the host needs an index buffer for each draw).")
      ->check(one_of(bake::polygon_order_names));
  add_option(
      verb, group, "--progress", o.progress, "NAME",
      "Progress on standard error: auto (a line that rewrites itself on a terminal, else one every ten seconds), "
      "json (one object per line) or none.")
      ->check(one_of(progress_names));
  verb.add_flag("--json", o.json, "Prints the summary as one JSON object on standard output.")->group(group);
  add_plain_option(verb, group, "--json-file", o.json_file, "FILE.json", "Writes the summary to this file too.");
}

void add_expert_scene_options(CLI::App& verb, bake_options& o) {
  const char* const group = "Expert: scenes";
  add_option(verb, group, "--smallest-gap", o.settings.smallest_gap, "M",
             "Light-leak tolerance in meters: gaps between polygons that are narrower let no line of sight through. "
             "Range: 0 to 0.1.");
  verb.add_flag("--all-double-sided", o.settings.all_double_sided,
                "All polygons are visible and occlude from both sides.")
      ->group(group);
  add_plain_option(
      verb, group, "--closed", o.settings.closed, "NAME",
      "A named group of the scene, such as a door, that occludes. The file is for hosts while that door is "
      "closed, beside a file without this option. May be repeated.")
      ->take_all();
  add_two_scene_options(verb, o.scenes, group);
  add_plain_option(verb, group, "--scene", o.settings.scene, "N",
                   "Number of the glTF scene in the file, from 0. Without it: the default scene of the file.")
      ->check(CLI::Range(0, INT32_MAX))
      ->excludes("--polygons-from");
  add_plain_option(verb, group, "--misses", o.misses_file, "FILE.json",
                   "Misses that a host reported: {\"misses\": [{\"eye\": [x, y, z], \"polygon\": 1234}]}. A polygon "
                   "joins the sets of the cells that the eye may be in if a ray from there hits it.");
}

void add_expert_cell_options(CLI::App& verb, bake_options& o) {
  const char* const group = "Expert: cells";
  bake::settings& s = o.settings;
  bake::player_settings& player = s.player;
  add_option(verb, group, "--most-cells", s.most_cells, "N",
             "Where the floors that a player can reach need more cells of --cell-size than this, cells are twice as "
             "wide, and so on, so that the bake of a large landscape ends. Range: 64 to 1000000.");
  add_option(verb, group, "--merge-cells", s.merge_cells, "G",
             "Merges cells side by side that see nearly the same polygons into wider ones, while the polygons that a "
             "player draws grow by about this part in the mean. Fewer cells bake sooner and make a smaller file. 0: "
             "all cells have the width of --cell-size. Range: 0 to 10.");
  add_plain_option(
      verb, group, "--near", o.near, "x,y,z|FILE.json",
      "With --cell-limit: bakes the cells nearest to this point, in meters, instead of cells all over the "
      "scene. With --watch: the preview has the nearest cells, 64 if --cell-limit is not given. FILE.json: "
      "a path file, of which the last point counts at each save, as sightcell-viewer --camera-file "
      "writes it.");
  add_option(verb, group, "--margin", s.margin, "M",
             "Meters by which the bake grows each cell on all sides. The runtime keeps a cell while the camera is in "
             "the grown cell. Range: 0 to 10.");
  add_plain_option(verb, group, "--path", o.path_file, "FILE.json",
                   "Space around the path of a camera gets cells too: {\"path\": [[x, y, z], ...]}, in meters; "
                   "\"paths\" has a list of paths.");
  add_option(verb, group, "--player-height", player.height, "M",
             "Meters that must be empty above a floor. Range: 0.1 to 100.");
  add_option(verb, group, "--player-step", player.step, "M",
             "Height of a step that a player climbs without a jump, in meters. Range: 0 to 100.");
  add_option(verb, group, "--player-jump", player.jump, "M",
             "Height that a player reaches with a jump, in meters. Range: 0 to 100.");
  add_option(verb, group, "--player-gap", player.gap, "M",
             "The widest gap that a player crosses with a jump, in meters. Range: 0 to 100.");
  add_option(verb, group, "--player-slope", player.slope, "D",
             "The steepest floor that a player can stand on, in degrees. Range: 0 to 89.");
  add_plain_option(verb, group, "--eye-heights", o.eye_heights, "LOW,HIGH",
                   "Heights of the camera above the floor that get cells, from crouching to jumping, in meters. "
                   "Range: 0 to 100. Default: 0.9,2.1.")
      ->delimiter(',')
      ->expected(2);
  add_plain_option(verb, group, "--path-camera", o.path_cameras, "NAME",
                   "A camera or node of the scene that animations move: its path, like one of --path. May be repeated.")
      ->take_all();
  add_option(verb, group, "--path-radius", o.settings.path_radius, "M",
             "How near to a path a cell is, on each axis, in meters. Range: 0 to 100.");
}

void add_expert_quality_options(CLI::App& verb, bake_options& o) {
  const char* const group = "Expert: quality";
  add_option(verb, group, "--safety-ring", o.safety_ring, "NAME",
             "Adds to each set, without a visibility test, the polygons that share an edge (edge) or a vertex (vertex) "
             "with a member: fewer misses, more polygons to draw. none: adds nothing.")
      ->check(one_of(bake::safety_ring_names));
}

std::string sentence(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text + ".";
}

void add_sampler_option(CLI::App& verb, const bake::sampler_option& option, bake::settings& s) {
  const char* const group = "Expert: sampling";
  const std::string whose = option.samplers.size() == bake::samplers().size()
                                ? std::string()
                                : fmt::format(" Samplers: {}.", fmt::join(option.samplers, ", "));
  std::visit(
      [&](auto member) {
        if constexpr (std::is_same_v<decltype(member), bool bake::settings::*>)
          verb.add_flag(option.name, s.*member, sentence(option.meaning) + whose)->group(group);
        else
          add_option(verb, group, option.name, s.*member, option.unit,
                     fmt::format("{} Range: {} to {}.{}", sentence(option.meaning), option.low, option.high, whose));
      },
      option.value);
}

void add_expert_sampling_options(CLI::App& verb, bake_options& o) {
  const char* const group = "Expert: sampling";
  bake::settings& s = o.settings;
  std::vector<std::string_view> names;
  for (const bake::sampler_info& one : bake::samplers()) names.emplace_back(one.name);
  add_option(verb, group, "--sampler", s.sampler, "NAME",
             fmt::format("The method that finds visible polygons: {}. guided is the one for releases; the others are "
                         "methods of the literature, to compare with. sightcell samplers describes them.",
                         fmt::join(names, ", ")));
  for (const bake::sampler_option& option : bake::sampler_options()) add_sampler_option(verb, option, s);
  add_option(verb, group, "--source", s.source, "NAME",
             "What renders hemicubes: gpu (OpenGL), cpu (a rasterizer on the CPU), rays (one ray per pixel, slow, to "
             "check the others) or auto (gpu on a machine with a hardware GPU, else cpu).");
  add_option(verb, group, "--resolution", s.resolution, "N",
             "Pixels along an edge of a hemicube face, an even number. Range: 16 to 4096.");
  add_option(verb, group, "--seed", s.seed, "N", "Seed of all random numbers.");
}

void add_expert_machine_options(CLI::App& verb, bake_options& o) {
  const char* const group = "Expert: machines";
  add_option(verb, group, "--memory", o.settings.memory, "BYTES",
             "Memory that the process may use: a number, or one with K, M or G (powers of 1024). 0: no limit. Changes "
             "no byte of the file.")
      ->transform(CLI::AsSizeValue(false));
  add_option(
      verb, group, "--phase", o.phase, "N",
      "Phase of a shard: 1 (sets and bounds), or 2 (the check with neighboring cells, once phase 1 of all shards "
      "is beside the output).")
      ->check(CLI::Range(1, 2))
      ->needs("--shard");
  add_plain_option(verb, group, "--scratch", o.settings.scratch, "FOLDER",
                   "A folder on a local disk for the unfinished bake. A copy is left beside the output every few "
                   "minutes and when the bake ends early. Without it: the unfinished bake is beside the output.");
}

template <class Kind, std::size_t Count>
Kind value_of(const std::array<std::string_view, Count>& names, const std::string& name) {
  return *bake::kind_of<Kind>(names, name);  // the parser has checked it
}

// Returns numbers that are given as "x,y,z".
// form: for the error, "x,y,z".
template <std::size_t Count>
std::array<float, Count> numbers_of(const char* option, const std::string& text, const char* form) {
  std::array<float, Count> numbers{};
  const std::vector<std::string> parts = CLI::detail::split(text, ',');
  bool good = parts.size() == Count;
  for (std::size_t i = 0; good && i < Count; ++i) good = CLI::detail::lexical_cast(parts[i], numbers[i]);
  if (!good)
    throw error(error_kind::wrong_use, "settings.out-of-range", option, "is \"" + text + "\"",
                fmt::format("give {} in meters", form));
  return numbers;
}

// Returns the sun that is given as "A,E" or "A,E,A,E".
bake::sun_setting sun_of(const std::string& text) {
  std::array<double, 4> numbers{};
  const std::vector<std::string> parts = CLI::detail::split(text, ',');
  bool good = parts.size() == 2 || parts.size() == 4;
  for (std::size_t i = 0; good && i < parts.size(); ++i) good = CLI::detail::lexical_cast(parts[i], numbers[i]);
  if (!good)
    throw error(error_kind::wrong_use, "settings.out-of-range", "--sun", "is \"" + text + "\"",
                "give AZIMUTH,ELEVATION in degrees, or two such pairs");
  const std::size_t last = parts.size() - 2;
  return {{numbers[0], numbers[1]}, {numbers[last], numbers[last + 1]}};
}

// Returns the point of --near. What writes its file may begin after a bake with --watch: until then there is no point.
std::optional<std::array<float, 3>> near_of(const bake_options& options) {
  if (options.near.empty()) return std::nullopt;
  const std::filesystem::path file = options.near;
  if (file.extension() != ".json") return numbers_of<3>("--near", options.near, "x,y,z");
  std::error_code ignored;
  if (options.watch && !std::filesystem::exists(file, ignored)) return std::nullopt;
  return bake::last_point(file);
}

}  // namespace

void add_cells_options(CLI::App& verb, bake_options& options) {
  add_scene_argument(verb, options.scenes, "The scene: a .glb or .gltf file, in meters.");
  add_cell_options(verb, options);
  add_quality_options(verb, options);
  add_expert_cell_options(verb, options);
  add_expert_quality_options(verb, options);
  add_two_scene_options(verb, options.scenes, "Expert: scenes");
  verb.add_flag("--json", options.json, "Prints the cells as one JSON object on standard output.");
}

void add_bake_options(CLI::App& verb, bake_options& options) {
  add_scene_argument(verb, options.scenes, "The scene to bake: a .glb or .gltf file, in meters.");
  add_output_options(verb, options);
  add_cell_options(verb, options);
  add_quality_options(verb, options);
  add_rule_options(verb, options);
  add_machine_options(verb, options);
  add_edit_options(verb, options);
  add_expert_output_options(verb, options);
  add_expert_cell_options(verb, options);
  add_expert_quality_options(verb, options);
  add_expert_scene_options(verb, options);
  add_metric_options(verb, options.metric, "Expert: metric");
  add_expert_sampling_options(verb, options);
  add_expert_machine_options(verb, options);
}

bake::settings settings_of(const bake_options& options) {
  bake::settings how = options.settings;
  how.reach = value_of<bake::reach_kind>(bake::reach_names, options.reach);
  for (const std::string& start : options.starts) how.starts.push_back(numbers_of<3>("--start", start, "x,y,z"));
  for (const std::string& box : options.fly) how.fly.push_back(numbers_of<6>("--fly", box, "x0,y0,z0,x1,y1,z1"));
  how.near = near_of(options);
  if (!options.near.empty() && !options.watch && how.cell_limit == 0)
    throw error(error_kind::wrong_use, "settings.out-of-range", "--near", "is given without --cell-limit and --watch",
                "give one of them too, or leave --near out");
  for (const auto& [option, given] : {std::pair("--keep-found", how.keep_found), {"--keep-order", options.keep_order}})
    if (given && how.since.empty() && !(options.watch && how.keep_records))
      throw error(error_kind::wrong_use, "settings.records", option,
                  "is given without --since and without --watch --keep-records",
                  "give one of them too, or leave it out");
  if (options.keep_order) how.order_from = how.since;
  for (const std::string& sun : options.suns) how.suns.push_back(sun_of(sun));
  if (!options.path_file.empty()) how.path_file = options.path_file;
  for (const std::string& name : options.path_cameras)
    for (scene::point_path& path :
         scene::camera_paths(options.scenes.two() ? options.scenes.cells_from : options.scenes.scene, name))
      how.paths.push_back(std::move(path));
  if (!options.eye_heights.empty()) {
    how.player.lowest_eye = options.eye_heights[0];
    how.player.highest_eye = options.eye_heights[1];
  }
  if (!options.cells_file.empty()) how.cells_file = options.cells_file;
  if (!options.misses_file.empty()) how.misses_file = options.misses_file;
  if (!options.cells_grid.empty()) {
    how.cells_grid.emplace();
    std::copy_n(options.cells_grid.begin(), how.cells_grid->size(), how.cells_grid->begin());
  }
  const auto quality = value_of<bake::quality>(bake::quality_names, options.quality);
  how.max_pixel_error =
      options.max_pixel_error.value_or(bake::max_pixel_error_of_quality[static_cast<std::size_t>(quality)]);
  how.metric = metric_of(options.metric);
  how.animated = *scene::animated_as_of(options.animated);
  how.safety_ring = *bake::safety_ring_of(options.safety_ring);
  how.file.profile = value_of<bake::slack_profile>(bake::slack_profile_names, options.profile);
  how.file.order = value_of<bake::polygon_order_kind>(bake::polygon_order_names, options.order);
  how.file.granularity = value_of<bake::set_granularity>(bake::set_granularity_names, options.granularity);
  how.file.layout = value_of<bake::host_layout>(bake::host_layout_names, options.layout);
  bake::validate(how);
  return how;
}

}  // namespace sightcell::cli
