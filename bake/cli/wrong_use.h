#pragma once
// Messages for command lines that cannot be parsed.
#include <CLI/CLI.hpp>
#include <string>

namespace sightcell::cli {

// Returns the message for a failure of program.parse: the first unknown option or verb with the nearest right one, else
// the cause that the parser names; then which help to read, and the id.
std::string wrong_use_text(const CLI::App& program, const CLI::ParseError& failure);

}  // namespace sightcell::cli
