#include "report/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "metric_options.h"
#include "number_text.h"
#include "report/html.h"
#include "report/page_parts.h"
#include "report/suggestions.h"

namespace sightcell::cli {
namespace {

using nlohmann::ordered_json;

std::string name_of(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  return slash == std::string::npos ? path : path.substr(slash + 1);
}

// A large number with a line below it.
std::string figure_of(const std::string& value, const std::string& text) {
  return fmt::format("<div><b>{}</b><span>{}</span></div>\n", value, escaped(text));
}

std::string times_fewer(double percent) {
  return percent > 0.0 ? fmt::format("{:.3g}", 100.0 / percent) : "-";
}

std::string verdict_of_bounds(const report_data& data) {
  const double asked = requested_bound(data);
  if (!(asked > 0.0))
    return "<span class=\"bad\">The bake was asked for no bound</span>, so nothing limits what the sets may lack.";
  const auto met = std::count_if(data.cells.begin(), data.cells.end(),
                                 [&](const report_cell& c) { return c.bounded() && c.bound <= asked; });
  const auto all = static_cast<std::ptrdiff_t>(data.cells.size());
  const std::string meaning =
      fmt::format("the probability that a random ray from the cell meets a polygon that its set lacks is at most {}",
                  probability_text(asked));
  if (met == all) return fmt::format("<span class=\"good\">All cells met their bound</span>: {}.", meaning);
  return fmt::format("<span class=\"bad\">{} of {} cells missed their bound</span>. In the others, {}.",
                     grouped(static_cast<std::uint64_t>(all - met)), grouped(data.cells.size()), meaning);
}

std::string verdict_of_verification(const report_data& data) {
  const double rays = number_at(data.verify, "rays"), misses = number_at(data.verify, "misses"),
               bound = number_at(data.verify, "upper_bound");
  if (!(rays > 0.0) || !std::isfinite(misses) || !std::isfinite(bound)) return "";
  const bool passed = bound <= number_at(data.verify, "max_pixel_error");
  return fmt::format(
      " <span class=\"{}\">Verification {}</span>: of {} independent rays, {} met a missing polygon, so the miss "
      "probability over all cells is at most {} ({:g} % confidence).",
      passed ? "good" : "bad", passed ? "passed" : "failed", value_of(data, "verify", "rays", grouped_text(rays)),
      value_of(data, "verify", "misses", grouped_text(misses)),
      value_of(data, "verify", "upper_bound", probability_text(bound)), 100.0 * number_at(data.verify, "confidence"));
}

std::string summary_of(const report_data& data) {
  const double percent = number_at(data.info, "visible_set_percent"),
               bits = number_at(data.info, "bits_per_visible_polygon");
  std::string out = fmt::format(
      "<p class=\"verdict\">From a view cell, {} of the {} polygons of this scene may be visible in the mean. The "
      "runtime "
      "draws those and skips the rest. {}{}</p>\n",
      percent_text(percent), value_of(data, "info", "polygons", grouped_text(number_at(data.info, "polygons"))),
      verdict_of_bounds(data), verdict_of_verification(data));
  out += "<div class=\"figures\">\n";
  out += figure_of(value_of(data, "info", "visible_set_percent", percent_text(percent)),
                   fmt::format("of all polygons in a set, {} times fewer", times_fewer(percent)));
  out += figure_of(value_of(data, "info", "cells", grouped_text(number_at(data.info, "cells"))), "view cells");
  out += figure_of(value_of(data, "info", "max_pixel_error", probability_text(number_at(data.info, "max_pixel_error"))),
                   "largest bound of a cell");
  out += figure_of(value_of(data, "info", "bytes",
                            bytes_text(static_cast<std::uint64_t>(std::max(number_at(data.info, "bytes"), 0.0)))),
                   "size of the file");
  out += figure_of(value_of(data, "info", "bits_per_visible_polygon", fmt::format("{:.3g}", bits)),
                   "bits per visible polygon");
  if (const double seconds = number_at(data.bake, "cpu_seconds"); std::isfinite(seconds))
    out += figure_of(value_of(data, "bake", "cpu_seconds", seconds_text(seconds)), "CPU time of the bake");
  return out + "</div>\n";
}

std::string next_steps(const report_data& data) {
  const std::vector<suggestion> list = suggestions_of(data);
  std::string out = "<h2>What to do next</h2>\n";
  if (list.empty()) return out + "<p>Nothing: the data has no sign of a problem.</p>\n";
  out += "<ol class=\"next\">\n";
  for (const suggestion& s : list) {
    out += fmt::format("<li><b>{}</b>{}", escaped(s.title), escaped(s.text));
    if (!s.command.empty()) out += command_html(s.command);
    out += "</li>\n";
  }
  return out + "</ol>\n";
}

}  // namespace

std::string report_page(const report_data& data) {
  const std::string scene = name_of(data.scene_path);
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>Visibility of {}</title>\n<style>{}</style>\n</head>\n<body>\n",
      escaped(scene), page_style);
  out += grounds_of(data);
  out += fmt::format("<main>\n<h1>Visibility of {}</h1>\n<p class=\"file\">Report on {}</p>\n", escaped(scene),
                     escaped(name_of(data.file_path)));
  out += summary_of(data);
  out += next_steps(data);
  for (const auto section : {views_section, bounds_section, growth_section, plans_section, time_section, file_section,
                             unseen_section, settings_section})
    out += section(data);
  return out + "</main>\n</body>\n</html>\n";
}

}  // namespace sightcell::cli
