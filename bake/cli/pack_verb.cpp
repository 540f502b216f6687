// sightcell pack SCENE FILE.pvs -o PACKED.glb
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "console.h"
#include "exit_codes.h"
#include "help.h"
#include "number_text.h"
#include "pvs_file.h"
#include "sightcell/bake/pack.h"
#include "sightcell/base/error.h"
#include "verbs.h"

namespace sightcell::cli {

namespace {

struct pack_options {
  std::filesystem::path scene, file, output;
  bool json = false;
};

void refuse_overwriting(const pack_options& options) {
  std::error_code ignored;
  for (const auto& [input, what] :
       {std::pair(options.scene, "is the scene itself"), {options.file, "is the .pvs file"}})
    if (std::filesystem::equivalent(input, options.output, ignored))
      throw error(error_kind::wrong_use, "cli.output-is-input", options.output.string(), what, "choose another name");
}

int run_pack(const pack_options& options) {
  refuse_overwriting(options);
  outlive_failed_writes();
  const pvs_file file = pvs_file::open(options.file);
  const bake::pack_result result =
      bake::pack(options.scene, file.scene(), file.bytes(), options.file.string(), options.output);
  for (const std::string& warning : result.warnings) say_line("warning: " + warning);
  if (options.json) {
    const nlohmann::ordered_json text{{"output", options.output.string()}, {"polygons", result.polygons},
                                      {"vertices", result.vertices},       {"groups", result.groups},
                                      {"moving", result.moving},           {"bytes", result.bytes}};
    fmt::print("{}\n", text.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    return exit_done;
  }
  fmt::print("{}: {} polygons, {} vertices, {} draw groups ({} that move), {} bytes\n", options.output.string(),
             grouped(result.polygons), grouped(result.vertices), grouped(result.groups), grouped(result.moving),
             grouped(result.bytes));
  return exit_done;
}

}  // namespace

void add_pack_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<pack_options>();
  CLI::App& verb = add_verb(
      program, "pack",
      {.summary = "Writes the mesh that goes with a .pvs file of the merged layout",
       .usage = "SCENE FILE.pvs -o PACKED.glb [options]",
       .description = "Writes the scene as one mesh in world space, with its triangles in the stored order of the .pvs "
                      "file: one vertex buffer, one index buffer, one node for each draw group.",
       .examples = {"sightcell bake level.glb -o level.pvs --layout merged",
                    "sightcell pack level.glb level.pvs -o packed.glb"}});
  verb.add_option("SCENE", options->scene, "The scene that was baked: a .glb or .gltf file.")->required();
  verb.add_option("FILE", options->file, "The .pvs file that was baked from it with --layout merged.")->required();
  verb.add_option("-o", options->output, "The .glb file to write.")->type_name("PACKED.glb")->required();
  verb.add_flag("--json", options->json, "Prints the result as one JSON object on standard output.");
  verb.callback([options, &chosen] { chosen = [options] { return run_pack(*options); }; });
}

}  // namespace sightcell::cli
