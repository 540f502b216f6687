#pragma once
// What people and tools read beside the result: lines on standard error. That nobody reads them, or that the disk of
// the log is full, is no reason to end a bake of hours: failures are ignored.
#include <cstddef>
#include <string>

namespace sightcell::cli {

// Call before any file is opened. A standard stream that the caller has closed would leave its number to the next file
// that is opened, and messages would be written into that.
void occupy_standard_streams();

// From here on a pipe that nobody reads any more and a file above the user's limit are errors of the write, as a full
// disk is, and not the end of the process.
void outlive_failed_writes();

// Returns the width of the terminal on standard error; 80 if it is unknown.
std::size_t terminal_columns();

// As it is, at once.
void say(const std::string& text);

// One line, whatever the text holds: line ends and other control characters in names become spaces.
void say_line(const std::string& text);

}  // namespace sightcell::cli
