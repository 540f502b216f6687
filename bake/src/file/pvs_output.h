#pragma once
// Writes the .pvs file from finished cells.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "cell_set/cell_record.h"
#include "cells/view_cell.h"
#include "order/cluster_order.h"
#include "order/draw_identity.h"
#include "order/kept_order.h"
#include "sightcell/bake/bake.h"
#include "sightcell/format/records.h"
#include "volumes/volume_grid.h"

namespace sightcell::bake {

// Returns the record of the cell at this index in the list of cells. Any thread.
using record_source = std::function<cell_record(std::uint32_t)>;

// Adds to an encoded file what needs the rest of it. Returning false cancels.
using file_completion = std::function<bool(std::vector<std::byte>& file)>;

// The content of a file apart from the sets.
struct pvs_frame {
  std::string scene_name;    // for messages
  format::file_facts facts;  // without the bound
  std::uint64_t seed = 0;
  std::vector<format::draw_record> draws;
  std::vector<std::string> named_groups;       // of the scene
  cluster_numbers clusters;                    // empty: sets are of polygons
  std::vector<format::box> cells;              // all cells, including those that are not stored
  double volume_width = 0.0;                   // meters
  std::vector<format::lattice_place> volumes;  // in the order of the numbers in records
  draw_identity identity;                      // empty: not stored
  std::string settings;                        // settings text of the file
  std::uint64_t memory = 0;                    // limit of the process in bytes; 0: none
  const earlier_order* order = nullptr;        // what keeps its order; null: it is computed
};

// Returns the content of a file apart from the sets.
// volumes: null: none.
pvs_frame frame_of(const scene::scene& s, const settings& how, std::string settings_text,
                   const std::vector<view_cell>& cells, const volume_grid* volumes = nullptr);

// Returns the size of the file with these cells.
// frame: frame.cells may be some of the cells of a bake.
// record_of: as for write_pvs(), by the index in frame.cells.
// Returns 0 if no cell is stored. Fails with output.encode.
std::size_t encoded_bytes(const pvs_frame& frame, const record_source& record_of);

// Puts cells, polygons and volumes in the order of the file, encodes them, writes output by rename and fills in the
// summary. Cells that are not stored are counted in a warning.
// record_of: called for every cell, for up to 64 at once; then about ten times for each stored cell in the order of the
// file if its set has no room in memory (kept_sets.h) or if there are volumes. Its exceptions pass through. complete:
// called when the rest of the file is encoded. Returns false if complete did; nothing is written then. Throws
// sightcell::error if no cell can be stored or the file cannot be written.
bool write_pvs(const pvs_frame& frame, const record_source& record_of, const std::filesystem::path& output,
               const callbacks& events, summary& sum, const file_completion& complete = {});

}  // namespace sightcell::bake
