#include "run_action.h"

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <new>

#include "console.h"
#include "exit_codes.h"
#include "sightcell/base/error.h"

namespace sightcell::cli {

namespace {

int code_of(error_kind kind) {
  switch (kind) {
    case error_kind::wrong_use:
      return exit_wrong_use;
    case error_kind::bad_input:
      return exit_bad_input;
    case error_kind::failed:
      break;
  }
  return exit_failed;
}

int run_or_explain(const action& chosen) {
  try {
    return chosen();
  } catch (const error& e) {
    print_error(e.what());
    return code_of(e.kind());
  } catch (const std::bad_alloc&) {
    print_error("memory: not enough for this scene; use a machine with more [cli.memory]");
  } catch (const std::exception& e) {
    if (std::ferror(stdout) != 0) return exit_failed;  // fmt throws what it could not print; said below
    print_error(fmt::format("unexpected: {}; please report it with the command [cli.unexpected]", e.what()));
  }
  return exit_failed;
}

}  // namespace

void print_error(const std::string& text) {
  say_line("sightcell: " + text);
}

int run(const action& chosen) {
  const int code = run_or_explain(chosen);
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  print_error("standard output: cannot be written; free the disk or name another file [cli.not-writable]");
  return exit_failed;
}

}  // namespace sightcell::cli
