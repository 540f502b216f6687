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
#include "number_text.h"
#include "progress_line.h"
#include "pvs_file.h"
#include "sightcell/bake/recode.h"
#include "sightcell/format/layout.h"
#include "sightcell/scene/error.h"
#include "sightcell/scene/scene.h"
#include "stop_signals.h"
#include "verbs.h"

namespace sightcell::cli {

namespace {

struct recode_options {
  std::filesystem::path file, output;
  std::filesystem::path importance, scene;  // the scene that options name, for one thing or the other
  std::string profile, order, layout;
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
  fmt::print("{}: {} -> {} bytes, format version {} -> {}, {:.2f} % of polygons drawn that nobody sees\n",
             output.string(), grouped(result.bytes_before), grouped(result.bytes), result.version_before,
             format::layout::version, 100.0 * result.slack);
}

// Measuring importance takes a while.
int run_with_scene(const recode_options& options, const pvs_file& file, bake::recode_settings how,
                   const std::filesystem::path& output) {
  std::error_code ignored;
  const std::filesystem::path& path = options.importance.empty() ? options.scene : options.importance;
  if (std::filesystem::equivalent(path, output, ignored))
    throw error(error_kind::wrong_use, "cli.output-is-input", output.string(), "is the scene itself",
                "choose another name");
  progress_line line(progress_mode::automatic);
  const scene::scene s = scene::load_gltf(path, file.scene());
  for (const std::string& warning : s.warnings) line.message("warning: " + warning);
  const stop_signals signals;
  how.layout_from = &s;
  if (!options.importance.empty()) how.importance_in = &s;
  how.on_progress = [&](std::uint32_t done, std::uint32_t total) {
    line.update(bake::progress{.cells_done = total,
                               .cells_total = total,
                               .importance = static_cast<double>(done) / static_cast<double>(total)});
    return !signals.asked();
  };
  const bake::recode_result result = bake::recode(file.bytes(), options.file.string(), how, output);
  if (result.cancelled) {
    line.message("stopped: nothing was written");
    return exit_cancelled;
  }
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
  if (!options.scene.empty() || !options.importance.empty()) return run_with_scene(options, file, how, output);
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
  verb.add_option("FILE", o.file, "the .pvs file; rewritten, but for -o")->type_name("FILE.pvs")->required();
  verb.add_option("-o", o.output, "write there instead")->type_name("FILE.pvs");
  verb.add_flag("--json", o.json, "print one JSON object on standard output");
}

}  // namespace

void add_recode_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<recode_options>();
  CLI::App& verb =
      *program.add_subcommand("recode", "write a .pvs file in another profile, order or layout, without a bake");
  add_common(verb, *options);
  const auto& profiles = bake::slack_profile_names;
  verb.add_option("--profile", options->profile, "slack of the sets: balanced 5 %, small 10 %; without: as it is")
      ->type_name("exact|balanced|small")
      ->check(CLI::IsMember(std::vector<std::string>(profiles.begin(), profiles.end())));
  const auto& orders = bake::polygon_order_names;
  verb.add_option("--order", options->order, "order polygons anew; without: as they are")
      ->type_name("per-mesh|per-instance")
      ->check(CLI::IsMember(std::vector<std::string>(orders.begin(), orders.end())));
  const auto& layouts = bake::host_layout_names;
  verb.add_option("--layout", options->layout,
                  "how the host keeps its polygons; merged needs --scene; without: as it is")
      ->type_name("instanced|merged")
      ->check(CLI::IsMember(std::vector<std::string>(layouts.begin(), layouts.end())));
  CLI::Option* scene =
      verb.add_option("--scene", options->scene, "the scene that the file was baked from")->type_name("SCENE");
  verb.add_option("--importance", options->importance,
                  "the scene that the file was baked from: put in the file how much of what is seen from its cell each "
                  "polygon covers; without: what it knows of that stays. Stands for --scene too")
      ->type_name("SCENE")
      ->excludes(scene);
  verb.callback([options, &chosen] { chosen = [options] { return run_recode(*options); }; });
}

void add_migrate_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<recode_options>();
  CLI::App& verb = *program.add_subcommand("migrate", "bring a .pvs file of an older version to this one; same sets");
  add_common(verb, *options);
  verb.callback([options, &chosen] { chosen = [options] { return run_migrate(*options); }; });
}

}  // namespace sightcell::cli
