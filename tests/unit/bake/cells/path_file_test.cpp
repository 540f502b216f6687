#include "cells/path_file.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "errors/error_id.h"

namespace sightcell::bake {
namespace {

TEST(path_file, has_one_path_or_several) {
  const auto paths = parse_paths(R"({"fps":30,"paths":[[[7,8,9]],[[1,1,1],[2,2,2]]],"path":[[0,1.5,-2]]})", "p");
  ASSERT_EQ(paths.size(), 3u);
  EXPECT_EQ(paths[0], (camera_path{{0.0f, 1.5f, -2.0f}}));
  EXPECT_EQ(paths[1], (camera_path{{7.0f, 8.0f, 9.0f}}));
  EXPECT_EQ(paths[2].size(), 2u);
}

TEST(path_file, what_is_wrong_is_named) {
  for (const auto& [text, id] : {std::pair{"{", "path.not-json"},
                                 {R"({"path":[[0,0,1e999]]})", "path.not-json"},
                                 {"[[0,0,0]]", "path.no-points"},
                                 {"{}", "path.no-points"},
                                 {R"({"path":[]})", "path.no-points"},
                                 {R"({"path":7})", "path.no-points"},
                                 {R"({"paths":[]})", "path.no-points"},
                                 {R"({"paths":{}})", "path.no-points"},
                                 {R"({"paths":[[[0,0,0]],[]]})", "path.no-points"},
                                 {R"({"path":[[0,0]]})", "path.bad-point"},
                                 {R"({"path":[0,0,0]})", "path.bad-point"},
                                 {R"({"path":[[0,"a",0]]})", "path.bad-point"},
                                 {R"({"path":[[0,0,0],[0,2e7,0]]})", "path.bad-point"},
                                 {R"({"path":[[null,0,0]]})", "path.bad-point"}})
    EXPECT_EQ(test::error_id([&text = text] { (void)parse_paths(text, "p"); }), id) << text;
  try {
    (void)parse_paths(R"({"paths":[[[0,0,0],[0,2e7,0]]]})", "walk.json");
    ADD_FAILURE();
  } catch (const error& e) {
    EXPECT_NE(std::string(e.what()).find("walk.json: point 1 of path 0 of \"paths\" is at 2e+07 m"), std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace sightcell::bake
