#pragma once
// What a user can do next, from the data of a report.
#include <span>
#include <string>
#include <vector>

#include "report/report_data.h"
#include "sightcell/bake/cell_views.h"

namespace sightcell::cli {

struct suggestion {
  std::string title, text;  // plain text
  std::string command;      // may be empty
};

inline constexpr std::size_t most_suggestions = 3;

// Returns what is most urgent first: missed bounds and misses, then cells that may be useless, then savings. Empty if
// there is nothing to do.
std::vector<suggestion> suggestions_of(const report_data& data);

// Counts the cells under the open sky in parts that are 2 m or more above cells of the largest part, and within 8 m of
// them in plan. A part is cells that are connected; two cells are where their boxes are within 0.3 m of each other.
// views: of cells, in any order. Cells without one are not counted.
raised_cells find_raised_cells(const std::vector<report_cell>& cells, std::span<const bake::cell_view> views);

// Returns a number of a JSON object; not a number if the object has none under this key.
double number_at(const nlohmann::ordered_json& object, const char* key);

// Returns a word of a command line for a POSIX shell: quoted if it has to be.
std::string shell_word(const std::string& word);

}  // namespace sightcell::cli
