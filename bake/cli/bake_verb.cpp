// sightcell bake SCENE -o FILE.pvs
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>
#include <variant>

#include "console.h"
#include "exit_codes.h"
#include "metric_options.h"
#include "number_text.h"
#include "progress_line.h"
#include "safety_ring_text.h"
#include "scene_options.h"
#include "shard_option.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/sampler_options.h"
#include "sightcell/scene/error.h"
#include "sightcell/scene/scene.h"
#include "stop_signals.h"
#include "verbs.h"

namespace sightcell::cli {

namespace {

template <class Kind, std::size_t Count>
std::string name_of(const std::array<std::string_view, Count>& names, Kind kind) {
  return std::string(names[static_cast<std::size_t>(kind)]);
}

struct bake_options {
  scene_options scenes;
  std::filesystem::path output, json_file;
  std::filesystem::path cells_file, misses_file;
  std::vector<float> cells_grid;
  bake::settings settings;
  metric_options metric;
  bool fresh = false, json = false;
  std::string shard;
  std::uint32_t phase = 1;
  std::string progress = "auto", animated = std::string(scene::animated_as_names.front());
  std::string safety_ring = std::string(bake::safety_ring_names.front());
  std::string profile = name_of(bake::slack_profile_names, bake::settings().file.profile);
  std::string order = name_of(bake::polygon_order_names, bake::settings().file.order);
  std::string layout = name_of(bake::host_layout_names, bake::settings().file.layout);
};

progress_mode mode_of(const std::string& name) {
  if (name == "json") return progress_mode::json;
  return name == "none" ? progress_mode::none : progress_mode::automatic;
}

nlohmann::ordered_json summary_json(const bake_options& options, const scene::scene& s, const bake::summary& sum) {
  const char* const results[] = {"done", "bound_not_met", "cancelled"};
  return {{"result", results[static_cast<int>(sum.result)]},
          {"output", options.output.string()},
          {"polygons", s.polygon_count},
          {"cells", sum.cells},
          {"cells_left_out", sum.cells_left_out},
          {"cells_over_bound", sum.cells_over_bound},
          {"cells_out_of_time", sum.cells_out_of_time},
          {"cells_unreached", sum.cells_unreached},
          {"cells_resumed", sum.cells_resumed},
          {"visible_set_percent", sum.visible_percent},
          {"metric", options.metric.metric},
          {"volumes", sum.volumes},
          {"volumes_per_cell", sum.volumes_per_cell},
          {"unseen_per_cell", sum.unseen_per_cell},
          {"unseen_percent", sum.unseen_percent},
          {"max_upper_bound", sum.max_upper_bound},
          {"cpu_seconds", sum.cpu_seconds},
          {"bytes", sum.bytes},
          {"source", sum.source},
          {"device", sum.device},
          {"seed", options.settings.seed}};
}

[[noreturn]] void refuse_json_file(const std::filesystem::path& path) {
  throw error(error_kind::failed, "cli.not-writable", path.string(), "cannot be written",
              "choose a --json-file in a folder that exists and can be written");
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text << '\n';
  out.close();
  if (out) return;
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored))
    std::filesystem::remove(path, ignored);  // half of it helps nobody
  refuse_json_file(path);
}

// A file that the bake writes must not be one that it reads, or the other one that it writes.
void refuse_overwriting(const bake_options& options) {
  const auto refuse = [](const std::filesystem::path& output, const char* what) {
    throw error(error_kind::wrong_use, "cli.output-is-input", output.string(), what, "choose another name");
  };
  std::error_code ignored;
  for (const std::filesystem::path& output : {options.output, options.json_file}) {
    for (const std::filesystem::path& scene : {options.scenes.scene, options.scenes.cells_from})
      if (std::filesystem::equivalent(scene, output, ignored)) refuse(output, "is the scene itself");
    if (std::filesystem::equivalent(options.cells_file, output, ignored)) refuse(output, "is the cells file");
    if (std::filesystem::equivalent(options.misses_file, output, ignored)) refuse(output, "is the file of misses");
  }
  if (!options.json_file.empty() && std::filesystem::weakly_canonical(options.json_file, ignored) ==
                                        std::filesystem::weakly_canonical(options.output, ignored))
    refuse(options.json_file, "is both -o and --json-file");
}

// What could not be written after hours is refused before.
void refuse_bad_outputs(const bake_options& options) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::file_status there = fs::status(options.output, ignored);
  if (!options.output.has_filename() || (fs::exists(there) && !fs::is_regular_file(there)))
    throw error(error_kind::failed, "output.io", options.output.string(),
                fs::is_directory(there) ? "is a folder" : "names no file", "choose a file as -o");
  if (options.json_file.empty()) return;
  const fs::path folder = options.json_file.has_parent_path() ? options.json_file.parent_path() : fs::path(".");
  const bool exists = fs::exists(options.json_file, ignored);
  if (fs::is_directory(options.json_file, ignored) ||
      access(exists ? options.json_file.c_str() : folder.c_str(), W_OK) != 0)
    refuse_json_file(options.json_file);
}

int report_shard(const std::filesystem::path& target, const bake::summary& sum, progress_line& line) {
  if (sum.result == bake::outcome::cancelled) {
    line.message(fmt::format("stopped: the same command resumes; finished cells are in {}.bake", target.string()));
    return exit_cancelled;
  }
  line.message(fmt::format("{}: {} cells ({} were there), {} of CPU time", target.string(), grouped(sum.cells),
                           grouped(sum.cells_resumed), duration_text(sum.cpu_seconds)));
  return exit_done;
}

// Without a time budget there is one reason: a cell's rays were spent, or its seconds.
std::string why_over_bound(const bake::settings& how, const bake::summary& sum) {
  if (how.time_budget == 0.0) return "";
  const std::uint32_t out_of_rays = sum.cells_over_bound - sum.cells_out_of_time;
  return fmt::format(", {} because --time-budget was spent{}", grouped(sum.cells_out_of_time),
                     out_of_rays > 0 ? fmt::format(" and {} because their rays were", grouped(out_of_rays)) : "");
}

int report(const bake_options& options, const bake::settings& how, const bake::summary& sum, progress_line& line) {
  if (sum.result == bake::outcome::cancelled) {
    line.message(fmt::format("stopped: the same command resumes; {} are in {}.bake{}",
                             how.time_budget > 0.0 ? "cells and what they have come to" : "finished cells",
                             options.output.string(),
                             sum.bytes > 0 ? ", and " + options.output.string() + " holds them" : ""));
    return exit_cancelled;
  }
  line.message(fmt::format("{}: {} cells, {} bytes, {:.3f} % of all polygons visible per cell, {} of CPU time, seed {}",
                           options.output.string(), grouped(sum.cells), grouped(sum.bytes), sum.visible_percent,
                           duration_text(sum.cpu_seconds), how.seed));
  if (sum.volumes > 0)
    line.message(fmt::format("{} volumes of {:g} m, {:.0f} seen per cell", grouped(sum.volumes), how.volumes,
                             sum.volumes_per_cell));
  if (how.safety_ring != bake::safety_ring::none) line.message(safety_ring_text(sum));
  if (how.max_pixel_error > 0.0)
    line.message(fmt::format("largest bound of a cell's {}: {:.2e} (asked for {:g})", error_name(how.metric),
                             sum.max_upper_bound, how.max_pixel_error));
  if (sum.result == bake::outcome::bound_not_met) {
    line.message(fmt::format("{} of {} cells are above --max-pixel-error {:g}{}; the file is complete and says so",
                             grouped(sum.cells_over_bound), grouped(sum.cells), how.max_pixel_error,
                             why_over_bound(how, sum)));
    return exit_bound_not_met;
  }
  return exit_done;
}

int run_bake(bake_options options) {
  const auto began = std::chrono::steady_clock::now();
  bake::settings& how = options.settings;
  if (!options.cells_file.empty()) how.cells_file = options.cells_file;
  if (!options.misses_file.empty()) how.misses_file = options.misses_file;
  if (!options.cells_grid.empty()) {
    how.cells_grid.emplace();
    std::copy_n(options.cells_grid.begin(), how.cells_grid->size(), how.cells_grid->begin());
  }
  how.animated = *scene::animated_as_of(options.animated);
  how.metric = metric_of(options.metric);
  how.safety_ring = *bake::safety_ring_of(options.safety_ring);
  how.file.profile = *bake::kind_of<bake::slack_profile>(bake::slack_profile_names, options.profile);
  how.file.order = *bake::kind_of<bake::polygon_order_kind>(bake::polygon_order_names, options.order);
  how.file.layout = *bake::kind_of<bake::host_layout>(bake::host_layout_names, options.layout);
  bake::validate(how);  // before minutes of loading
  std::optional<bake::shard> part;
  if (!options.shard.empty()) {
    part = shard_of(options.shard, [](const char* name) -> const char* { return std::getenv(name); });
    part->phase = options.phase;
  }
  refuse_overwriting(options);
  refuse_bad_outputs(options);
  outlive_failed_writes();
  progress_line line(mode_of(options.progress));
  const scene::scene s = scene::load_gltf(options.scenes.scene, how.scene);
  for (const std::string& warning : s.warnings) line.message("warning: " + warning);
  line.message(fmt::format("{}: {} polygons in {} draws", s.name, grouped(s.polygon_count), grouped(s.draws.size())));
  const std::optional<scene::scene> of_cells = load_scene_of_cells(options.scenes, line);
  if (of_cells) how.cells_from = &*of_cells;

  how.time_spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  const stop_signals signals;
  bake::callbacks tell;
  tell.on_progress = [&](const bake::progress& now) {
    if (now.cells_per_second > 0.0 || now.cells_done > 0) line.update(now);
    return !signals.asked();
  };
  tell.on_message = [&line](bake::severity how_bad, const std::string& text) {
    line.message(how_bad == bake::severity::warning ? "warning: " + text : text);
  };
  const bake::summary sum = part ? bake::bake_shard(s, how, options.output, *part, options.fresh, tell)
                                 : bake::bake(s, how, options.output, options.fresh, tell);
  const int code =
      part ? report_shard(bake::shard_file(options.output, *part), sum, line) : report(options, how, sum, line);
  const std::string text =
      summary_json(options, s, sum).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  if (!options.json_file.empty()) write_text(options.json_file, text);
  if (options.json) fmt::print("{}\n", text);
  return code;
}

// Defaults come from bake::settings, so that help, code and documentation cannot differ.
template <typename T>
CLI::Option* add(CLI::App& verb, const char* name, T& value, const char* unit, const std::string& help) {
  return verb.add_option(name, value, help)->type_name(unit)->capture_default_str();
}

void add_cell_options(CLI::App& verb, bake_options& o) {
  bake::settings& s = o.settings;
  verb.add_option("--cells-file", o.cells_file, "explicit view cells, JSON: {\"cells\":[{\"name\",\"min\",\"max\"}]}")
      ->type_name("C.json")
      ->group("Cells");
  verb.add_option("--cells-grid", o.cells_grid, "every lattice cell of this box, metres")
      ->type_name("x0,y0,z0,x1,y1,z1")
      ->delimiter(',')
      ->expected(6)
      ->excludes("--cells-file")
      ->group("Cells");
  add(verb, "--cell-size", s.cell_size, "M", "width of automatic and grid cells, metres; half as high")->group("Cells");
  add(verb, "--cell-limit", s.cell_limit, "N", "bake only so many cells, spread evenly; 0: all")->group("Cells");
  add(verb, "--margin", s.margin, "M", "metres by which every cell is grown for the bake")->group("Cells");
}

void add_sampler_option(CLI::App& verb, const bake::sampler_option& option, bake::settings& s) {
  std::visit(
      [&](auto member) {
        if constexpr (std::is_same_v<decltype(member), bool bake::settings::*>)
          verb.add_flag(option.name, s.*member, option.meaning)->group("Sampling");
        else
          add(verb, option.name, s.*member, option.unit, option.meaning)->group("Sampling");
      },
      option.value);
}

void add_sampling_options(CLI::App& verb, bake_options& o) {
  bake::settings& s = o.settings;
  add(verb, "--sampler", s.sampler, "NAME", "what looks for visible polygons; see sightcell samplers")
      ->group("Sampling");
  for (const bake::sampler_option& option : bake::sampler_options()) add_sampler_option(verb, option, s);
  add(verb, "--time-budget", s.time_budget, "SECONDS",
      "on the clock for the whole bake, of guided: spent where the bound is largest, down to --max-pixel-error; what "
      "is found depends on the machine; 0: none")
      ->group("Sampling");
  add(verb, "--max-pixel-error", s.max_pixel_error, "E", "bound of the error of each cell; 0: no rays")
      ->group("Sampling");
  add_metric_options(verb, o.metric, "Sampling");
  add(verb, "--source", s.source, "NAME",
      "of hemicubes: gpu (OpenGL), cpu (our rasteriser), rays (to check the others, slow) or auto: gpu where there is "
      "a "
      "hardware one, else cpu")
      ->group("Sampling");
  add(verb, "--resolution", s.resolution, "S", "pixels along a hemicube face, even")->group("Sampling");
  add(verb, "--player-radius", s.player_radius, "M", "metres that eyes keep from every surface")->group("Seeing");
  add(verb, "--smallest-gap", s.smallest_gap, "M", "metres; narrower cracks let nothing through; 0: all do")
      ->group("Seeing");
  verb.add_flag("--all-double-sided", s.all_double_sided, "polygons are seen, and hide, from behind too")
      ->group("Seeing");
  const auto& names = scene::animated_as_names;
  add(verb, "--animated", o.animated, "HOW",
      "what animations or skins move and no mark speaks for: always (in every set, hides nothing), rest (static, as "
      "the file poses it) or dynamic (left out)")
      ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())))
      ->group("Seeing");
  const auto& rings = bake::safety_ring_names;
  add(verb, "--safety-ring", o.safety_ring, "HOW",
      "none, or edge or vertex: what shares one with a polygon of a cell's set joins it unless it faces away, seen or "
      "not; fewer misses for more that is drawn")
      ->check(CLI::IsMember(std::vector<std::string>(rings.begin(), rings.end())))
      ->group("Seeing");
  verb.add_option(
          "--misses", o.misses_file,
          "polygons that a host found missing, JSON: {\"misses\":[{\"eye\":[x,y,z],\"polygon\":1234}]}; they join "
          "the sets of the cells that the eye can be in where a ray sees them")
      ->type_name("FILE")
      ->group("Seeing");
}

void add_file_options(CLI::App& verb, bake_options& o) {
  add(verb, "--volumes", o.settings.volumes, "M",
      "also tell of boxes this wide, metres, where things that move may be, from which cells they can be seen; 0: none")
      ->group("File");
  const auto& profiles = bake::slack_profile_names;
  add(verb, "--profile", o.profile, "NAME",
      "exact, or balanced or small: polygons that nobody sees, 5 or 10 % of those that are seen at most, are in the "
      "sets "
      "of cells where that makes the file smaller and ranges fewer; pictures stay the same")
      ->check(CLI::IsMember(std::vector<std::string>(profiles.begin(), profiles.end())))
      ->group("File");
  const auto& orders = bake::polygon_order_names;
  add(verb, "--order", o.order, "HOW",
      "per-mesh: instances share an order of polygons, as they share an index buffer; per-instance: fewer ranges, but "
      "each draw needs an index buffer of its own")
      ->check(CLI::IsMember(std::vector<std::string>(orders.begin(), orders.end())))
      ->group("File");
  const auto& layouts = bake::host_layout_names;
  add(verb, "--layout", o.layout, "HOW",
      "of the host's polygons: instanced (draw by draw) or merged (in world space, static draws of one material as one "
      "list)")
      ->check(CLI::IsMember(std::vector<std::string>(layouts.begin(), layouts.end())))
      ->group("File");
  verb.add_flag("--importance", o.settings.file.importance,
                "put in the file how much of what is seen from its cell each polygon covers, for hosts that load the "
                "largest first")
      ->group("File");
}

void add_running_options(CLI::App& verb, bake_options& o) {
  add(verb, "--threads", o.settings.threads, "N", "0: all cores; changes no byte of the file")->group("Running");
  add(verb, "--memory", o.settings.memory, "B",
      "bytes of memory to keep under, K, M or G after the number: powers of 1024; 0: no limit; changes no byte of the "
      "file")
      ->transform(CLI::AsSizeValue(false))
      ->group("Running");
  add(verb, "--seed", o.settings.seed, "N", "of all random numbers")->group("Running");
  verb.add_flag("--fresh", o.fresh, "throw an unfinished bake away instead of resuming it")->group("Running");
  auto& shard =
      *verb.add_option(
               "--shard", o.shard,
               "bake only a part, for merge: i/n (i from 0), array (of Slurm, Kubernetes, AWS Batch) or array/n")
           ->type_name("i/n")
           ->group("Running");
  add(verb, "--phase", o.phase, "1|2", "of a shard: 2 reads what phase 1 of all shards left beside -o")
      ->check(CLI::Range(1, 2))
      ->needs(&shard)
      ->group("Running");
  verb.add_option("--scratch", o.settings.scratch,
                  "local folder for the unfinished bake; a copy is left beside -o when it ends early")
      ->type_name("DIR")
      ->group("Running");
  add(verb, "--progress", o.progress, "MODE", "auto, json or none; on standard error")
      ->check(CLI::IsMember({"auto", "json", "none"}))
      ->group("Running");
  verb.add_option("--json-file", o.json_file, "write the summary there")->type_name("PATH")->group("Running");
  verb.add_flag("--json", o.json, "print the summary as one JSON object on standard output")->group("Running");
}

}  // namespace

void add_bake_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<bake_options>();
  CLI::App& verb = *program.add_subcommand("bake", "bake the visibility of a scene; an interrupted bake resumes");
  add_scene_options(verb, options->scenes, "Cells");
  verb.add_option("-o", options->output, "the .pvs file to write")->type_name("FILE.pvs")->required();
  verb.add_option("--scene", options->settings.scene, "which scene of the file; without: its default")
      ->type_name("N")
      ->check(CLI::Range(0, INT32_MAX))
      ->excludes("--polygons-from");
  add_cell_options(verb, *options);
  add_sampling_options(verb, *options);
  add_file_options(verb, *options);
  add_running_options(verb, *options);
  verb.callback([options, &chosen] {
    settle_scenes(options->scenes);
    chosen = [options] { return run_bake(*options); };
  });
}

}  // namespace sightcell::cli
