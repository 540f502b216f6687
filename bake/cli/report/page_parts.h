#pragma once
// The sections of a report, from the views on. Each returns HTML; empty if the data has nothing for it.
#include <string>
#include <string_view>

#include "report/report_data.h"

namespace sightcell::cli {

// Returns an element with the text of a value, and the value itself for tools.
// whose: "info", "verify" or "bake": an object of the data. key: in it. text: plain.
std::string value_of(const report_data& data, std::string_view whose, const char* key, const std::string& text);

// Returns the bound that the bake was asked for; not a number if the settings have none.
double requested_bound(const report_data& data);

// Returns a whole number with separators; "-" if it is not finite or negative.
std::string grouped_text(double number);

// Returns the command that opens the viewer at a view, with the set of its cell: in the margin of a cell, the runtime has
// its set only for a camera that comes from there.
std::string viewer_command(const report_data& data, const report_view& view);

std::string grounds_of(const report_data& data);
std::string views_section(const report_data& data);
std::string bounds_section(const report_data& data);
std::string growth_section(const report_data& data);
std::string plans_section(const report_data& data);
std::string time_section(const report_data& data);
std::string file_section(const report_data& data);
std::string unseen_section(const report_data& data);
std::string settings_section(const report_data& data);

}  // namespace sightcell::cli
