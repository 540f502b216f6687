#pragma once
// Encodes a .pvs file (format/SPEC.md) into memory; write_file writes the bytes to disk.
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// Cell sets, one at a time: all sets together, uncompressed, can be larger than the memory. Belongs to the caller, with
// everything that get refers to.
struct cell_set_source {
  // The number of sets: one per cell.
  std::size_t count = 0;
  // Appends a set to `set`, which is empty and keeps its storage from cell to cell: the source ids of the cell's
  // polygons, then polygon_count + v for each volume v, strictly ascending. encode calls it several times for each
  // cell, each time in ascending order, on its own thread, and needs the same result. A status other than ok ends
  // encode with this status; an exception passes through encode, if the writer is built with exceptions.
  std::function<status(std::uint32_t cell, std::vector<std::uint32_t>& set)> get;
  // Whether get may be called for several cells at once. Then encode calls it inside file_contents::run_at_once, for
  // eight cells in ascending order in each piece of work.
  bool any_thread = false;
};

// Sets in memory, which must outlive the source.
cell_set_source sets_of(std::span<const std::vector<std::uint32_t>> sets);

// The order in which polygons are stored. Instanced: draws with the same order are instances of one primitive and have
// the same number of polygons. Merged: each draw group has the order of its own number; its polygons in source order
// are those of its draws, one draw after the other.
struct stored_order {
  // One per draw, in the order of the draw table: 0, then one that occurred before or the next number.
  std::span<const std::uint32_t> order_of_draw;
  // Element i of an order: which polygon of the draw, or the draw group, in source order, is stored at index i.
  std::span<const std::vector<std::uint32_t>> orders;
  // For a file whose sets are of clusters: the polygons of each cluster, 1 .. max_cluster_polygons, as they follow each
  // other in each order. Empty: sets are of polygons.
  std::span<const std::vector<std::uint32_t>> clusters{};
};

// Cells on a lattice, which take a tenth of the bytes of boxes. Positions ascend by lattice_comes_before.
struct lattice_cells {
  lattice_shape shape;
  std::span<const lattice_place> places;  // one per cell
};

// Cells that are boxes of whole steps of a grid, in any order and of any sizes. They take about a seventh of the
// bytes of boxes.
struct grid_cells {
  lattice_shape step;                // the size of a step
  std::span<const grid_box> places;  // one per cell
};

// Visibility volumes (SPEC.md, "Volumes"). shape: of one volume. Positions are of level 0, in the order of the file.
struct lattice_volumes {
  lattice_shape shape;
  std::span<const lattice_place> places;  // empty: a file without volumes
};

// The order of lattice cells in a file: by level, then by chunks of 8 x 8.
[[nodiscard]] bool lattice_comes_before(const lattice_place& a, const lattice_place& b) noexcept;

// The valid viewpoints of one cell (SPEC.md, "Viewpoints").
struct viewpoint_record {
  std::uint32_t cell = 0;
  float valid_share = 1.0f;       // estimated share of the region that is valid viewpoints, in (0, 1]
  double outside_share = 0.0;     // upper limit, at 95 % confidence, of the share of the valid viewpoints outside the
                                  // region, 0 .. 1; 0 if the region is the whole grown box
  std::vector<std::byte> region;  // tree over the grown box (viewpoint_table.h); empty: the whole grown box
  std::vector<eye_steps> eyes{};  // valid viewpoints in the box of the cell (eye_table.h); at most max_eyes, or none
};

// Calls work(0) .. work(count - 1), in any order and at the same time if it likes, and returns when all have returned.
using work_runner = std::function<void(std::size_t count, const std::function<void(std::size_t item)>& work)>;

// What a host that pages loads for one cell. Smaller chunks make a file larger, because the rows of a chunk refer to no
// other chunk.
inline constexpr std::uint32_t usual_chunk_bytes = 16384;

// The contents of a file. Used only during the call of encode.
struct file_contents {
  file_facts facts;
  // In stored order: first_stored ascends from 0 without gaps, and each source id occurs once. Merged: group by group,
  // the draws of a group in source order, all of one material; a draw that moves is alone in its group.
  std::span<const draw_record> draws;
  std::span<const std::string> named_groups;  // their names, not empty; draw_record::named_group is an index
  stored_order order;                         // without orders: each draw, or draw group, in source order
  std::span<const box> cells;                 // a cell's number is its index here; empty for cells on a lattice or grid
  std::optional<lattice_cells> lattice;
  std::optional<grid_cells> grid;  // none beside a lattice
  lattice_volumes volumes;
  cell_set_source cell_sets;
  std::span<const certificate_record> certificate;  // empty, or one per cell in cell order
  std::span<const viewpoint_record> viewpoints;     // empty, or one per cell in cell order
  float player_radius = 0.0f;                       // meters, above 0; not used without viewpoints
  // Draw identity (identity_table.h): the geometry hash of each draw with polygons, in source order; empty: none. Names
  // are by the numbers of nodes and meshes in draws; those of others are left out, and long ones lose their end.
  std::span<const std::uint64_t> geometry_hashes;
  std::span<const std::string> node_names, mesh_names;
  std::string_view settings;  // JSON text of the settings that made the file; may be empty
  // The share of polygons that encode may add to each set, 0 .. 1, in steps of a millionth; 0: sets are stored as they
  // are. With clusters, the share of clusters; polygons that fill a cluster do not count. encode chooses polygons that
  // make the file smaller and (draw, first, count) ranges fewer. It removes none, and adds no volumes. facts.slack is
  // the slack that the sets have already; the file has the sum of both.
  double slack = 0.0;
  // About the most bytes of a chunk of rows that has more than one cell; above 0. Rows of 64 cells that are smaller
  // together are one chunk. A chunk may be a little larger, since its bytes are estimated before they are written.
  std::uint32_t chunk_bytes = usual_chunk_bytes;
  // Runs the work on different cells at the same time, for `groups_at_once` groups of 64 cells. Empty: everything runs
  // on the calling thread. The bytes do not depend on either.
  work_runner run_at_once;
  std::size_t groups_at_once = 1;
};

// Encodes contents. The same contents give the same bytes.
// out: replaced on ok, else unchanged.
// Fails with argument (contents that contradict themselves: unsorted ids, counts that differ, boxes that are not
//   finite, two volumes at one position, a region that is no valid tree, no chunk_bytes), limit (a number above the
//   limits of layout.h), memory, and the status of a source.
// Cost: memory for the file, for the sets of groups_at_once groups of 64 cells, 8 bytes per run of each, and 4 bytes
//   per polygon; with slack, for each group in work, about 60 bytes per different border of its 64 sets, and up to 32
//   MiB for sets that are kept. No shared state, any thread. Calls cell_sets.get on the calling thread only, unless it may be called on any.
status encode(const file_contents& contents, std::vector<std::byte>& out);

// Replaces a file on disk: writes a temporary file in the folder of path, flushes it to the disk, renames it to path
// and flushes the folder. So path has either its old content or all of the new one.
// path: UTF-8. If it exists it must be a file: a device or a folder is not replaced.
// Fails with io (disk full, no permission, not a file); the temporary file is removed then.
status write_file(const char* path, std::span<const std::byte> bytes);

// Removes the temporary files of writers of path that were killed. Only for callers that know that no other writer of
// path is running, because its temporary file would be removed too.
void remove_unfinished(const char* path);

}  // namespace sightcell::format
