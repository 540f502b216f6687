#pragma once
// The report as one HTML page.
#include <string>

#include "report/report_data.h"

namespace sightcell::cli {

// Returns a page that needs no other file, no network and no script. Values of info and verify are in elements with
// data-key ("info.cells") and data-value (the JSON value), beside the text that people read.
// data: cells, floors and views refer to each other by number, which is checked by the caller. JSON may have any shape:
//   what is missing is left out.
// The same data gives the same bytes.
std::string report_page(const report_data& data);

// The style of the page.
extern const char* const page_style;

}  // namespace sightcell::cli
