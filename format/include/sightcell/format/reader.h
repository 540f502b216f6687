#pragma once
// Reads a .pvs file (format/SPEC.md) from the caller's memory. Safe for hostile bytes: each value of the file is
// checked before it is used, and checked again when it is read again, so that no access leaves its buffers even if the
// bytes change meanwhile. No exceptions, no allocation, no state: every function is const and may run on any number of
// threads at once.
//
//   reader file;
//   if (status s = reader::open(bytes, file); s != status::ok) return s;
//   std::vector<std::byte> memory(file.codes_size()), scratch(file.scratch_size());
//   const row_codes* codes = nullptr;
//   if (status s = file.make_codes(memory, codes); s != status::ok) return s;
//   std::vector<run> row(file.run_bound());
//   for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
//     std::size_t runs = 0;
//     status s = file.decode_row(cell, codes, row, scratch, runs);   // row[0 .. runs): the set of the cell
//   }
//
// The statuses that a function returns besides ok are listed with it. format_write has all of this in one object:
// set_reader.h.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/chunk_borders.h"
#include "sightcell/format/cluster_table.h"
#include "sightcell/format/grid_boxes.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/named_group_table.h"
#include "sightcell/format/packed_columns.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"
#include "sightcell/format/viewpoint_table.h"
#include "sightcell/format/volume_table.h"

namespace sightcell::format {

// The code tables of a file, and its clusters, in the caller's memory. Made by reader::make_codes, used by any number
// of threads.
struct row_codes;
struct row_bounds;
class importance_classes;  // importance_classes.h

// One entry of the section table, for tools.
struct section_record {
  std::uint32_t id = 0;  // layout.h: section_*; other ids are optional sections that this reader skips
  bool required = false;
  std::uint64_t offset = 0;  // bytes from the start of the file
  std::uint64_t size = 0;    // bytes
};

// How the row of one cell is stored.
struct row_record {
  std::uint32_t size = 0;       // bytes of the row; cells with the same set share one row
  bool delta = false;           // coded as the difference to a reference cell
  bool shared = false;          // an earlier cell of the chunk has the same row
  std::uint32_t reference = 0;  // the reference cell; only where delta
};

// A cell set, divided into polygons and volumes.
struct row_parts {
  std::span<const run> polygons;  // in stored order: ascending, disjoint, not touching, inside polygon_count
  std::span<const run> volumes;   // the same for volumes, by their own numbers: below volumes().count()
};

// Sums over all cells. A row shared by several cells counts for each of them, except in row_bytes.
struct row_statistics {
  std::uint64_t cells = 0;
  std::uint64_t polygons = 0;         // sum of the polygons of all cell sets
  std::uint64_t runs = 0;             // sum of runs of polygons in stored order
  std::uint64_t ranges = 0;           // sum of (draw, first, count) ranges
  std::uint64_t draws = 0;            // sum of the draws, or draw groups, with a polygon in the set
  std::uint64_t joined_ranges = 0;    // sum of ranges where those with less than joined_gap polygons between are one
  std::uint64_t clusters = 0;         // sum of the clusters of all cell sets; 0 for a file without clusters
  std::uint64_t volumes = 0;          // sum of the volumes of all cell sets
  std::uint64_t volume_runs = 0;      // sum of runs of volumes
  std::uint64_t delta_rows = 0;       // cells whose row is a difference
  std::uint64_t shared_rows = 0;      // cells that use an earlier cell's row
  std::uint64_t row_bytes = 0;        // size of the rows section
  std::uint64_t chunks = 0;           // parts of the rows that are read and checked as one
  std::uint64_t largest_chunk = 0;    // bytes
  std::uint64_t directory_bytes = 0;  // size of the row directory, the chunk borders and the code tables

  static constexpr std::uint32_t joined_gap = 64;

  [[nodiscard]] double draws_per_cell() const { return per_cell(static_cast<double>(draws)); }
  [[nodiscard]] double joined_ranges_per_cell() const { return per_cell(static_cast<double>(joined_ranges)); }
  [[nodiscard]] double runs_per_cell() const { return per_cell(static_cast<double>(runs)); }
  [[nodiscard]] double ranges_per_cell() const { return per_cell(static_cast<double>(ranges)); }
  [[nodiscard]] double delta_row_percent() const { return per_cell(100.0 * static_cast<double>(delta_rows)); }
  [[nodiscard]] double shared_row_percent() const { return per_cell(100.0 * static_cast<double>(shared_rows)); }
  [[nodiscard]] double cells_per_chunk() const {
    return chunks == 0 ? 0.0 : static_cast<double>(cells) / static_cast<double>(chunks);
  }
  [[nodiscard]] double clusters_per_cell() const { return per_cell(static_cast<double>(clusters)); }
  [[nodiscard]] double volumes_per_cell() const { return per_cell(static_cast<double>(volumes)); }
  [[nodiscard]] double volume_runs_per_cell() const { return per_cell(static_cast<double>(volume_runs)); }

  // Bits per (cell, visible polygon): rows including their volumes, directory and code tables. 0 if all sets are empty.
  [[nodiscard]] double bits_per_visible_polygon() const {
    return polygons == 0 ? 0.0 : 8.0 * static_cast<double>(row_bytes + directory_bytes) / static_cast<double>(polygons);
  }

 private:
  [[nodiscard]] double per_cell(double sum) const { return cells == 0 ? 0.0 : sum / static_cast<double>(cells); }
};

// A view of one file: cheap to copy, valid as long as the bytes are. A default-constructed reader is an empty file.
class reader {
 public:
  // Opens a file. Checks header, section table, draw table, named groups, cells, volumes, chunks, certificate,
  // viewpoints without the trees of regions, and settings, with their checksums. check_chunk and decode_row check the
  // rows.
  // bytes: the whole file and nothing after it, at any alignment. They belong to the caller and must outlive out.
  // out: set only on ok.
  // Fails with not_ours (not a .pvs file), version (another version, or a required section that this reader does not
  //   know), truncated (fewer bytes than the header requires), checksum, corrupt (values that contradict each other,
  //   bytes after the end), limit (a number above those of layout.h).
  static status open(std::span<const std::byte> bytes, reader& out) noexcept;

  // For callers that keep the rows elsewhere.
  // front_size: the number of bytes from the start of a file that contain everything that open checks. begin: its first
  //   min(total_size, most_header_bytes) bytes. version: a file of version 0, which has no such front.
  // open_front: opens a file with these bytes only. The reader then has facts, tables, chunk_place, and rows whose
  //   chunk the caller passes.
  // total_size: of the whole file, in bytes.
  static constexpr std::size_t most_header_bytes =
      layout::header_size + std::size_t{layout::max_sections} * layout::section_record_size;
  static status front_size(std::span<const std::byte> begin, std::uint64_t total_size, std::uint64_t& out) noexcept;
  static status open_front(std::span<const std::byte> front, std::uint64_t total_size, reader& out) noexcept;

  [[nodiscard]] const file_facts& facts() const noexcept { return facts_; }
  [[nodiscard]] std::uint32_t format_version() const noexcept { return version_; }
  [[nodiscard]] std::uint32_t polygon_count() const noexcept { return facts_.polygon_count; }
  [[nodiscard]] std::uint32_t cell_count() const noexcept { return cell_count_; }
  [[nodiscard]] std::uint32_t draw_count() const noexcept { return draw_count_; }
  [[nodiscard]] std::uint64_t total_size() const noexcept { return total_size_; }

  // The most runs of any row, volumes included: the room that decode_row needs for polygons. At most four times the
  // size of the rows section in bytes.
  [[nodiscard]] std::uint32_t run_bound() const noexcept { return run_bound_; }

  // At least the most (draw, first, count) ranges of any set. Exact if volumes count as the polygons of one more draw
  // after the last.
  [[nodiscard]] std::uint32_t range_bound() const noexcept { return range_bound_; }

  // One record in stored order, checked again. argument: number too high; corrupt: the bytes changed since open.
  status draw(std::uint32_t number, draw_record& out) const noexcept;
  status cell_box(std::uint32_t cell, box& out) const noexcept;

  // Range units are draws, or draw groups of the merged layout, in stored order: ranges count in them.
  [[nodiscard]] std::uint32_t range_unit_count() const noexcept { return range_units_; }

  // Stored number of the first polygon of a range unit, read again. number: up to range_unit_count().
  [[nodiscard]] std::uint32_t range_unit_begin(std::uint32_t number) const noexcept;

  // Draws share polygon orders, numbered 0 .. order_count() - 1. A draw group has the order of its own number.
  [[nodiscard]] std::uint32_t order_count() const noexcept { return order_count_; }

  // The order of a draw, and the number of polygons of all orders before one (number: up to order_count()). 0 for
  // numbers that do not exist.
  [[nodiscard]] std::uint32_t order_of_draw(std::uint32_t draw) const noexcept;
  [[nodiscard]] std::uint32_t order_begin(std::uint32_t number) const noexcept;

  // All orders, one after the other: the polygon of the draw, or draw group, in source order that is stored at each
  // index.
  // out: order_begin(order_count()) numbers, each below the count of its order on ok. argument: another size; corrupt.
  //   check() tests that each polygon is there once.
  status orders(std::span<std::uint32_t> out) const noexcept;

  // The source id of each stored polygon. out: polygon_count() numbers, each below polygon_count() on ok. Fails as
  // orders().
  status source_of_stored(std::span<std::uint32_t> out) const noexcept;

  // The lattice of the cells, chunk by chunk, for cell lookups. Null unless cells are on one.
  [[nodiscard]] const cell_lattice* lattice() const noexcept {
    return cell_kind_ == layout::cells_are_on_lattice ? &lattice_ : nullptr;
  }

  // The places of the cells on their grid, for tools. Null unless cells are on one.
  [[nodiscard]] const grid_boxes* grid() const noexcept {
    return cell_kind_ == layout::cells_are_on_grid ? &grid_ : nullptr;
  }

  // The named groups of the file, mostly none. draw_record::named_group is a number in it.
  [[nodiscard]] const named_group_table& named_groups() const noexcept { return named_groups_; }

  // The valid viewpoints of the cells; viewpoints().exists() is false for a file without this section.
  [[nodiscard]] const viewpoint_table& viewpoints() const noexcept { return viewpoints_; }

  // The bytes of a section that open skips: an optional one that it does not know. absent: there is none; checksum;
  // corrupt: there are two. For a paged file, the front contains them. O(bytes of the section).
  [[nodiscard]] status skipped_section(std::uint32_t id, std::span<const std::byte>& out) const noexcept;

  // The clusters of a file whose sets are of clusters; clusters().exists() is false for most. A set contains whole
  // clusters: decode_row converts them to runs of polygons.
  [[nodiscard]] const cluster_table& clusters() const noexcept { return clusters_; }

  // The number of clusters of all range units together; 0 for a file without clusters.
  [[nodiscard]] std::uint32_t cluster_count() const noexcept { return cluster_count_; }

  // Where the clusters of a file with clusters begin: a part of codes.
  [[nodiscard]] static const cluster_borders& borders_of_clusters(const row_codes& codes) noexcept;

  // The volumes of the file, mostly none. In sets, volume v has the number polygon_count() + v.
  [[nodiscard]] const volume_table& volumes() const noexcept { return volumes_; }

  // The section table in file order, for tools. argument: number too high; corrupt: the bytes changed since open.
  [[nodiscard]] std::uint32_t section_count() const noexcept { return section_count_; }
  status section(std::uint32_t number, section_record& out) const noexcept;

  // The settings (JSON text) that made the file, empty if there are none. Points into the caller's bytes.
  [[nodiscard]] std::string_view settings() const noexcept;

  // 0 or cell_count(). argument: number too high; corrupt: the bytes changed since open.
  [[nodiscard]] std::uint32_t certificate_count() const noexcept { return certificate_count_; }
  status certificate(std::uint32_t number, certificate_record& out) const noexcept;

  // Rows are in chunks of up to 64 consecutive cells. A chunk is decoded without any other and has its own checksum.
  // chunk_of: the number of the chunk of a cell below cell_count().
  [[nodiscard]] std::uint32_t chunk_count() const noexcept { return chunks_.chunks(); }
  [[nodiscard]] std::uint32_t chunk_of(std::uint32_t cell) const noexcept { return chunks_.chunk_of(cell).number; }
  [[nodiscard]] const chunk_borders& chunks() const noexcept { return chunks_; }

  // ok, or checksum if the chunk's bytes are damaged; argument: no such chunk. Reads the whole chunk: remember the
  // result.
  status check_chunk(std::uint32_t chunk) const noexcept;

  // For callers that keep chunks elsewhere: where a chunk is in the file, and whether bytes are those of the chunk.
  status chunk_place(std::uint32_t chunk, std::uint64_t& offset, std::uint32_t& size) const noexcept;
  status check_chunk(std::uint32_t chunk, std::span<const std::byte> bytes) const noexcept;

  // How a cell's row is stored. argument: no such cell; corrupt.
  status row(std::uint32_t cell, row_record& out) const noexcept;

  // The size of the code tables (about 62,000 bytes, and with clusters 4 bytes for each cluster of an order and 12 for
  // each range unit; 0 in version 0). make_codes makes them in memory of this size at
  // a multiple of 8, which must outlive their use. capacity: less memory; corrupt: invalid codes.
  [[nodiscard]] std::size_t codes_size() const noexcept;
  status make_codes(std::span<std::byte> memory, const row_codes*& out) const noexcept;

  // Bytes of scratch that decode_row needs, at a multiple of 4.
  [[nodiscard]] std::size_t scratch_size() const noexcept;

  // Decodes the polygons of a cell set as runs in stored order: ascending, disjoint, not touching, inside
  // polygon_count.
  // codes: of this file.
  // out: run_bound() runs or more; out[0 .. count) is the result.
  // scratch: scratch_size() bytes or more. Both buffers are overwritten.
  // Checks no checksum: call check_chunk once before. O(runs of the row and its references).
  // Fails with argument (no such cell, no codes), capacity (out or scratch too small), corrupt (not a valid row; count
  //   is 0).
  status decode_row(std::uint32_t cell, const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
                    std::size_t& count) const noexcept;

  // The same with the volumes of the set. out: row_room() runs or more, one more since a run may extend from polygons
  // into volumes and is divided. parts is empty on failure.
  [[nodiscard]] std::size_t row_room() const noexcept {
    return std::size_t{run_bound_} + (volumes_.count() > 0 ? 1u : 0u);
  }
  status decode_row(std::uint32_t cell, const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
                    row_parts& parts) const noexcept;

  // The same with the bytes of the cell's chunk. version: for a file of version 0.
  status decode_row(std::uint32_t cell, std::span<const std::byte> chunk, const row_codes* codes, std::span<run> out,
                    std::span<std::byte> scratch, row_parts& parts) const noexcept;

  // The number of (draw, first, count) ranges of runs from decode_row.
  [[nodiscard]] std::uint64_t count_ranges(std::span<const run> runs) const noexcept;
  void add_draw_calls(std::span<const run> runs, row_statistics& sums) const noexcept;

  // Whether there is an importance section, which orders the polygons of each cell.
  [[nodiscard]] bool has_importance() const noexcept { return has_importance_; }

  // Opens the importance section, of which open() checks nothing. argument: there is none; else as
  // importance_classes::open.
  status importance(importance_classes& out) const noexcept;

  // Checks what open leaves out: the checksum of every section, every chunk and row, that rows fill their chunks
  // without gaps and keep the bounds, the importance, that each source id is stored once, that no two volumes are the
  // same, the regions of viewpoints. Returns ok or the first fault. out, scratch, codes: as for decode_row; stored:
  // room for check_room() numbers.
  [[nodiscard]] std::size_t check_room() const noexcept;
  status check(const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
               std::span<std::uint32_t> stored) const noexcept;

  // Decodes every row and sums. Checks chunks first. out: row_room() runs; scratch, codes: as for decode_row.
  status statistics(const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
                    row_statistics& sums) const noexcept;

 private:
  struct extent {
    std::uint64_t offset = 0;
    std::uint64_t size = 0;
  };
  // Of version 0.
  struct row_place {
    std::span<const std::byte> bytes;
    std::uint32_t offset = 0;  // inside the chunk
  };

  [[nodiscard]] std::span<const std::byte> part(extent where) const noexcept;
  status open_all() noexcept;
  status read_header() noexcept;
  status read_sections() noexcept;
  status check_section(std::uint32_t number) const noexcept;
  status check_sizes() noexcept;
  status open_tables() noexcept;
  status check_bounds() const noexcept;
  status check_draws() noexcept;
  [[nodiscard]] std::uint32_t order_size(std::uint32_t number) const noexcept;
  [[nodiscard]] std::uint32_t first_draw_of(std::uint32_t range_unit) const noexcept;
  status make_sources(std::uint32_t range_unit, std::span<std::uint32_t> polygons) const noexcept;
  status check_cells() const noexcept;
  status check_directory() const noexcept;
  status check_certificate() const noexcept;
  status check_regions() const noexcept;
  status check_stored(std::span<std::uint32_t> stored) const noexcept;
  status check_rows(const row_codes* codes, std::span<run> out, std::span<std::byte> scratch) const noexcept;

  // The numbers in rows: polygons, or clusters, then volumes.
  [[nodiscard]] std::uint32_t column_count() const noexcept {
    return clusters_.exists() ? cluster_count_ : facts_.polygon_count;
  }
  [[nodiscard]] std::uint32_t item_count() const noexcept { return column_count() + volumes_.count(); }
  [[nodiscard]] row_bounds bounds() const noexcept;
  status open_clusters() noexcept;
  [[nodiscard]] bool fill_clusters(row_codes& codes, std::span<std::byte> memory) const noexcept;
  status decode_items(std::uint32_t cell, const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
                      std::size_t& count) const noexcept;
  status decode_items(std::uint32_t cell, std::span<const std::byte> chunk, const row_codes* codes, std::span<run> out,
                      std::span<std::byte> scratch, std::size_t& count) const noexcept;
  [[nodiscard]] row_parts split(std::span<run> out, std::size_t count) const noexcept;
  status check_importance(const row_codes* codes, std::span<run> out, std::span<std::byte> scratch) const noexcept;
  status chunk_extent(std::uint32_t chunk, extent& out, std::uint32_t& checksum) const noexcept;
  status check_chunk_filled(const cell_chunk& chunk, const row_codes* codes,
                            std::span<std::byte> scratch) const noexcept;

  // Version 0, in reader_v0.cpp. A constant where the reader is built without it.
  [[nodiscard]] bool is_v0() const noexcept { return layout::oldest_version == 0 && version_ == 0; }
  status v0_draw(std::uint32_t number, draw_record& out) const noexcept;
  status v0_certificate(std::uint32_t number, certificate_record& out) const noexcept;
  status v0_row_bytes(std::uint32_t cell, row_place& out) const noexcept;
  status v0_row(std::uint32_t cell, row_record& out) const noexcept;
  status v0_decode_row(std::uint32_t cell, std::span<run> out, std::span<run> scratch,
                       std::size_t& count) const noexcept;
  status v0_check_chunk_filled(const cell_chunk& chunk) const noexcept;

  std::span<const std::byte> bytes_;  // all of the file, or its front
  std::uint64_t total_size_ = 0;
  file_facts facts_;
  std::uint32_t version_ = 0;
  std::uint32_t cell_count_ = 0;
  std::uint32_t draw_count_ = 0;
  std::uint32_t range_units_ = 0;
  std::uint32_t order_count_ = 0;
  std::uint32_t section_count_ = 0;
  std::uint32_t certificate_count_ = 0;
  std::uint32_t run_bound_ = 0;
  std::uint32_t range_bound_ = 0;
  std::uint32_t list_bound_ = 0;
  extent draws_, cells_, rows_, directory_, certificate_, settings_, orders_, codes_, importance_, volume_bytes_,
      named_group_bytes_, viewpoint_bytes_, border_bytes_, cluster_bytes_;
  bool has_importance_ = false;
  bool has_volumes_ = false;
  bool has_named_groups_ = false;
  bool has_viewpoints_ = false;
  bool has_borders_ = false;
  bool has_clusters_ = false;
  chunk_borders chunks_;
  std::uint32_t cell_kind_ = layout::cells_are_boxes;
  cell_lattice lattice_;
  grid_boxes grid_;
  cluster_table clusters_;
  std::uint32_t cluster_count_ = 0;
  volume_table volumes_;
  named_group_table named_groups_;
  viewpoint_table viewpoints_;
  std::array<packed_column, layout::draw_columns> draw_columns_;
  std::array<packed_column, layout::certificate_columns> certificate_columns_;
  packed_column order_begin_;
};

}  // namespace sightcell::format
