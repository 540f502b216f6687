// The page of a report, from data alone: numbers, hostile text, data with gaps, suggestions.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "report/charts.h"
#include "report/html.h"
#include "report/page.h"
#include "report/page_parts.h"
#include "report/suggestions.h"

namespace sightcell::cli {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

report_cell cell_at(float x, float y, double bound = 1e-4) {
  report_cell cell{.min = {x, y, 0}, .max = {x + 4, y + 2, 4}};
  cell.polygons = 100;
  cell.rays = 50'000;
  cell.bound = bound;
  cell.confidence = 0.97;
  return cell;
}

// A row of cells on the ground.
report_data data_of_cells(std::size_t count) {
  report_data data;
  data.scene_path = "level.glb", data.file_path = "level.pvs";
  for (std::size_t i = 0; i < count; ++i) data.cells.push_back(cell_at(4.0f * static_cast<float>(i), 0.9f));
  data.info = {{"cells", count},
               {"polygons", 1000},
               {"bytes", 5000},
               {"visible_set_percent", 10.0},
               {"settings", {{"cells", "automatic"}, {"max_pixel_error", 1e-4}, {"samples", 24}, {"cell_size", 4}}}};
  return data;
}

std::vector<std::string> titles_of(const report_data& data) {
  std::vector<std::string> titles;
  for (const suggestion& s : suggestions_of(data)) titles.push_back(s.title);
  return titles;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(report, text_cannot_leave_its_element) {
  EXPECT_EQ(escaped("<script>alert('x' & \"y\")</script>"),
            "&lt;script&gt;alert(&#39;x&#39; &amp; &quot;y&quot;)&lt;/script&gt;");
  EXPECT_EQ(escaped("\u00e9\u4e16\U0001F600"), "\u00e9\u4e16\U0001F600");
  // Bytes that are not UTF-8, a surrogate, a longer form of '<', and control characters.
  const std::string bad = "\xEF\xBF\xBD";
  EXPECT_EQ(escaped("a\xFFz"), "a" + bad + "z");
  EXPECT_EQ(escaped("\xED\xA0\x80"), bad + bad + bad);
  EXPECT_EQ(escaped("\xC0\xBC"), bad + bad);
  EXPECT_EQ(escaped(std::string("\x00\x1B", 2)), bad + bad);
  EXPECT_EQ(escaped("\xE4\xB8"), bad + bad);
}

TEST(report, hostile_names_are_text_everywhere) {
  const std::string evil = "</title><script>alert(1)</script>' onload=\"x\" <!--";
  report_data data = data_of_cells(1);
  data.scene_path = evil, data.file_path = evil;
  data.info["settings"][evil] = evil;
  data.info["fingerprint"] = evil;
  data.info["sections"] = {{{"name", evil}, {"size", 7}}};
  data.bake = {{"device", evil}, {"phases", {{{"phase", evil}, {"cpu_seconds", 1.0}}}}};
  data.unseen.emplace();
  data.unseen->polygons = 10, data.unseen->unseen = 10;
  data.unseen->objects = {{0, evil, 10, 10}};
  data.unseen->warnings = {evil};
  report_view view;
  view.missing = 3, view.node_name = evil;
  data.views = {view};
  const std::string page = report_page(data);
  EXPECT_FALSE(contains(page, "<script"));
  EXPECT_FALSE(contains(page, "<!--"));
  EXPECT_FALSE(contains(page, "onload=\"x\""));
  EXPECT_GE(page.size(), 5u);
  std::size_t shown = 0;
  for (std::size_t at = page.find("&lt;script&gt;"); at != std::string::npos; at = page.find("&lt;script&gt;", at + 1))
    ++shown;
  EXPECT_GE(shown, 9u);
}

TEST(report, data_with_gaps_and_odd_numbers_makes_a_page) {
  report_data empty;
  EXPECT_TRUE(contains(report_page(empty), "The file has no cells."));
  for (const nlohmann::ordered_json& odd :
       {nlohmann::ordered_json("text"), nlohmann::ordered_json(7), nlohmann::ordered_json::array({1, "a"}),
        nlohmann::ordered_json{
            {"settings", "text"}, {"sections", 3}, {"cell_seconds", 4}, {"phases", {5}}, {"bytes", -1}}}) {
    report_data data = data_of_cells(2);
    data.info = odd, data.verify = odd, data.bake = odd;
    data.cells[0].bound = std::nan(""), data.cells[1].seconds = infinite, data.cells[1].bound = 0.0;
    data.floors = {{.cells = {0, 1}, .lowest = std::nan(""), .highest = infinite, .ground = {}}};
    data.views = {report_view{}};
    EXPECT_TRUE(contains(report_page(data), "</html>"));
  }
}

TEST(report, growth_is_a_curve) {
  report_data data = data_of_cells(2);
  using json = nlohmann::ordered_json;
  const auto point = [](const json& hemicubes, const json& share) {
    return json{{"hemicubes", hemicubes}, {"share", share}, {"cells", 2}};
  };
  data.bake = {{"found_by", {{"sampler", 0.9}, {"nearby_rays", 0.1}}},
               {"growth", json::array({point(1, 0.25), point(2, 0.5), point(2, 0.6), point(4, 1.5), point("8", 0.7),
                                       point(1e300, 0.7), point(16, 0.9)})}};
  const std::string page = report_page(data);
  EXPECT_TRUE(
      contains(page,
               "the first hemicube of each cell found 25.0 % of the polygons of all sets, the first 2 found 50.0 %, "
               "and all of them, up to 16 in a cell, found 90.0 %"));
  EXPECT_TRUE(contains(page, "class=\"curve\""));
  std::size_t circles = 0;
  for (std::size_t at = page.find("<circle"); at != std::string::npos; at = page.find("<circle", at + 1)) ++circles;
  EXPECT_EQ(circles, 3u) << "points that are out of order or range are left out";
  data.bake["growth"] = json::array({point(1, 1.0)});
  EXPECT_FALSE(contains(report_page(data), "class=\"curve\"")) << "one point is no curve";
}

TEST(report, values_are_beside_their_text) {
  report_data data = data_of_cells(3);
  data.info["visible_set_percent"] = 5.055137201874432;
  const std::string page = report_page(data);
  EXPECT_TRUE(
      contains(page, "<span data-key=\"info.visible_set_percent\" data-value=\"5.055137201874432\">5.1 %</span>"));
  EXPECT_TRUE(contains(page, "data-key=\"info.cells\" data-value=\"3\""));
  EXPECT_EQ(page, report_page(data));
}

TEST(report, numbers_have_few_digits) {
  EXPECT_EQ(probability_text(9.999940812122077e-05), "1.00e-4");
  EXPECT_EQ(probability_text(9.5e-05), "9.50e-5");
  EXPECT_EQ(probability_text(0.0), "0");
  EXPECT_EQ(probability_text(0.25), "0.25");
  EXPECT_EQ(probability_text(std::nan("")), "-");
  EXPECT_EQ(percent_text(31.44), "31.4 %");
  EXPECT_EQ(percent_text(0.0523), "0.052 %");
  EXPECT_EQ(percent_text(infinite), "-");
  EXPECT_EQ(seconds_text(0.412), "0.41 s");
  EXPECT_EQ(seconds_text(185.0), "3 min 05 s");
  EXPECT_EQ(bytes_text(318), "318 B");
}

TEST(report, histograms_count_each_value_once) {
  const std::vector<double> values{1, 2, 3, 4, 5, std::nan(""), infinite};
  EXPECT_EQ(histogram_of(values, 4, false).counts, (std::vector<std::uint32_t>{1, 1, 1, 2}));
  EXPECT_EQ(histogram_of(std::vector<double>{1e-5, 1e-3, 0, -1}, 2, true).counts, (std::vector<std::uint32_t>{1, 1}));
  EXPECT_EQ(histogram_of(std::vector<double>{7, 7, 7}, 10, false).counts, (std::vector<std::uint32_t>{3}));
  EXPECT_TRUE(histogram_of(std::vector<double>{}, 10, false).counts.empty());
  EXPECT_TRUE(histogram_of(std::vector<double>{0.0}, 10, true).counts.empty());
  EXPECT_EQ(histogram_svg(histogram_of(std::vector<double>{}, 3, false), "t", "u", probability_text), "");
}

TEST(report, colors_go_from_the_lowest_to_the_highest) {
  EXPECT_EQ(color_step(1, 1, 8, false), 0);
  EXPECT_EQ(color_step(8, 1, 8, false), color_steps - 1);
  EXPECT_EQ(color_step(5, 5, 5, false), color_steps / 2);
  EXPECT_EQ(color_step(std::nan(""), 1, 8, false), -1);
  EXPECT_EQ(color_step(0, 1, 8, true), -1);
}

TEST(report, words_of_commands_are_quoted) {
  EXPECT_EQ(shell_word("levels/a-1.glb"), "levels/a-1.glb");
  EXPECT_EQ(shell_word("my level's.glb"), "'my level'\\''s.glb'");
  EXPECT_EQ(shell_word("$(x)"), "'$(x)'");
  EXPECT_EQ(shell_word(""), "''");
  report_data data = data_of_cells(1);
  report_view view;
  view.eye = {1, 2, 3}, view.target = {2, 2, 3};  // toward +x: a quarter turn to the right
  EXPECT_EQ(viewer_command(data, view),
            "sightcell view level.glb level.pvs --eye=1.000,2.000,3.000 --look=90.00,0.00 --frozen-from 0 --mode tint");
}

TEST(report, suggests_what_the_data_asks_for) {
  EXPECT_TRUE(titles_of(data_of_cells(3)).empty());

  report_data missed = data_of_cells(3);
  missed.cells[1].bound = 2e-4;
  ASSERT_EQ(titles_of(missed), (std::vector<std::string>{"1 of 3 cells missed their bound"}));
  EXPECT_TRUE(contains(suggestions_of(missed)[0].command, "--samples 48"));
  missed.info["settings"]["seconds_per_cell"] = 5;
  EXPECT_TRUE(contains(suggestions_of(missed)[0].command, "--seconds-per-cell 10"));

  report_data unseen = data_of_cells(3);
  unseen.unseen.emplace();
  unseen.unseen->polygons = 100, unseen.unseen->unseen = 31;
  ASSERT_EQ(titles_of(unseen), (std::vector<std::string>{"31.0 % of all polygons are visible from no cell"}));
  EXPECT_TRUE(contains(suggestions_of(unseen)[0].command, "sightcell strip level.glb level.pvs"));
  // Of a trial, other cells may show them.
  unseen.info["settings"]["cell_limit"] = 3;
  EXPECT_EQ(titles_of(unseen), (std::vector<std::string>{"This is a trial of 3 cells"}));
}

TEST(report, suggests_at_most_three_things) {
  report_data data = data_of_cells(3);
  data.cells[0].bound = 1.0;
  data.verify = {{"upper_bound", 2e-4}, {"max_pixel_error", 1e-4}};
  data.raised.cells = 5;
  data.info["visible_set_percent"] = 80.0;
  data.info["settings"]["profile"] = "exact";
  const std::vector<std::string> titles = titles_of(data);
  ASSERT_EQ(titles.size(), most_suggestions);
  EXPECT_EQ(titles[0], "1 of 3 cells missed their bound");
  EXPECT_EQ(titles[2], "5 cells are on roofs or other places out of reach");
}

TEST(report, finds_cells_that_no_path_leads_up_to) {
  // A street of four cells; two cells on a roof beside it; one up a step from the street; one in an attic below the
  // roof.
  report_data data = data_of_cells(4);
  for (const auto& [x, y] : {std::pair(0.0f, 9.0f), {4.0f, 9.0f}, {16.0f, 2.0f}, {10.0f, 5.5f}}) {
    data.cells.push_back(cell_at(x, y));
    data.cells.back().min[2] = 6, data.cells.back().max[2] = 10;
  }
  data.cells[6].min[2] = 0;
  std::vector<bake::cell_view> views;
  for (std::uint32_t cell = 0; cell < data.cells.size(); ++cell)
    views.push_back({.cell = cell, .eye = {static_cast<float>(cell), 1, 1}});
  views[7].above = 1.5f;  // the attic has a ceiling
  const raised_cells found = find_raised_cells(data.cells, views);
  EXPECT_EQ(found.cells, 2u);
  EXPECT_EQ(found.start, (std::array<float, 3>{0, 1, 1}));
  EXPECT_EQ(find_raised_cells({}, {}).cells, 0u);
}

}  // namespace
}  // namespace sightcell::cli
