#include "cells/cells_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include "cells/view_cell.h"
#include "errors/error_id.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

std::string error_of(const std::string& text) {
  try {
    parse_cells(text, "cells.json");
  } catch (const error& e) {
    EXPECT_EQ(e.kind(), error_kind::bad_input);
    return e.what();
  }
  return "no error";
}

TEST(cells_file, reads_boxes_in_order) {
  const auto cells = parse_cells(
      R"({"cells":[{"name":"lane 3","min":[0,0,0],"max":[4,2,4],"more":1},{"min":[-1.5,0,0],"max":[0,1,1]}]})", "f");
  ASSERT_EQ(cells.size(), 2u);
  EXPECT_EQ(cells[0].name, "lane 3");
  EXPECT_EQ(cells[0].max, glm::vec3(4, 2, 4));
  EXPECT_EQ(cells[1].name, "");
  EXPECT_EQ(cells[1].min, glm::vec3(-1.5f, 0, 0));
  EXPECT_NE(cells[0].place, cells[1].place);
}

TEST(cells_file, place_depends_on_the_six_floats_alone) {
  const auto a = parse_cells(R"({"cells":[{"name":"a","min":[0,0,0],"max":[4,2,4]}]})", "f");
  const auto b = parse_cells(R"({"cells":[{"min":[-1,0,0],"max":[4,2,4]},{"min":[-0.0,0,0],"max":[4,2,4]}]})", "f");
  EXPECT_EQ(a[0].place, b[1].place);
  EXPECT_NE(a[0].place, b[0].place);
}

TEST(cells_file, errors_name_cell_and_cause) {
  EXPECT_NE(error_of("{").find("cells.json: not JSON: "), std::string::npos);
  EXPECT_NE(error_of("[1]").find("[cells.no-list]"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":{}})").find("[cells.no-list]"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[]})").find("empty"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[7]})").find("cell 0 is not an object"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"min":[0,0,0]}]})").find("cell 0 has no \"max\""), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"min":[0,0],"max":[1,1,1]}]})").find("[cells.bad-box]"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"min":[0,"a",0],"max":[1,1,1]}]})").find("holds a string"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"name":3,"min":[0,0,0],"max":[1,1,1]}]})").find("[cells.bad-name]"),
            std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"name":"x","min":[0,5,0],"max":[1,5,1]}]})")
                .find("cell 0 \"x\": min 5 is not below max 5 on y"),
            std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"min":[0,0,0],"max":[1,1,1e9]}]})").find("[cells.too-far]"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"min":[0,0,0],"max":[1,1,1e999]}]})").find("[cells.not-json]"), std::string::npos);
  EXPECT_NE(error_of(R"({"cells":[{"min":[0,0,0],"max":[1,1,NaN]}]})").find("[cells.not-json]"), std::string::npos);
  // Different in double, the same in single precision.
  EXPECT_NE(error_of(R"({"cells":[{"min":[1000000.0,0,0],"max":[1000000.0001,1,1]}]})").find("[cells.empty-box]"),
            std::string::npos);
}

TEST(cells_file, missing_file_is_named) {
  try {
    read_cells_file("no/such/cells.json");
    FAIL();
  } catch (const error& e) {
    EXPECT_EQ(e.id(), "cells.unreadable");
    EXPECT_NE(std::string(e.what()).find("no/such/cells.json"), std::string::npos);
  }
  EXPECT_THROW(read_cells_file(std::filesystem::temp_directory_path()), error);  // a folder
}

TEST(cells, boxes_of_a_host_are_finite) {
  settings how;
  how.cells.push_back({"stand", {0, 0, 0}, {1, std::numeric_limits<float>::infinity(), 1}});
  EXPECT_EQ(test::error_id([&] { make_cells({}, how); }), "cells.not-finite");
  how.cells[0].max[1] = std::nanf("");
  EXPECT_EQ(test::error_id([&] { make_cells({}, how); }), "cells.not-finite");
}

}  // namespace
}  // namespace sightcell::bake
