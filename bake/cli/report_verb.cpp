// sightcell report FILE.pvs --scene SCENE -o FILE.html
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "console.h"
#include "exit_codes.h"
#include "help.h"
#include "progress_line.h"
#include "pvs_file.h"
#include "report/write_report.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/scene.h"
#include "verbs.h"

namespace sightcell::cli {

namespace {

struct report_options {
  report_request request;
  std::filesystem::path cells_from;
};

void refuse_overwriting(const report_options& options) {
  std::error_code ignored;
  const report_request& r = options.request;
  for (const std::filesystem::path& input : {r.scene, r.file, r.verify_file, r.bake_file, options.cells_from})
    if (std::filesystem::equivalent(input, r.output, ignored))
      throw error(error_kind::wrong_use, "cli.output-is-input", r.output.string(), "is also an input",
                  "choose another name");
}

int run_report(const report_options& options) {
  refuse_overwriting(options);
  outlive_failed_writes();
  const report_request& request = options.request;
  progress_line line(progress_mode::automatic);
  const pvs_file file = pvs_file::open_or_embedded(request.file);
  line.loading(request.scene);
  const scene::scene s = scene::load_gltf(request.scene, file.scene());
  for (const std::string& warning : s.warnings) line.message("warning: " + warning);
  std::optional<scene::scene> of_cells;
  if (!options.cells_from.empty()) of_cells = scene::load_gltf(options.cells_from);
  write_report(s, of_cells ? &*of_cells : nullptr, file, request, line);
  line.end();
  return exit_done;
}

}  // namespace

void add_report_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<report_options>();
  report_request& request = options->request;
  CLI::App& verb = add_verb(
      program, "report",
      {.summary = "Writes an HTML page about a .pvs file",
       .usage = "FILE.pvs --scene SCENE -o FILE.html [options]",
       .description = "Writes one HTML file that needs no network and no other file: what the file achieves in plain "
                      "words, what to do next, the worst views as pictures, bounds and sizes of the cells with maps, "
                      "unseen polygons by object, and what the bytes of the file are. Casts verification rays as "
                      "`sightcell verify` does, unless --verify names a result.",
       .examples = {"sightcell report level.pvs --scene level.glb -o report.html",
                    "sightcell report level.pvs --scene level.glb -o report.html --rays 0"}});
  const char* const group = "Options";
  verb.add_option("FILE", request.file, "The .pvs file, or a scene that contains it (bake --embed).")->required();
  add_plain_option(verb, group, "--scene", request.scene, "FILE", "The scene that was baked: a .glb or .gltf file.")
      ->required();
  add_plain_option(verb, group, "-o", request.output, "FILE.html", "The file to write.")->required();
  CLI::Option* verify = add_plain_option(verb, group, "--verify", request.verify_file, "FILE.json",
                                         "The result of `sightcell verify --json` for this file, instead of rays.");
  add_plain_option(verb, group, "--bake", request.bake_file, "FILE.json",
                   "The result of `sightcell bake --json` or --json-file for this file. It has what the file has not: "
                   "the time of the bake, and cells that were left out.");
  add_plain_option(verb, group, "--rays", request.rays, "N",
                   "Verification rays over all cells. 0: none. Default: that of `sightcell verify`.")
      ->excludes(verify);
  add_plain_option(verb, group, "--cells-from", options->cells_from, "SCENE",
                   "For a file with cells of another scene: that scene.");
  verb.callback([options, &chosen] { chosen = [options] { return run_report(*options); }; });
}

}  // namespace sightcell::cli
