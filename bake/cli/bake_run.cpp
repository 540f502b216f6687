#include "bake_run.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "bake_outputs.h"
#include "exit_codes.h"
#include "number_text.h"
#include "phase_times.h"
#include "pvs_file.h"
#include "report/write_report.h"
#include "safety_ring_text.h"
#include "sightcell/bake/unseen.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/embed.h"
#include "unseen_report.h"
#include "whole_file.h"

namespace sightcell::cli {
namespace {

// Null without --since.
nlohmann::ordered_json rebaked_json(const bake::summary& sum) {
  if (!sum.rebaked) return nullptr;
  return {{"cells", sum.rebaked->count()},
          {"changed_polygon", sum.rebaked->changed_polygon},
          {"something_new", sum.rebaked->something_new},
          {"neighbors", sum.rebaked->neighbors},
          {"started", sum.rebaked->started},
          {"new", sum.rebaked->is_new}};
}

nlohmann::ordered_json suns_json(const bake_options& options, const bake::summary& sum) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < sum.suns.size(); ++i)
    list.push_back({{"sun", options.suns[i]},
                    {"casters_per_cell", sum.suns[i].casters_per_cell},
                    {"max_upper_bound", sum.suns[i].max_upper_bound},
                    {"cells_over_bound", sum.suns[i].cells_over_bound},
                    {"rays", sum.suns[i].rays}});
  return list;
}

nlohmann::ordered_json lights_json(const bake::summary& sum) {
  if (!sum.lights) return nullptr;
  return {{"lights", sum.lights->lights},
          {"inside_solids", sum.lights->inside_solids},
          {"polygons_per_light", sum.lights->polygons_per_light},
          {"lights_per_cell", sum.lights->lights_per_cell},
          {"max_upper_bound", sum.lights->max_upper_bound},
          {"over_bound", sum.lights->over_bound},
          {"rays", sum.lights->rays}};
}

nlohmann::ordered_json found_json(const bake::found_shares& found) {
  return {{"sampler", found.sampler},
          {"touching", found.touching},
          {"adjacent_cells", found.adjacent_cells},
          {"later_hemicubes", found.later_hemicubes},
          {"nearby_rays", found.nearby_rays},
          {"verification_rays", found.verification_rays},
          {"reported", found.reported}};
}

nlohmann::ordered_json growth_json(const std::vector<bake::growth_point>& growth) {
  auto list = nlohmann::ordered_json::array();
  for (const bake::growth_point& point : growth)
    list.push_back({{"hemicubes", point.hemicubes}, {"share", point.share}, {"cells", point.cells}});
  return list;
}

nlohmann::ordered_json summary_json(const bake_options& options, const scene::scene& s, const bake::summary& sum,
                                    const phase_times& phases) {
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
          {"cells_rebaked", rebaked_json(sum)},
          {"visible_set_percent", sum.visible_percent},
          {"found_by", found_json(sum.found)},
          {"growth", growth_json(sum.growth)},
          {"metric", options.metric.metric},
          {"volumes", sum.volumes},
          {"volumes_per_cell", sum.volumes_per_cell},
          {"suns", suns_json(options, sum)},
          {"lights", lights_json(sum)},
          {"unseen_per_cell", sum.unseen_per_cell},
          {"unseen_percent", sum.unseen_percent},
          {"max_upper_bound", sum.max_upper_bound},
          {"cpu_seconds", sum.cpu_seconds},
          {"cell_seconds",
           {{"cells", sum.times.cells},
            {"median", sum.times.median},
            {"percentile_99", sum.times.percentile_99},
            {"longest", sum.times.longest},
            {"longest_center", sum.times.center}}},
          {"phases", phases.json()},
          {"bytes", sum.bytes},
          {"source", sum.source},
          {"device", sum.device},
          {"seed", options.settings.seed}};
}

std::string suns_text(const bake::settings& how, const bake::summary& sum, std::size_t number) {
  const bake::sun_setting& sun = how.suns[number];
  const bake::sun_summary& found = sum.suns[number];
  const std::string way = sun.from == sun.to ? "" : fmt::format(" to {:g},{:g}", sun.to[0], sun.to[1]);
  return fmt::format(
      "sun {:g},{:g}{}: {:.0f} casters per cell beside its set, largest bound of a cell's shadow error: "
      "{:.2e} (asked for {:g}), {} cells above it",
      sun.from[0], sun.from[1], way, found.casters_per_cell, found.max_upper_bound, how.max_pixel_error,
      grouped(found.cells_over_bound));
}

std::string lights_text(const bake::settings& how, const bake::light_summary& found) {
  return fmt::format(
      "{} lights: {:.0f} polygons per light, {:.2f} lights per cell, largest bound of a light's error: {:.2e} (asked "
      "for {:g}), {} lights above it",
      grouped(found.lights), found.polygons_per_light, found.lights_per_cell, found.max_upper_bound,
      how.max_pixel_error, grouped(found.over_bound));
}

std::string rebaked_text(const bake::rebaked_cells& cells, bool keep_found, double cpu_seconds) {
  return fmt::format(
      "{} again: {} of {} cells ({} saw what changed, {} could see something new, {} beside such cells, {} of an "
      "earlier --keep-found, {} new), {} of CPU time",
      keep_found ? "tested" : "baked", grouped(cells.count()), grouped(cells.count() + cells.kept),
      grouped(cells.changed_polygon), grouped(cells.something_new), grouped(cells.neighbors), grouped(cells.started),
      grouped(cells.is_new), duration_text(cpu_seconds));
}

// what: is in the checkpoint of the output, if there is one.
std::string stopped_text(const std::filesystem::path& output, std::string_view what) {
  const std::string checkpoint = output.string() + ".bake";
  std::error_code ignored;
  if (!std::filesystem::exists(checkpoint, ignored)) return "stopped before the first cell";
  return fmt::format("stopped: the same command resumes; {} are in {}", what, checkpoint);
}

int report_shard(const std::filesystem::path& target, const bake::summary& sum, progress_line& line) {
  if (sum.result == bake::outcome::cancelled) {
    line.message(stopped_text(target, "finished cells"));
    return exit_cancelled;
  }
  line.message(fmt::format("{}: {} cells ({} were there), {} of CPU time", target.string(), grouped(sum.cells),
                           grouped(sum.cells_resumed), duration_text(sum.cpu_seconds)));
  return exit_done;
}

// Without a limit of time there is one reason: the rays of a cell were spent.
std::string why_over_bound(const bake::settings& how, const bake::summary& sum) {
  if (how.time_budget == 0.0 && sum.cells_out_of_time == 0) return "";
  const std::uint32_t out_of_rays = sum.cells_over_bound - sum.cells_out_of_time;
  return fmt::format(", {} because {} was spent{}", grouped(sum.cells_out_of_time),
                     how.time_budget > 0.0 ? "--time-budget" : "--seconds-per-cell",
                     out_of_rays > 0 ? fmt::format(" and {} because their rays were", grouped(out_of_rays)) : "");
}

int report(const bake_options& options, const bake::settings& how, const bake::summary& sum, progress_line& line) {
  if (sum.result == bake::outcome::cancelled) {
    const char* const what = how.time_budget > 0.0 ? "cells and what they have come to" : "finished cells";
    line.message(stopped_text(options.output, what) +
                 (sum.bytes > 0 ? ", and " + options.output.string() + " holds them" : ""));
    return exit_cancelled;
  }
  line.message(fmt::format("{}: {} cells, {} bytes, {:.3f} % of all polygons visible per cell, {} of CPU time, seed {}",
                           options.output.string(), grouped(sum.cells), grouped(sum.bytes), sum.visible_percent,
                           duration_text(sum.cpu_seconds), how.seed));
  if (sum.rebaked) line.message(rebaked_text(*sum.rebaked, options.settings.keep_found, sum.cpu_seconds));
  if (sum.times.cells > 0)
    line.message(
        fmt::format("time per cell: median {:.2g} s, 99 % of cells at most {:.2g} s, slowest {:.2g} s (center {:.1f}, "
                    "{:.1f}, {:.1f})",
                    sum.times.median, sum.times.percentile_99, sum.times.longest, sum.times.center[0],
                    sum.times.center[1], sum.times.center[2]));
  if (sum.volumes > 0)
    line.message(fmt::format("{} volumes of {:g} m, {:.0f} seen per cell", grouped(sum.volumes), how.volumes,
                             sum.volumes_per_cell));
  if (how.safety_ring != bake::safety_ring::none) line.message(safety_ring_text(sum));
  for (std::size_t sun = 0; sun < sum.suns.size(); ++sun) line.message(suns_text(how, sum, sun));
  if (sum.lights && sum.lights->lights > 0) line.message(lights_text(how, *sum.lights));
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

void report_unseen(const bake_options& options, const scene::scene& s, progress_line& line) {
  const pvs_file file = pvs_file::open(options.output);
  const bake::unseen_polygons found = bake::find_unseen(s, file.bytes(), options.output.string());
  for (const std::string& warning : found.warnings) line.message("warning: " + warning);
  write_unseen_report(found, options.unseen_file);
  line.message(fmt::format("{}: {}", unseen_text(found), options.unseen_file.string()));
}

void report_on_page(const bake_options& options, const scene::scene& s, const scene::scene* of_cells,
                    const bake::summary& sum, const nlohmann::ordered_json& result, progress_line& line) {
  report_request request;
  request.scene = options.scenes.scene;
  request.file = options.output;
  request.output = options.report_file;
  request.bake = result;
  request.summary = &sum;
  write_report(s, of_cells, pvs_file::open(options.output), request, line);
}

}  // namespace

void embed(const bake_options& options, const bake_input& input, progress_line& line) {
  if (scene::load_gltf(options.scenes.scene, input.how.scene).fingerprint != input.s.fingerprint)
    throw error(error_kind::failed, "embed.scene-changed", options.scenes.scene.string(),
                fmt::format("was saved during the bake, so {} is not written; {} is of the version before",
                            options.embed_file.string(), options.output.string()),
                "run the same command again");
  const pvs_file file = pvs_file::open(options.output);
  const std::vector<std::byte> bytes =
      scene::with_embedded(options.scenes.scene, file.bytes(), options.output, options.embed_file);
  write_whole_file(options.embed_file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  line.message(fmt::format("{}: {} bytes, with the .pvs file", options.embed_file.string(), grouped(bytes.size())));
}

bake_input load_input(const bake_options& options, bake::settings how, progress_line& line) {
  const auto began = std::chrono::steady_clock::now();
  line.loading(options.scenes.scene);
  bake_input input{std::move(how), {}, {}};
  input.s = scene::load_gltf(options.scenes.scene, input.how.scene);
  if (input.how.file.residency) input.s.textures = scene::read_texture_uses(options.scenes.scene, input.s);
  for (const auto* warnings : {&input.s.warnings, &input.s.textures.warnings})
    for (const std::string& warning : *warnings) line.message("warning: " + warning);
  line.message(fmt::format("{}: {} polygons in {} draws", input.s.name, grouped(input.s.polygon_count),
                           grouped(input.s.draws.size())));
  input.of_cells = load_scene_of_cells(options.scenes, line);
  input.how.time_spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return input;
}

bake::summary bake_with_progress(const bake_input& input, bake::settings how, const std::filesystem::path& output,
                                 bool fresh, const bake::shard* part, progress_line& line,
                                 const std::function<bool()>& stop, phase_times* phases) {
  if (input.of_cells) how.cells_from = &*input.of_cells;
  bake::callbacks events;
  events.on_progress = [&](const bake::progress& now) {
    const bool stopped = stop();
    if (stopped)
      line.stopping(now);
    else if (now.phase != bake::bake_phase::finding_cells)  // it has nothing but its time, which the line shows
      line.update(now);
    return !stopped;
  };
  events.on_phase = [&](bake::bake_phase phase) {
    line.phase(phase);
    if (phases != nullptr) phases->begin(phase);
  };
  events.on_stopping = [&](const bake::progress& now) { line.stopping(now); };
  events.on_message = [&line](bake::severity how_bad, const std::string& text) {
    line.message(how_bad == bake::severity::warning ? "warning: " + text : text);
  };
  const bake::summary sum = part != nullptr ? bake::bake_shard(input.s, how, output, *part, fresh, events)
                                            : bake::bake(input.s, how, output, fresh, events);
  if (phases != nullptr) phases->end();
  line.end();
  return sum;
}

int bake_and_report(const bake_options& options, const bake_input& input, bake::settings how, bool fresh,
                    const bake::shard* part, progress_line& line, const std::function<bool()>& stop) {
  phase_times phases;
  const bake::summary sum = bake_with_progress(input, how, options.output, fresh, part, line, stop, &phases);
  const bool ended = sum.result != bake::outcome::cancelled;
  const int code = part != nullptr ? report_shard(bake::shard_file(options.output, *part), sum, line)
                                   : report(options, how, sum, line);
  if (!options.unseen_file.empty() && ended) report_unseen(options, input.s, line);
  if (!options.embed_file.empty() && ended) embed(options, input, line);
  const nlohmann::ordered_json result = summary_json(options, input.s, sum, phases);
  if (!options.report_file.empty() && ended)
    report_on_page(options, input.s, input.of_cells ? &*input.of_cells : nullptr, sum, result, line);
  const std::string text = result.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  if (!options.json_file.empty()) write_summary(options.json_file, text);
  if (options.json) fmt::print("{}\n", text);
  return code;
}

progress_mode progress_mode_of(const std::string& name) {
  if (name == "json") return progress_mode::json;
  return name == "none" ? progress_mode::none : progress_mode::automatic;
}

}  // namespace sightcell::cli
