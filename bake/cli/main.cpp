// The program `sightcell`: one verb per file, exit codes in exit_codes.h, messages on standard error.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <new>

#include "exit_codes.h"
#include "sightcell/scene/error.h"
#include "verbs.h"

namespace {

using namespace sightcell::cli;

int code_of(sightcell::error_kind kind) {
  switch (kind) {
    case sightcell::error_kind::wrong_use:
      return exit_wrong_use;
    case sightcell::error_kind::bad_input:
      return exit_bad_input;
    case sightcell::error_kind::failed:
      break;
  }
  return exit_failed;
}

int run(const action& chosen) {
  try {
    return chosen();
  } catch (const sightcell::error& e) {
    fmt::print(stderr, "sightcell: {}\n", e.what());
    return code_of(e.kind());
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "sightcell: memory: not enough for this scene; use a machine with more [memory]\n");
  } catch (const std::exception& e) {
    fmt::print(stderr, "sightcell: unexpected: {}; please report it with the command [unexpected]\n", e.what());
  }
  return exit_failed;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program("Sightcell: which polygons can be seen from where, baked ahead.", "sightcell");
  program.require_subcommand(1);
  program.set_version_flag("--version", SIGHTCELL_VERSION);
  program.get_formatter()->column_width(34);
  action chosen;
  add_bake_verb(program, chosen);
  add_info_verb(program, chosen);
  add_verify_verb(program, chosen);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return program.exit(e);  // --help, --version
    fmt::print(stderr, "sightcell: {}; see sightcell --help [cli.wrong-use]\n", e.what());
    return exit_wrong_use;
  }
  return run(chosen);
}
