#pragma once
// Pieces of an HTML page. Text of files and scenes enters the page through escaped() only.
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sightcell::cli {

// Returns a text for HTML, inside elements and quoted attributes. What is not valid UTF-8, and control characters that
// HTML does not allow, become U+FFFD.
std::string escaped(std::string_view text);

// Returns a probability or a share as people read it: "1.2e-5", and "-" if it is not finite.
std::string probability_text(double value);

// Returns a percentage: "31.4 %", "0.052 %", and "-" if it is not finite.
std::string percent_text(double percent);

// Returns seconds: "0.41 s", "12 s", "3 min 05 s", and "-" if it is not finite.
std::string seconds_text(double seconds);

// Returns bytes: "318 B", "130 KB", "1.4 MB".
std::string bytes_text(std::uint64_t bytes);

// Returns a command line as an element. Lines break between its words if they can.
std::string command_html(std::string_view command);

// A row of a table that names a value: its name, and its value as HTML.
using named_value = std::pair<std::string, std::string>;

// Returns a table of names and values. Names are escaped here, values by the caller.
std::string table_of(const std::vector<named_value>& rows);

// A bar of a list of bars.
struct bar {
  std::string name;    // escaped here
  double value = 0.0;  // 0 or more
  std::string text;    // of the value; escaped here
};

// Returns a list of bars, each as long as its value, with names and values as text. Values that are not finite count
// as 0.
std::string bars_of(const std::vector<bar>& bars);

}  // namespace sightcell::cli
