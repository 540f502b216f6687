#pragma once
// Charts of a report as SVG.
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "report/report_data.h"

namespace sightcell::cli {

// How many values lie in each of some intervals of the same width.
struct histogram {
  double low = 0.0, high = 0.0;  // of all intervals; logarithms with base 10 if logarithmic
  bool logarithmic = false;
  std::vector<std::uint32_t> counts;  // empty without values
};

// Counts values. Those that are not finite are left out, and those that are 0 or less if logarithmic.
// intervals: 1 or more. Values that are all the same are in one interval.
histogram histogram_of(std::span<const double> values, std::size_t intervals, bool logarithmic);

using number_text_of = std::function<std::string(double)>;

// Draws a histogram. Empty without values.
// title: for screen readers. unit: below the axis. text_of: of a value on the axis.
std::string histogram_svg(const histogram& h, const std::string& title, const std::string& unit,
                          const number_text_of& text_of);

// A point of a curve. The curve has logarithmic x.
struct curve_point {
  double x = 0.0;      // above 0
  double share = 0.0;  // 0 .. 1
  std::string text;    // of the point, as a tooltip
};

// Draws a curve of shares, 0 to 100 %. Empty with less than two points.
// points: x ascending. title: for screen readers. unit: of x, below the axis.
std::string curve_svg(std::span<const curve_point> points, const std::string& title, const std::string& unit);

// What colors the cells of plans: a value per cell, not finite for cells without one.
struct cell_colors {
  std::string title;  // "Polygons"
  std::vector<double> values;
  bool logarithmic = false;
  number_text_of text_of;
};

inline constexpr int color_steps = 7;

// Returns the step of a color ramp, 0 .. color_steps - 1; -1 if the value is not finite.
// low, high: of all values; if they are the same, every value has the middle step.
int color_step(double value, double low, double high, bool logarithmic);

// Draws the plan of a floor, with each cell in the color of its value.
// number: of the floor, which names the picture of its ground in the page.
std::string plan_svg(const report_data& data, std::size_t number, const cell_colors& colors);

// Draws the ramp with the lowest and the highest value.
std::string legend_html(const cell_colors& colors);

// Returns the pictures of the grounds, once for all plans; not visible by itself.
std::string grounds_svg(const report_data& data);

}  // namespace sightcell::cli
