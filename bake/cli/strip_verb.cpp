// sightcell strip SCENE FILE.pvs
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "console.h"
#include "exit_codes.h"
#include "help.h"
#include "number_text.h"
#include "pvs_file.h"
#include "sightcell/bake/unseen.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"
#include "unseen_report.h"
#include "verbs.h"

namespace sightcell::cli {

namespace {

constexpr std::size_t objects_on_terminal = 10;  // a report has all

struct strip_options {
  std::filesystem::path scene, file, report;
  bool json = false;
};

void print_objects(const bake::unseen_polygons& found) {
  for (std::size_t i = 0; i < std::min(found.objects.size(), objects_on_terminal); ++i) {
    const bake::unseen_object& o = found.objects[i];
    if (o.unseen == 0) return;
    fmt::print("  {:>10} of {:>10}   node {} \"{}\"\n", grouped(o.unseen), grouped(o.polygons), o.node, o.name);
  }
}

int run_strip(const strip_options& options) {
  std::error_code ignored;
  for (const std::filesystem::path& input : {options.scene, options.file})
    if (std::filesystem::equivalent(input, options.report, ignored))
      throw error(error_kind::wrong_use, "cli.output-is-input", options.report.string(), "is an input",
                  "choose another name");
  outlive_failed_writes();
  const pvs_file file = pvs_file::open(options.file);
  const scene::scene s = scene::load_gltf(options.scene, file.scene());
  const bake::unseen_polygons found = bake::find_unseen(s, file.bytes(), options.file.string());
  for (const std::string& warning : s.warnings) say_line("warning: " + warning);
  for (const std::string& warning : found.warnings) say_line("warning: " + warning);
  if (!options.report.empty()) write_unseen_report(found, options.report);
  if (options.json) {
    fmt::print("{}\n", unseen_json(found).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    return exit_done;
  }
  fmt::print("{}: {} of {}\n", options.scene.string(), unseen_text(found), options.file.string());
  print_objects(found);
  fmt::print("{}\n", unseen_bound_text(found.bound));
  return exit_done;
}

}  // namespace

void add_strip_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<strip_options>();
  CLI::App& verb =
      add_verb(program, "strip",
               {.summary = "Lists the polygons that are seen from no cell",
                .usage = "SCENE FILE.pvs [options]",
                .description = "Finds the polygons that are in the set of no cell of a .pvs file (unseen polygons), "
                               "object by object, and what the bounds of the cells state about them.",
                .examples = {"sightcell strip level.glb level.pvs",
                             "sightcell strip level.glb level.pvs --report unseen.json"}});
  verb.add_option("SCENE", options->scene, "The scene that was baked: a .glb or .gltf file.")->required();
  verb.add_option("FILE", options->file, "The .pvs file that was baked from it.")->required();
  verb.add_option("--report", options->report, "Writes all objects and all unseen polygons to this file.")
      ->type_name("FILE.json");
  verb.add_flag("--json", options->json, "Prints the result as one JSON object on standard output.");
  verb.callback([options, &chosen] { chosen = [options] { return run_strip(*options); }; });
}

}  // namespace sightcell::cli
