// The program `sightcell`: one verb per file, exit codes in exit_codes.h, messages on standard error.
#include <CLI/CLI.hpp>

#include "console.h"
#include "exit_codes.h"
#include "help.h"
#include "run_action.h"
#include "verbs.h"
#include "wrong_use.h"

using namespace sightcell::cli;

int main(int argc, char** argv) {
  occupy_standard_streams();
  CLI::App program(
      "Baked occlusion culling: computes which polygons of a glTF scene can be visible from each view cell, for the "
      "sightcell runtime to draw.",
      "sightcell");
  use_help_format(program);
  program.footer("sightcell VERB --help describes a verb and its options.");
  program.require_subcommand(1);
  program.set_version_flag("--version", SIGHTCELL_VERSION, "Prints the version.")->group("Help");
  action chosen;
  add_bake_verb(program, chosen);
  add_cells_verb(program, chosen);
  add_verify_verb(program, chosen);
  add_report_verb(program, chosen);
  add_view_verb(program, chosen);
  add_info_verb(program, chosen);
  add_diff_verb(program, chosen);
  add_patch_verb(program, chosen);
  add_recode_verb(program, chosen);
  add_migrate_verb(program, chosen);
  add_pack_verb(program, chosen);
  add_strip_verb(program, chosen);
  add_merge_verb(program, chosen);
  add_samplers_verb(program, chosen);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return program.exit(e);  // --help, --version
    print_error(wrong_use_text(program, e));
    return exit_wrong_use;
  }
  return run(chosen);
}
