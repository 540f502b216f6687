#include "report/page_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "number_text.h"
#include "report/charts.h"
#include "report/html.h"
#include "report/suggestions.h"
#include "unseen_report.h"

namespace sightcell::cli {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t listed_cells = 10, listed_objects = 15;
constexpr std::size_t histogram_bars = 24;

std::string count_text(double number) {
  return grouped_text(std::round(number));
}

std::string point_text(const std::array<float, 3>& at) {
  return fmt::format("{:.3f},{:.3f},{:.3f}", at[0], at[1], at[2]);
}

const ordered_json& member_of(const ordered_json& object, const char* key) {
  static const ordered_json none;
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() ? *found : none;
}

// A JSON value as plain text: strings without quotes.
std::string plain_text(const ordered_json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

std::vector<double> values_of(const report_data& data, double (*value)(const report_cell&)) {
  std::vector<double> values;
  for (const report_cell& c : data.cells) values.push_back(value(c));
  return values;
}

double polygons_in(const report_cell& c) {
  return static_cast<double>(c.polygons);
}

double bound_of(const report_cell& c) {
  return c.bounded() ? c.bound : std::nan("");
}

double seconds_of(const report_cell& c) {
  return c.seconds >= 0.0 ? c.seconds : std::nan("");
}

bool any_finite(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

// What colors cells: polygons, the bound, and seconds where they are known.
std::vector<cell_colors> colors_of_cells(const report_data& data) {
  std::vector<cell_colors> all{{"Polygons per cell", values_of(data, polygons_in), false, count_text},
                               {"Bound per cell", values_of(data, bound_of), true, probability_text},
                               {"Bake seconds per cell", values_of(data, seconds_of), true, seconds_text}};
  std::erase_if(all, [](const cell_colors& c) { return !any_finite(c.values); });
  return all;
}

std::string histogram_figure(const std::vector<double>& values, bool logarithmic, const std::string& title,
                             const number_text_of& text_of) {
  const std::string chart = histogram_svg(histogram_of(values, histogram_bars, logarithmic), title,
                                          logarithmic ? title + ", logarithmic" : title, text_of);
  return chart.empty() ? chart : "<figure>" + chart + "</figure>\n";
}

std::string picture_of(const std::string& uri, const std::string& caption, const std::string& alternative) {
  return fmt::format("<figure><img src=\"{}\" alt=\"{}\"><figcaption>{}</figcaption></figure>\n", uri,
                     escaped(alternative), escaped(caption));
}

std::string view_html(const report_data& data, const report_view& view, std::size_t number) {
  const double share =
      view.pixels > 0 ? 100.0 * static_cast<double>(view.differing_pixels) / static_cast<double>(view.pixels) : 0.0;
  std::string out =
      fmt::format("<article class=\"view\">\n<h3>{}. Cell {}: {}</h3>\n", number, view.cell,
                  view.differing_pixels == 0
                      ? std::string("no pixel differs")
                      : fmt::format("{} pixels differ ({})", grouped(view.differing_pixels), percent_text(share)));
  if (view.missing)
    out += fmt::format("<p class=\"note\">Polygon {} of {} is missing from the set.</p>\n", *view.missing,
                       view.node_name.empty() ? std::string("a node without a name")
                                              : "node \u201c" + escaped(view.node_name) + "\u201d");
  out += "<div class=\"triple\">\n" +
         picture_of(view.full, "All polygons", fmt::format("View {} with all polygons", number)) +
         picture_of(view.culled, grouped(view.drawn) + " polygons of the set",
                    fmt::format("View {} with the set", number)) +
         picture_of(view.difference, "Differing pixels in red", fmt::format("Difference of view {}", number)) +
         "</div>\n";
  return out + command_html(viewer_command(data, view)) + "</article>\n";
}

std::string largest_bounds(const report_data& data) {
  std::vector<std::uint32_t> order(data.cells.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return data.cells[a].bound > data.cells[b].bound; });
  order.resize(std::min(order.size(), listed_cells));
  std::string out =
      "<h3>Cells with the largest bounds</h3>\n<table>\n<thead><tr><th>cell</th><th "
      "class=\"n\">bound</th><th "
      "class=\"n\">misses</th><th class=\"n\">rays</th><th class=\"n\">polygons</th></tr></thead>\n";
  for (const std::uint32_t cell : order) {
    const report_cell& c = data.cells[cell];
    out += fmt::format(
        "<tr data-cell=\"{}\"><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td "
        "class=\"n\">{}</td><td "
        "class=\"n\">{}</td></tr>\n",
        cell, cell, c.bounded() ? probability_text(c.bound) : std::string("none"), grouped(c.misses), grouped(c.rays),
        grouped(c.polygons));
  }
  return out + "</table>\n";
}

std::string phases_html(const ordered_json& phases) {
  std::vector<bar> bars;
  if (phases.is_array())
    for (const ordered_json& one : phases) {
      const double seconds = number_at(one, "cpu_seconds");
      std::string name = plain_text(member_of(one, "phase"));
      std::replace(name.begin(), name.end(), '_', ' ');
      if (std::isfinite(seconds)) bars.push_back({name, seconds, seconds_text(seconds)});
    }
  return bars.empty() ? std::string() : "<h3>CPU time by phase</h3>\n" + bars_of(bars);
}

void add_row(std::vector<named_value>& rows, const std::string& name, double value, const std::string& text) {
  if (std::isfinite(value)) rows.emplace_back(name, escaped(text));
}

std::string left_out_html(const report_data& data) {
  const double empty = number_at(data.bake, "cells_left_out"), unreached = number_at(data.bake, "cells_unreached");
  if (!std::isfinite(empty)) return "";
  std::vector<named_value> rows{{"no valid viewpoint, or too few of them for a camera",
                                 value_of(data, "bake", "cells_left_out", grouped_text(empty))}};
  if (unreached > 0.0)
    rows.emplace_back("not reached before the time budget ended",
                      value_of(data, "bake", "cells_unreached", grouped_text(unreached)));
  return "<h3>Cells left out</h3>\n<p class=\"note\">Outside all cells, the runtime draws everything.</p>\n" +
         table_of(rows);
}

}  // namespace

std::string value_of(const report_data& data, std::string_view whose, const char* key, const std::string& text) {
  const ordered_json& object = whose == "info" ? data.info : whose == "verify" ? data.verify : data.bake;
  const ordered_json& value = member_of(object, key);
  return fmt::format("<span data-key=\"{}.{}\" data-value=\"{}\">{}</span>", whose, key,
                     escaped(value.dump(-1, ' ', false, ordered_json::error_handler_t::replace)), escaped(text));
}

double requested_bound(const report_data& data) {
  return number_at(member_of(data.info, "settings"), "max_pixel_error");
}

std::string grouped_text(double number) {
  return std::isfinite(number) && number >= 0.0 && number < 1e18 ? grouped(static_cast<std::uint64_t>(number)) : "-";
}

std::string viewer_command(const report_data& data, const report_view& view) {
  const double x = static_cast<double>(view.target[0]) - static_cast<double>(view.eye[0]),
               y = static_cast<double>(view.target[1]) - static_cast<double>(view.eye[1]),
               z = static_cast<double>(view.target[2]) - static_cast<double>(view.eye[2]);
  const double degrees = 180.0 / std::numbers::pi;
  return fmt::format("sightcell view {} {} --eye={} --look={:.2f},{:.2f} --frozen-from {} --mode tint",
                     shell_word(data.scene_path), shell_word(data.file_path), point_text(view.eye),
                     degrees * std::atan2(x, -z), degrees * std::atan2(y, std::hypot(x, z)), view.cell);
}

std::string grounds_of(const report_data& data) {
  return grounds_svg(data);
}

std::string views_section(const report_data& data) {
  std::string out = "<h2>Worst views</h2>\n";
  if (data.views.empty()) return out + fmt::format("<p>{}</p>\n", escaped(data.views_note));
  const auto differing = static_cast<std::size_t>(
      std::count_if(data.views.begin(), data.views.end(), [](const report_view& v) { return v.differing_pixels > 0; }));
  out += fmt::format(
      "<p>{} views were drawn: those of missing polygons, and from cells with the largest bounds. {}The command below "
      "each view opens the viewer there; what the set leaves out is red.</p>\n",
      data.views_tried,
      differing == 0 ? fmt::format("In none of them does a pixel differ; {} of them follow. ", data.views.size())
                     : fmt::format("These are the {} with the most wrong pixels. ", data.views.size()));
  for (std::size_t i = 0; i < data.views.size(); ++i) out += view_html(data, data.views[i], i + 1);
  return out;
}

std::string bounds_section(const report_data& data) {
  if (data.cells.empty()) return "<h2>Cells</h2>\n<p>The file has no cells.</p>\n";
  std::string out = "<h2>Cells and their bounds</h2>\n";
  double lowest = 1.0, highest = 0.0;
  for (const report_cell& c : data.cells) {
    if (!c.bounded()) continue;
    lowest = std::min(lowest, c.confidence);
    highest = std::max(highest, c.confidence);
  }
  if (highest > 0.0)
    out += fmt::format(
        "<p>A bound limits the miss probability of one cell. It holds with 95 % confidence or more: the confidences in "
        "the "
        "certificate are {:.4g} to {:.4g}, because a bake may test a cell several times. A bake stops casting rays as "
        "soon as "
        "the bound is met, so most bounds are just below the requested one.</p>\n",
        lowest, highest);
  out += "<div class=\"charts\">\n" +
         histogram_figure(values_of(data, polygons_in), false, "polygons per cell", count_text) +
         histogram_figure(values_of(data, bound_of), true, "bound per cell", probability_text) +
         histogram_figure(values_of(data, seconds_of), true, "bake seconds per cell", seconds_text) + "</div>\n";
  return out + largest_bounds(data) + left_out_html(data);
}

// The curve of the JSON of a bake, which may be from anywhere: points that are out of order or range are left out.
std::vector<curve_point> growth_curve(const report_data& data) {
  constexpr std::size_t most_points = 64;
  constexpr double most_hemicubes = 4294967295.0;
  std::vector<curve_point> points;
  const ordered_json& growth = member_of(data.bake, "growth");
  if (!growth.is_array()) return points;
  for (const ordered_json& entry : growth) {
    const double hemicubes = number_at(entry, "hemicubes"), share = number_at(entry, "share"),
                 cells = number_at(entry, "cells");
    const double after = points.empty() ? 0.0 : points.back().x;
    if (!(hemicubes >= 1.0 && hemicubes <= most_hemicubes && hemicubes > after)) continue;
    if (!(share >= 0.0 && share <= 1.0 && cells >= 0.0 && cells <= most_hemicubes)) continue;
    if (points.size() == most_points) break;
    points.push_back(
        {hemicubes, share,
         fmt::format("{} hemicubes: {} ({} cells have as many)", grouped(static_cast<std::uint64_t>(hemicubes)),
                     percent_text(100.0 * share), grouped(static_cast<std::uint64_t>(cells)))});
  }
  return points;
}

std::string growth_figure(const report_data& data) {
  const std::vector<curve_point> points = growth_curve(data);
  const std::string chart = curve_svg(points, "share of the sets that hemicubes found, by hemicubes per cell",
                                      "hemicubes per cell, logarithmic");
  if (chart.empty()) return "";
  // In words, because tooltips show on few screens and on no paper.
  const curve_point& middle = points[points.size() / 2];
  const auto number = [](const curve_point& p) { return grouped(static_cast<std::uint64_t>(p.x)); };
  return fmt::format(
      "<p>How many hemicubes the sets need: the first {} of each cell found {} of the polygons of all sets, the first "
      "{} "
      "found {}, and all of them, up to {} in a cell, found {}. Rays found the rest. Where the curve is flat at its "
      "end, "
      "further hemicubes would find little.</p>\n<div class=\"charts\"><figure>{}</figure></div>\n",
      points.front().x == 1.0 ? "hemicube" : number(points.front()), percent_text(100.0 * points.front().share),
      number(middle), percent_text(100.0 * middle.share), number(points.back()),
      percent_text(100.0 * points.back().share), chart);
}

std::string growth_section(const report_data& data) {
  const ordered_json& found = member_of(data.bake, "found_by");
  std::vector<bar> bars;
  for (const auto& [name, key] : {std::pair("hemicubes of the sampler", "sampler"),
                                  {"in all sets, or touching the cell", "touching"},
                                  {"rays toward what adjacent cells see", "adjacent_cells"},
                                  {"further hemicubes", "later_hemicubes"},
                                  {"rays beside visible polygons", "nearby_rays"},
                                  {"verification rays", "verification_rays"},
                                  {"misses that a host reported", "reported"}}) {
    const double share = number_at(found, key);
    if (!(share > 0.0)) continue;
    bars.push_back({name, share, percent_text(100.0 * share)});
  }
  if (bars.empty()) return "";
  return "<h2>How the sets grew</h2>\n<p>The steps of a cell, and the share of the polygons of all sets that each "
         "found "
         "first. Verification rays find what the search missed: where their share is large, the search stopped too "
         "early.</p>\n" +
         bars_of(bars) + growth_figure(data);
}

std::string plans_section(const report_data& data) {
  if (data.floors.empty()) return "";
  const std::vector<cell_colors> colors = colors_of_cells(data);
  std::string out = "<h2>Maps</h2>\n<p>A map of each floor. Right is +x, up is \u2212z. Black lines are walls.</p>\n";
  for (const cell_colors& c : colors) out += legend_html(c);
  for (std::size_t i = 0; i < data.floors.size(); ++i) {
    const report_floor& floor = data.floors[i];
    const std::string low = fmt::format("{:.1f}", floor.lowest), high = fmt::format("{:.1f}", floor.highest);
    out += fmt::format("<h3>Floor {} of {}: {} cells at a height of {} m</h3>\n<div class=\"plans\">\n", i + 1,
                       data.floors.size(), grouped(floor.cells.size()), low == high ? low : low + " to " + high);
    for (const cell_colors& c : colors) out += "<figure>" + plan_svg(data, i, c) + "</figure>\n";
    out += "</div>\n";
  }
  return out;
}

std::string time_section(const report_data& data) {
  if (!data.bake.is_object()) return "";
  std::vector<named_value> rows;
  const ordered_json& seconds = member_of(data.bake, "cell_seconds");
  if (const ordered_json& device = member_of(data.bake, "device"); device.is_string())
    rows.emplace_back("device", escaped(plain_text(device)));
  const double all = number_at(data.bake, "cpu_seconds");
  add_row(rows, "CPU time, all threads", all, seconds_text(all));
  if (number_at(seconds, "cells") > 0.0)
    for (const auto& [name, key] :
         {std::pair("median cell", "median"), {"99 % of cells, at most", "percentile_99"}, {"slowest cell", "longest"}})
      add_row(rows, name, number_at(seconds, key), seconds_text(number_at(seconds, key)));
  return "<h2>Time</h2>\n" + table_of(rows) + phases_html(member_of(data.bake, "phases"));
}

std::string file_section(const report_data& data) {
  std::vector<bar> bars;
  const double all = number_at(data.info, "bytes");
  if (const ordered_json& sections = member_of(data.info, "sections"); sections.is_array())
    for (const ordered_json& one : sections)
      if (const double size = number_at(one, "size"); std::isfinite(size))
        bars.push_back({plain_text(member_of(one, "name")), size,
                        fmt::format("{}, {}", bytes_text(static_cast<std::uint64_t>(std::max(size, 0.0))),
                                    percent_text(100.0 * size / all))});
  std::stable_sort(bars.begin(), bars.end(), [](const bar& a, const bar& b) { return a.value > b.value; });
  std::vector<named_value> rows;
  for (const auto& [name, key, form] : {std::tuple("polygons", "polygons", 0),
                                        {"draws", "draws", 0},
                                        {"ranges per cell", "ranges_per_cell", 1},
                                        {"slack, percent of the visible polygons", "false_visible_percent", 1},
                                        {"sets stored as differences, percent", "delta_row_percent", 1},
                                        {"visibility volumes", "volumes", 0}})
    if (const double value = number_at(data.info, key); std::isfinite(value))
      rows.emplace_back(name,
                        value_of(data, "info", key, form == 0 ? grouped_text(value) : fmt::format("{:.1f}", value)));
  return "<h2>The file</h2>\n" + bars_of(bars) + table_of(rows);
}

std::string unseen_section(const report_data& data) {
  if (!data.unseen) return "";
  const bake::unseen_polygons& u = *data.unseen;
  std::string out = "<h2>Unseen polygons</h2>\n";
  out += fmt::format("<p>{}. {}</p>\n", escaped(unseen_text(u)), escaped(unseen_bound_text(u.bound)));
  for (const std::string& warning : u.warnings)
    out += fmt::format("<p class=\"note\">Note: {}.</p>\n", escaped(warning));
  std::size_t listed = 0;
  for (; listed < std::min(u.objects.size(), listed_objects) && u.objects[listed].unseen > 0; ++listed) {
    const bake::unseen_object& o = u.objects[listed];
    if (listed == 0)
      out +=
          "<table>\n<thead><tr><th>object (glTF node)</th><th class=\"n\">unseen</th><th class=\"n\">polygons</th><th "
          "class=\"n\">share</th></tr></thead>\n";
    out += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
                       o.name.empty() ? fmt::format("node {}", o.node) : escaped(o.name), grouped(o.unseen),
                       grouped(o.polygons), percent_text(o.polygons > 0 ? 100.0 * o.unseen / o.polygons : 0.0));
  }
  if (listed == 0) return out;
  const auto with = static_cast<std::size_t>(
      std::count_if(u.objects.begin(), u.objects.end(), [](const bake::unseen_object& o) { return o.unseen > 0; }));
  out += "</table>\n";
  if (with > listed)
    out +=
        fmt::format("<p class=\"note\">{} more objects have unseen polygons; sightcell strip --report lists all.</p>\n",
                    grouped(with - listed));
  return out;
}

std::string settings_section(const report_data& data) {
  std::vector<named_value> rows{{"scene", escaped(data.scene_path)}, {"file", escaped(data.file_path)}};
  if (const ordered_json& print = member_of(data.info, "fingerprint"); print.is_string())
    rows.emplace_back("fingerprint of the scene", value_of(data, "info", "fingerprint", plain_text(print)));
  for (const auto& [name, key] :
       {std::pair("layout", "layout"), {"metric", "metric"}, {"format version", "format_version"}})
    if (const ordered_json& value = member_of(data.info, key); !value.is_null())
      rows.emplace_back(name, value_of(data, "info", key, plain_text(value)));
  if (const ordered_json& settings = member_of(data.info, "settings"); settings.is_object())
    for (const auto& [key, value] : settings.items()) {
      if (key == "layout" || key == "metric") continue;
      std::string name = key;
      std::replace(name.begin(), name.end(), '_', ' ');
      rows.emplace_back(name, escaped(plain_text(value)));
    }
  return "<h2>Settings</h2>\n" + table_of(rows);
}

}  // namespace sightcell::cli
