#pragma once
// The contents of a file without its sets and their importance, for tools that encode it again. set_reader.h returns
// the sets one at a time.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sightcell/format/reader.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"
#include "sightcell/format/writer.h"

namespace sightcell::format {

struct file_parts {
  file_facts facts;
  std::vector<draw_record> draws;  // in stored order
  std::vector<std::string> named_groups;
  std::vector<std::uint32_t> order_of_draw;
  std::vector<std::vector<std::uint32_t>> orders;
  std::vector<std::vector<std::uint32_t>> clusters;  // of a file with clusters: the polygons of each, by order
  std::vector<box> cells;                            // also for cells on a lattice or grid
  std::optional<lattice_shape> lattice;              // where cells are on one
  std::vector<lattice_place> places;                 // one per cell on the lattice, else none
  std::optional<lattice_shape> grid;                 // the step, where cells are on a grid
  std::vector<grid_box> grid_places;                 // one per cell on the grid, else none
  lattice_shape volume_shape;                        // of each volume; set if there are volumes
  std::vector<lattice_place> volumes;
  std::vector<certificate_record> certificate;
  std::vector<viewpoint_record> viewpoints;         // one per cell, or none
  float player_radius = 0.0f;                       // meters; 0 without viewpoints
  std::vector<std::uint64_t> geometry_hashes;       // of the draws with polygons, in source order; or none
  std::vector<std::string> node_names, mesh_names;  // by number, of a file with hashes
  std::string settings;
  std::uint32_t chunk_bytes = usual_chunk_bytes;  // of file_contents; take_apart leaves it

  // For encode(). sets: by the numbers of these cells; with volumes, as set_reader::item_ids returns them. The result
  // refers to the parts.
  [[nodiscard]] file_contents contents(cell_set_source sets) const;
};

// Copies everything out of a file; out is replaced. corrupt: a table or an order is damaged. Allocates.
status take_apart(const reader& file, file_parts& out);

}  // namespace sightcell::format
