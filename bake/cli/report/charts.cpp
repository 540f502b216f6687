#include "report/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "number_text.h"
#include "report/html.h"

namespace sightcell::cli {
namespace {

constexpr double least_spread = 0.02;  // logarithms: values within 5 % of each other count as one, as bounds often are
constexpr std::size_t most_titles = 2000;  // cells: beyond that, a plan is one shape per color, without tooltips

bool counts(double value, bool logarithmic) {
  return std::isfinite(value) && (!logarithmic || value > 0.0);
}

double place_of(double value, bool logarithmic) {
  return logarithmic ? std::log10(value) : value;
}

bool are_apart(double low, double high, bool logarithmic) {
  return logarithmic ? high - low > least_spread : high > low;
}

struct value_range {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  bool empty() const { return !(low <= high); }
};

value_range range_of(std::span<const double> values, bool logarithmic) {
  value_range range;
  for (const double value : values) {
    if (!counts(value, logarithmic)) continue;
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
  }
  return range;
}

std::string rectangle_path(const report_cell& cell) {
  return fmt::format("M{:.2f} {:.2f}H{:.2f}V{:.2f}H{:.2f}Z", cell.min[0], cell.min[2], cell.max[0], cell.max[2],
                     cell.min[0]);
}

double area_of(const report_cell& cell) {
  return (static_cast<double>(cell.max[0]) - static_cast<double>(cell.min[0])) *
         (static_cast<double>(cell.max[2]) - static_cast<double>(cell.min[2]));
}

// Cells of a floor: wide ones first, so that narrow ones inside them are visible.
std::vector<std::uint32_t> drawing_order(const report_data& data, const report_floor& floor) {
  std::vector<std::uint32_t> order = floor.cells;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return area_of(data.cells[a]) > area_of(data.cells[b]); });
  return order;
}

// The longest length of one digit and zeros that is at most a quarter of a width, in meters.
double bar_length_of(double width) {
  const double length = std::pow(10.0, std::floor(std::log10(std::max(width / 4.0, 1e-3))));
  for (const double factor : {5.0, 2.0})
    if (length * factor <= width / 4.0) return length * factor;
  return length;
}

}  // namespace

histogram histogram_of(std::span<const double> values, std::size_t intervals, bool logarithmic) {
  histogram h{.low = 0.0, .high = 0.0, .logarithmic = logarithmic, .counts = {}};
  const value_range range = range_of(values, logarithmic);
  if (range.empty()) return h;
  h.low = place_of(range.low, logarithmic);
  h.high = place_of(range.high, logarithmic);
  const bool apart = are_apart(h.low, h.high, logarithmic);
  h.counts.assign(apart ? intervals : 1, 0);
  const auto last = static_cast<double>(h.counts.size() - 1);
  for (const double value : values) {
    if (!counts(value, logarithmic)) continue;
    const double share = apart ? (place_of(value, logarithmic) - h.low) / (h.high - h.low) : 0.0;
    ++h.counts[static_cast<std::size_t>(
        std::clamp(std::floor(share * static_cast<double>(h.counts.size())), 0.0, last))];
  }
  return h;
}

std::string histogram_svg(const histogram& h, const std::string& title, const std::string& unit,
                          const number_text_of& text_of) {
  if (h.counts.empty()) return "";
  constexpr double left = 34.0, top = 8.0, width = 300.0, height = 96.0;
  const std::uint32_t most = *std::max_element(h.counts.begin(), h.counts.end());
  std::string out = fmt::format(
      "<svg class=\"chart\" viewBox=\"0 0 340 144\" role=\"img\" aria-label=\"{}\">\n<path class=\"grid\" d=\"M{} "
      "{}H{}\"/>\n"
      "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n<text x=\"{}\" y=\"{}\" text-anchor=\"end\">0</text>\n",
      escaped(title), left, top, left + width, left - 5.0, top + 4.0, grouped(most), left - 5.0, top + height + 4.0);
  // One value alone is a bar in the middle.
  const bool alone = h.counts.size() == 1;
  const double step = alone ? width / 8.0 : width / static_cast<double>(h.counts.size());
  const double begin = alone ? left + 0.5 * (width - step) : left;
  const auto value_at = [&](std::size_t i) {
    const double place = h.low + (h.high - h.low) * static_cast<double>(i) / static_cast<double>(h.counts.size());
    return h.logarithmic ? std::pow(10.0, place) : place;
  };
  for (std::size_t i = 0; i < h.counts.size(); ++i) {
    if (h.counts[i] == 0) continue;
    const double tall = std::max(height * h.counts[i] / most, 1.0);
    out += fmt::format(
        "<rect class=\"fill\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"><title>{} to {}: {} cells"
        "</title></rect>\n",
        begin + step * static_cast<double>(i) + 0.5, top + height - tall, step - 1.0, tall,
        escaped(text_of(value_at(i))), escaped(text_of(value_at(i + 1))), grouped(h.counts[i]));
  }
  out += fmt::format("<path class=\"axis\" d=\"M{} {}H{}\"/>\n", left, top + height, left + width);
  const double below = top + height + 15.0;
  if (alone)
    out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", left + 0.5 * width, below,
                       escaped(text_of(value_at(1))));
  else
    out += fmt::format("<text x=\"{}\" y=\"{}\">{}</text>\n<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n",
                       left, below, escaped(text_of(value_at(0))), left + width, below,
                       escaped(text_of(value_at(h.counts.size()))));
  return out + fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n</svg>\n", left + 0.5 * width,
                           below + 16.0, escaped(unit));
}

std::string curve_svg(std::span<const curve_point> points, const std::string& title, const std::string& unit) {
  if (points.size() < 2) return "";
  constexpr double left = 44.0, top = 8.0, width = 286.0, height = 112.0;
  const double low = std::log2(points.front().x), high = std::max(std::log2(points.back().x), low + 1e-9);
  const auto at = [&](const curve_point& p) {
    return std::pair(left + width * (std::log2(p.x) - low) / (high - low), top + height * (1.0 - p.share));
  };
  std::string out =
      fmt::format("<svg class=\"chart\" viewBox=\"0 0 340 160\" role=\"img\" aria-label=\"{}\">\n", escaped(title));
  for (const int percent : {50, 100})
    out += fmt::format("<path class=\"grid\" d=\"M{} {}H{}\"/>\n", left, top + height * (100 - percent) / 100.0,
                       left + width);
  for (const int percent : {0, 50, 100})
    out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{} %</text>\n", left - 6.0,
                       top + height * (100 - percent) / 100.0 + 4.0, percent);
  out += fmt::format("<path class=\"axis\" d=\"M{} {}H{}\"/>\n<path class=\"curve\" d=\"", left, top + height,
                     left + width);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [x, y] = at(points[i]);
    out += fmt::format("{}{:.2f} {:.2f}", i == 0 ? "M" : "L", x, y);
  }
  out += "\"/>\n";
  for (const curve_point& p : points) {
    const auto [x, y] = at(p);
    out += fmt::format("<circle class=\"fill\" cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"3\"><title>{}</title></circle>\n", x, y,
                       escaped(p.text));
  }
  const double below = top + height + 15.0;
  out += fmt::format("<text x=\"{}\" y=\"{}\">{}</text>\n<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n", left,
                     below, grouped(static_cast<std::uint64_t>(points.front().x)), left + width, below,
                     grouped(static_cast<std::uint64_t>(points.back().x)));
  return out + fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n</svg>\n", left + 0.5 * width,
                           below + 16.0, escaped(unit));
}

int color_step(double value, double low, double high, bool logarithmic) {
  if (!counts(value, logarithmic)) return -1;
  const double from = place_of(low, logarithmic), to = place_of(high, logarithmic);
  if (!are_apart(from, to, logarithmic)) return color_steps / 2;
  const double share = (place_of(value, logarithmic) - from) / (to - from);
  return std::clamp(static_cast<int>(share * color_steps), 0, color_steps - 1);
}

std::string plan_svg(const report_data& data, std::size_t number, const cell_colors& colors) {
  const report_floor& floor = data.floors[number];
  const report_frame& f = data.frame;
  const double width = f.max_x - f.min_x, height = f.max_z - f.min_z, line = std::max(width, height) / 600.0;
  const value_range range = range_of(colors.values, colors.logarithmic);
  std::string out = fmt::format(
      "<svg class=\"plan\" viewBox=\"{:.2f} {:.2f} {:.2f} {:.2f}\" role=\"img\" aria-label=\"{}, floor {}\">\n",
      f.min_x, f.min_z, width, height, escaped(colors.title), number + 1);
  if (!floor.ground.empty()) out += fmt::format("<use href=\"#ground-{}\"/>\n", number + 1);
  out += fmt::format("<g stroke-width=\"{:.3f}\">\n", line);
  std::vector<std::string> shapes(color_steps + 1);  // the last: without a value
  const bool titled = data.cells.size() <= most_titles;
  for (const std::uint32_t cell : drawing_order(data, floor)) {
    const report_cell& c = data.cells[cell];
    const int step = color_step(colors.values[cell], range.low, range.high, colors.logarithmic);
    const std::string name = step < 0 ? "none" : std::to_string(step);
    if (titled)
      out += fmt::format("<path class=\"q{}\" d=\"{}\"><title>cell {}: {}</title></path>\n", name, rectangle_path(c),
                         cell, step < 0 ? "unknown" : escaped(colors.text_of(colors.values[cell])));
    else
      shapes[static_cast<std::size_t>(step < 0 ? color_steps : step)] += rectangle_path(c);
  }
  for (std::size_t i = 0; i < shapes.size(); ++i)
    if (!shapes[i].empty())
      out += fmt::format("<path class=\"q{}\" d=\"{}\"/>\n", i < color_steps ? std::to_string(i) : "none", shapes[i]);
  out += "</g>\n";
  const double bar = bar_length_of(width), x = f.min_x + 0.02 * width, z = f.max_z - 0.02 * height;
  return out +
         fmt::format(
             "<path class=\"scale\" stroke-width=\"{:.3f}\" d=\"M{:.2f} {:.2f}v{:.2f}h{:.2f}v{:.2f}\"/>\n</svg>\n",
             2.5 * line, x, z - 6.0 * line, 6.0 * line, bar, -6.0 * line) +
         fmt::format("<p class=\"note\">{}; the bar is {:g} m long</p>\n", escaped(colors.title), bar);
}

std::string legend_html(const cell_colors& colors) {
  const value_range range = range_of(colors.values, colors.logarithmic);
  if (range.empty()) return "";
  const bool apart =
      are_apart(place_of(range.low, colors.logarithmic), place_of(range.high, colors.logarithmic), colors.logarithmic);
  std::string out = fmt::format("<p class=\"legend\"><span class=\"of\">{}</span><span>{}</span><span class=\"ramp\">",
                                escaped(colors.title), apart ? escaped(colors.text_of(range.low)) : "all");
  for (int i = 0; i < color_steps; ++i)
    if (apart || i == color_steps / 2) out += fmt::format("<i class=\"q{}\"></i>", i);
  return out + fmt::format("</span><span>{}</span></p>\n", escaped(colors.text_of(range.high)));
}

std::string grounds_svg(const report_data& data) {
  const report_frame& f = data.frame;
  std::string out;
  for (std::size_t i = 0; i < data.floors.size(); ++i)
    if (!data.floors[i].ground.empty())
      out += fmt::format(
          "<image id=\"ground-{}\" class=\"ground\" x=\"{:.3f}\" y=\"{:.3f}\" width=\"{:.3f}\" height=\"{:.3f}\" "
          "preserveAspectRatio=\"none\" href=\"{}\"/>\n",
          i + 1, f.min_x, f.min_z, f.max_x - f.min_x, f.max_z - f.min_z, data.floors[i].ground);
  return out.empty()
             ? out
             : "<svg width=\"0\" height=\"0\" class=\"shared\" aria-hidden=\"true\"><defs>\n" + out + "</defs></svg>\n";
}

}  // namespace sightcell::cli
