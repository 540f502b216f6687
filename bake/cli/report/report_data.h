#pragma once
// What a report shows. The page (page.h) is made of this alone: no file, no scene, no device.
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sightcell/bake/unseen.h"

namespace sightcell::cli {

// A view cell of the file.
struct report_cell {
  std::array<float, 3> min{}, max{};  // meters, without the margin
  std::uint64_t polygons = 0;         // of its set
  std::uint64_t rays = 0, misses = 0;
  double bound = 1.0;  // of its miss probability; 1 if it has none
  double confidence = 0.0;
  double seconds = -1.0;  // that the bake took for it; negative if that is unknown

  bool bounded() const { return rays > 0 && bound < 1.0; }
};

// A storey or a slope.
struct report_floor {
  std::vector<std::uint32_t> cells;
  double lowest = 0.0, highest = 0.0;  // meters
  std::string ground;                  // data URI of its plan; may be empty
};

// What the plans show, in meters. +x is to the right, +z is down.
struct report_frame {
  double min_x = 0.0, min_z = 0.0, max_x = 1.0, max_z = 1.0;
};

// A view of which there are pictures.
struct report_view {
  std::uint32_t cell = 0;
  std::array<float, 3> eye{}, target{};            // meters
  std::optional<std::uint32_t> missing;            // source id of the polygon that rays missed
  std::string node_name;                           // of the missing polygon
  std::uint64_t differing_pixels = 0, pixels = 0;  // pixels of a picture
  std::uint64_t drawn = 0;                         // polygons of the set
  std::string full, culled, difference;            // data URIs
};

// Cells to which no path of other cells leads, under the open sky and above other ground.
struct raised_cells {
  std::uint32_t cells = 0;
  std::array<float, 3> start{};  // a valid viewpoint among the most cells that are connected, meters
};

struct report_data {
  std::string scene_path, file_path, report_path;  // as the user gave them
  nlohmann::ordered_json info;                     // `info --json` of the file
  nlohmann::ordered_json verify;                   // `verify --json`, or null
  nlohmann::ordered_json bake;                     // `bake --json`, or null
  std::vector<report_cell> cells;
  std::vector<report_floor> floors;
  report_frame frame;
  std::vector<report_view> views;
  std::uint32_t views_tried = 0;  // of which `views` are those with the most wrong pixels
  std::string views_note;         // why there are no pictures; empty if there are some
  std::optional<bake::unseen_polygons> unseen;
  raised_cells raised;
};

}  // namespace sightcell::cli
