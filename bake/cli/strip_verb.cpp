// sightcell strip SCENE FILE.pvs -o OUT.glb
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
#include "sightcell/bake/strip.h"
#include "sightcell/base/error.h"
#include "unseen_report.h"
#include "verbs.h"

namespace sightcell::cli {

namespace {

constexpr std::size_t objects_on_terminal = 10;  // a report has all

struct strip_options {
  std::filesystem::path scene, file, output, report;
  bool json = false;
};

void print_objects(const bake::unseen_polygons& found) {
  for (std::size_t i = 0; i < std::min(found.objects.size(), objects_on_terminal); ++i) {
    const bake::unseen_object& o = found.objects[i];
    if (o.unseen == 0) return;
    fmt::print("  {:>10} of {:>10}   node {} \"{}\"\n", grouped(o.unseen), grouped(o.polygons), o.node, o.name);
  }
}

void refuse_overwriting(const strip_options& options) {
  const auto refuse = [](const std::filesystem::path& path, const char* what) {
    throw error(error_kind::wrong_use, "cli.output-is-input", path.string(), what, "choose another name");
  };
  std::error_code ignored;
  for (const std::filesystem::path& output : {options.output, options.report}) {
    if (std::filesystem::equivalent(options.scene, output, ignored)) refuse(output, "is the scene itself");
    if (std::filesystem::equivalent(options.file, output, ignored)) refuse(output, "is the .pvs file");
  }
  if (!options.output.empty() && std::filesystem::weakly_canonical(options.output, ignored) ==
                                     std::filesystem::weakly_canonical(options.report, ignored))
    refuse(options.report, "is both -o and --report");
}

// The report, and what was written.
nlohmann::ordered_json result_json(const strip_options& options, const bake::strip_result& result) {
  nlohmann::ordered_json text = unseen_json(result.unseen);
  const bool written = !options.output.empty();
  text["output"] = written ? nlohmann::ordered_json(options.output.string()) : nullptr;
  text["polygons_after"] = written ? nlohmann::ordered_json(result.polygons) : nullptr;
  text["bytes_before"] = written ? nlohmann::ordered_json(result.bytes_before) : nullptr;
  text["bytes"] = written ? nlohmann::ordered_json(result.bytes) : nullptr;
  return text;
}

void print_result(const strip_options& options, const bake::strip_result& result) {
  const bake::unseen_polygons& found = result.unseen;
  fmt::print("{}: {} of {}\n", options.scene.string(), unseen_text(found), options.file.string());
  print_objects(found);
  fmt::print("{}\n", unseen_bound_text(found.bound));
  if (options.output.empty()) return;
  const std::uint32_t left = found.unseen - (found.polygons - result.polygons);
  fmt::print("{}: {} polygons instead of {}, {} bytes instead of {}\n", options.output.string(),
             grouped(result.polygons), grouped(found.polygons), grouped(result.bytes), grouped(result.bytes_before));
  if (left > 0)
    fmt::print("{} unseen polygons stay: their triangles are seen in other instances, or their mesh stays whole\n",
               grouped(left));
}

int run_strip(const strip_options& options) {
  refuse_overwriting(options);
  outlive_failed_writes();
  const pvs_file file = pvs_file::open_or_embedded(options.file);
  const bake::strip_result result =
      bake::strip(options.scene, file.scene(), file.bytes(), options.file.string(), options.output);
  for (const std::string& warning : result.warnings) say_line("warning: " + warning);
  for (const std::string& warning : result.unseen.warnings) say_line("warning: " + warning);
  if (!options.report.empty()) write_unseen_report(result.unseen, options.report);
  if (options.json)
    fmt::print("{}\n",
               result_json(options, result).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  else
    print_result(options, result);
  return exit_done;
}

}  // namespace

void add_strip_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<strip_options>();
  CLI::App& verb = add_verb(
      program, "strip",
      {.summary = "Removes the polygons that are visible from no cell, or lists them",
       .usage = "SCENE FILE.pvs [-o OUT.glb] [options]",
       .description =
           "Finds the polygons that are in the set of no cell of a .pvs file (unseen polygons), object "
           "by object, and what the bounds of the cells state about them. With -o, writes the scene "
           "without them: a triangle goes when it is unseen in all instances of its mesh. In a file that was "
           "baked with --sun or --lights, polygons that shadows need are not unseen. Mirrors and collision may "
           "need what goes, so keep the scene.",
       .examples = {"sightcell strip level.glb level.pvs --report unseen.json",
                    "sightcell strip level.glb level.pvs -o stripped.glb"}});
  verb.add_option("SCENE", options->scene, "The scene that was baked: a .glb or .gltf file.")->required();
  verb.add_option("FILE", options->file,
                  "The .pvs file that was baked from it, or a scene that contains it (bake --embed).")
      ->required();
  verb.add_option("-o", options->output, "The .glb file to write. Without it: only finds unseen polygons.")
      ->type_name("OUT.glb");
  verb.add_option("--report", options->report, "Writes all objects and all unseen polygons to this file.")
      ->type_name("FILE.json");
  verb.add_flag("--json", options->json, "Prints the result as one JSON object on standard output.");
  verb.callback([options, &chosen] { chosen = [options] { return run_strip(*options); }; });
}

}  // namespace sightcell::cli
