#include "report/write_report.h"

#include <fmt/format.h>

#include "number_text.h"
#include "report/page.h"
#include "report/suggestions.h"
#include "whole_file.h"

namespace sightcell::cli {

void write_report(const scene::scene& s, const scene::scene* cells_from, const pvs_file& file,
                  const report_request& request, progress_line& line) {
  const report_data data = collect_report(s, cells_from, file, request, line);
  const std::string page = report_page(data);
  write_whole_file(request.output, page);
  for (const suggestion& next : suggestions_of(data)) line.message("next: " + next.title);
  line.message(fmt::format("{}: a report of {}", request.output.string(), size_text(static_cast<double>(page.size()))));
}

}  // namespace sightcell::cli
