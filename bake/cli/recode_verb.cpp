// sightcell recode FILE.pvs and sightcell migrate FILE.pvs
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "exit_codes.h"
#include "help.h"
#include "number_text.h"
#include "one_of.h"
#include "progress_line.h"
#include "pvs_file.h"
#include "sightcell/bake/recode.h"
#include "sightcell/base/error.h"
#include "sightcell/format/layout.h"
#include "sightcell/scene/scene.h"
#include "stop_signals.h"
#include "verbs.h"

namespace sightcell::cli {

namespace {

struct recode_options {
  std::filesystem::path file, output;
  std::filesystem::path importance, residency, scene;  // the scene that options name, for one thing or the other
  float anisotropy = 16.0f;
  std::string profile, order, layout, granularity;
  bool names = false;
  bool json = false;
};

void report(const std::filesystem::path& output, const bake::recode_result& result, bool json) {
  if (json) {
    const nlohmann::ordered_json text{{"output", output.string()},
                                      {"format_version_before", result.version_before},
                                      {"format_version", format::layout::version},
                                      {"bytes_before", result.bytes_before},
                                      {"bytes", result.bytes},
                                      {"false_visible_percent", 100.0 * result.slack}};
    fmt::print("{}\n", text.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    return;
  }
  fmt::print("{}: {} -> {} bytes, format version {} -> {}, slack {:.2f} %\n", output.string(),
             grouped(result.bytes_before), grouped(result.bytes), result.version_before, format::layout::version,
             100.0 * result.slack);
}

// Returns the scene that options name; empty: none.
const std::filesystem::path& scene_of(const recode_options& options) {
  if (!options.importance.empty()) return options.importance;
  return options.residency.empty() ? options.scene : options.residency;
}

// Measuring importance takes a while.
int run_with_scene(const recode_options& options, const pvs_file& file, bake::recode_settings how,
                   const std::filesystem::path& output) {
  std::error_code ignored;
  const std::filesystem::path& path = scene_of(options);
  if (std::filesystem::equivalent(path, output, ignored))
    throw error(error_kind::wrong_use, "cli.output-is-input", output.string(), "is the scene itself",
                "choose another name");
  progress_line line(progress_mode::automatic);
  line.loading(path);
  scene::scene s = scene::load_gltf(path, file.scene());
  if (!options.residency.empty()) s.textures = scene::read_texture_uses(path, s);
  for (const auto* warnings : {&s.warnings, &s.textures.warnings})
    for (const std::string& warning : *warnings) line.message("warning: " + warning);
  const stop_signals signals;
  how.layout_from = &s;
  how.clusters_from = &s;
  if (options.names) how.names_from = &s;
  if (!options.importance.empty()) how.importance_in = &s;
  if (!options.residency.empty()) how.residency_of = &s;
  how.anisotropy = options.anisotropy;
  how.on_progress = [&](std::uint32_t done, std::uint32_t total) {
    line.update(bake::progress{
        .phase = how.importance_in ? bake::bake_phase::measuring_importance : bake::bake_phase::writing_file,
        .cells_done = total,
        .cells_total = total,
        .importance = static_cast<double>(done) / static_cast<double>(total)});
    return !signals.asked();
  };
  const bake::recode_result result = bake::recode(file.bytes(), options.file.string(), how, output);
  if (result.cancelled) {
    line.message("stopped: nothing was written");
    return exit_cancelled;
  }
  line.end();
  report(output, result, options.json);
  return exit_done;
}

int run_recode(const recode_options& options) {
  const pvs_file file = pvs_file::open(options.file);
  const std::filesystem::path& output = options.output.empty() ? options.file : options.output;
  bake::recode_settings how;
  if (!options.profile.empty())
    how.profile = bake::kind_of<bake::slack_profile>(bake::slack_profile_names, options.profile);
  if (!options.order.empty())
    how.order = bake::kind_of<bake::polygon_order_kind>(bake::polygon_order_names, options.order);
  if (!options.layout.empty()) how.layout = bake::kind_of<bake::host_layout>(bake::host_layout_names, options.layout);
  if (!options.granularity.empty())
    how.granularity = bake::kind_of<bake::set_granularity>(bake::set_granularity_names, options.granularity);
  if (!scene_of(options).empty()) return run_with_scene(options, file, how, output);
  report(output, bake::recode(file.bytes(), options.file.string(), how, output), options.json);
  return exit_done;
}

// A file of this version is left as it is.
int run_migrate(const recode_options& options) {
  const pvs_file file = pvs_file::open(options.file);
  const std::uint32_t version = file.content().format_version();
  if (version == format::layout::version && options.output.empty()) {
    const auto slack = static_cast<double>(file.content().facts().slack);
    report(options.file, {version, file.size(), file.size(), slack}, options.json);
    return exit_done;
  }
  return run_recode(options);
}

void add_common(CLI::App& verb, recode_options& o) {
  verb.add_option("FILE", o.file, "The .pvs file.")->required();
  verb.add_option("-o", o.output, "The file to write. Without it: FILE.")->type_name("FILE.pvs");
  verb.add_flag("--json", o.json, "Prints the result as one JSON object on standard output.");
}

}  // namespace

void add_recode_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<recode_options>();
  CLI::App& verb = add_verb(
      program, "recode",
      {.summary = "Changes the profile, order, layout or granularity of a .pvs file without a bake",
       .usage = "FILE.pvs [options]",
       .description = "Writes a .pvs file again in the current version of the format. Bounds still hold. FILE.pvs is "
                      "replaced unless -o is given.",
       .examples = {"sightcell recode level.pvs --profile small",
                    "sightcell recode level.pvs --layout merged --scene level.glb -o merged.pvs",
                    "sightcell recode level.pvs --granularity cluster --scene level.glb -o meshlets.pvs"}});
  add_common(verb, *options);
  verb.add_option(
          "--profile", options->profile,
          "How many invisible polygons a set may have where that makes the file smaller: exact (none), balanced "
          "(up to 5 % of the visible ones) or small (up to 10 %). It cannot shrink. Without it: as it is.")
      ->type_name("NAME")
      ->check(one_of(bake::slack_profile_names));
  CLI::Option* names = verb.add_flag("--names", options->names,
                                     "Stores a hash of the geometry of each draw and the names of its node and mesh, "
                                     "as bake --names does; needs --scene. "
                                     "Without it: the names in the file stay.");
  verb.add_option("--order", options->order,
                  "Computes the stored order of polygons again: per-mesh (all instances of a mesh share it) or "
                  "per-instance (each draw has its own). Without it: as it is.")
      ->type_name("NAME")
      ->check(one_of(bake::polygon_order_names));
  verb.add_option("--layout", options->layout,
                  "How the host stores its polygons: instanced (its own meshes, drawn one by one) or merged (in world "
                  "space, all static draws of a material as one list; needs --scene). Without it: as it is.")
      ->type_name("NAME")
      ->check(one_of(bake::host_layout_names));
  verb.add_option(
          "--granularity", options->granularity,
          "What sets consist of: cluster (up to 128 triangles each, for hosts that draw meshlets; needs --scene) "
          "or polygon. Clusters cannot become polygons again. Without it: as it is.")
      ->type_name("NAME")
      ->check(one_of(bake::set_granularity_names));
  CLI::Option* scene = verb.add_option("--scene", options->scene,
                                       "The scene that was baked, for --layout merged, --granularity and --names.")
                           ->type_name("SCENE");
  CLI::Option* importance =
      verb.add_option(
              "--importance", options->importance,
              "The scene that was baked: stores how large a part of the view from its cell each polygon covers. "
              "Serves as --scene too. Without it: the importance in the file stays.")
          ->type_name("SCENE")
          ->excludes(scene);
  CLI::Option* residency =
      verb.add_option("--residency", options->residency,
                      "The scene that was baked: stores the finest mip level of each texture that a picture from a "
                      "cell can need, as bake --residency does. Serves as --scene too. Without it: the levels in the "
                      "file stay.")
          ->type_name("SCENE")
          ->excludes(scene)
          ->excludes(importance);
  verb.add_option("--anisotropy", options->anisotropy,
                  "The largest anisotropy of the host's texture filter, for --residency. Range: 1 to 16. Default: 16.")
      ->type_name("N")
      ->check(CLI::Range(1.0, 16.0))
      ->needs(residency);
  names->needs(scene);
  verb.callback([options, &chosen] { chosen = [options] { return run_recode(*options); }; });
}

void add_migrate_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<recode_options>();
  CLI::App& verb = add_verb(
      program, "migrate",
      {.summary = "Brings a .pvs file of an older version of the format to the current one",
       .usage = "FILE.pvs [options]",
       .description = "Writes a .pvs file in the current version of the format, with the same cell sets. A file of the "
                      "current version is left as it is. FILE.pvs is replaced unless -o is given.",
       .examples = {"sightcell migrate old.pvs -o level.pvs"}});
  add_common(verb, *options);
  verb.callback([options, &chosen] { chosen = [options] { return run_migrate(*options); }; });
}

}  // namespace sightcell::cli
