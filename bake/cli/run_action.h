#pragma once
// The edge of the program: what goes wrong becomes one line on standard error and an exit code.
#include <string>

#include "verbs.h"

namespace sightcell::cli {

// "sightcell: text", on one line whatever the text holds.
void print_error(const std::string& text);

// Runs the verb and answers its exit code; what it throws is printed. Answers exit_failed, with a line, where standard
// output could not be written to the end.
int run(const action& chosen);

}  // namespace sightcell::cli
