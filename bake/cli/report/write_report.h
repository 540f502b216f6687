#pragma once
// A report as a file.
#include "report/collect.h"

namespace sightcell::cli {

// Collects the data of a report, writes its page and prints its name.
// Parameters and failures are those of collect_report(); fails also with cli.not-writable.
void write_report(const scene::scene& s, const scene::scene* cells_from, const pvs_file& file,
                  const report_request& request, progress_line& line);

}  // namespace sightcell::cli
