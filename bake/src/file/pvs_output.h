#pragma once
// From finished cells to the .pvs file.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "cell_set/cell_record.h"
#include "cells/view_cell.h"
#include "sightcell/bake/bake.h"
#include "sightcell/format/records.h"
#include "volumes/volume_grid.h"

namespace sightcell::bake {

// A cell's record, by its place in the list of cells. Only one set at a time lies in memory uncompressed.
using record_source = std::function<cell_record(std::uint32_t)>;

// Adds to an encoded file what needs all of it; false: the user has had enough.
using file_completion = std::function<bool(std::vector<std::byte>& file)>;

// All that a file says besides what was found.
struct pvs_frame {
  std::string scene_name;    // for messages
  format::file_facts facts;  // without the bound
  std::uint64_t seed = 0;
  std::vector<format::draw_record> draws;
  std::vector<std::string> named_groups;       // the scene's groups
  std::vector<format::box> cells;              // of all cells, also of those that are not stored
  double volume_width = 0.0;                   // metres
  std::vector<format::lattice_place> volumes;  // by the numbers that records have
  std::string settings;                        // the text for the file
};

// volumes: null, none.
pvs_frame frame_of(const scene::scene& s, const settings& how, std::string settings_text,
                   const std::vector<view_cell>& cells, const volume_grid* volumes = nullptr);

// Puts cells, polygons and volumes in the file's order, encodes them and writes output by rename; fills in the summary.
// Every cell's record is asked for in ascending order, then those of stored ones about ten times in the file's order,
// where there are volumes about seventeen, on the calling thread; what record_of throws comes through. Cells that were
// not stored are named in warnings. complete: is asked when all else of the file is known. False when it was: nothing
// is written then. Throws sightcell::error when nothing can be stored or written.
bool write_pvs(const pvs_frame& frame, const record_source& record_of, const std::filesystem::path& output,
               const callbacks& tell, summary& sum, const file_completion& complete = {});

}  // namespace sightcell::bake
