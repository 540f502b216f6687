// sightcell pack SCENE FILE.pvs -o PACKED.glb
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "console.h"
#include "exit_codes.h"
#include "number_text.h"
#include "pvs_file.h"
#include "sightcell/bake/pack.h"
#include "sightcell/scene/error.h"
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
  CLI::App& verb = *program.add_subcommand("pack", "write the world-space mesh that goes with a merged .pvs file");
  verb.add_option("SCENE", options->scene, ".glb or .gltf")->type_name("FILE")->required();
  verb.add_option("FILE", options->file, "the .pvs file baked from it with --layout merged")
      ->type_name("FILE.pvs")
      ->required();
  verb.add_option("-o", options->output, "the mesh: one list of vertices, one of indices in stored order")
      ->type_name("PACKED.glb")
      ->required();
  verb.add_flag("--json", options->json, "print one JSON object on standard output");
  verb.callback([options, &chosen] { chosen = [options] { return run_pack(*options); }; });
}

}  // namespace sightcell::cli
