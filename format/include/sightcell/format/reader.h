#pragma once
// Reads a .pvs file (format/SPEC.md) that lies in the caller's memory. Every byte is taken as hostile: no value of the
// file is used before it is checked, and none is trusted when read again, so that nothing here leaves its buffers even
// when somebody changes the bytes meanwhile. No exceptions, no allocation, no state: every function is const and may
// run on any number of threads at once.
//
//   reader file;
//   if (status s = reader::open(bytes, file); s != status::ok) return s;
//   std::vector<std::byte> memory(file.codes_size()), scratch(file.scratch_size());
//   const row_codes* codes = nullptr;
//   if (status s = file.make_codes(memory, codes); s != status::ok) return s;
//   std::vector<run> row(file.run_bound());
//   for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
//     std::size_t runs = 0;
//     status s = file.decode_row(cell, codes, row, scratch, runs);   // row[0 .. runs): what the cell sees
//   }
//
// format_write has the same in one object: set_reader.h.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/named_group_table.h"
#include "sightcell/format/packed_columns.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"
#include "sightcell/format/volume_table.h"

namespace sightcell::format {

// The code tables of a file, which lie in the caller's memory. Made by reader::make_codes, read by any number of
// threads.
struct row_codes;
class importance_classes;  // importance_classes.h

// One entry of the section table, for tools.
struct section_record {
  std::uint32_t id = 0;  // layout.h: section_*; other ids are optional sections that this version does not know
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

// A cell set as its polygons and its volumes.
struct row_parts {
  std::span<const run> polygons;  // in stored order: ascending, disjoint, not touching, inside polygon_count
  std::span<const run> volumes;   // the same of volumes, by their own numbers: inside volumes().count()
};

// Sums over all cells. A row shared by several cells counts for each of them, except in row_bytes.
struct row_statistics {
  std::uint64_t cells = 0;
  std::uint64_t polygons = 0;         // sum of the polygons of all cell sets
  std::uint64_t runs = 0;             // sum of runs of polygons in stored order
  std::uint64_t ranges = 0;           // sum of (draw, first, count) ranges
  std::uint64_t volumes = 0;          // sum of the volumes of all cell sets
  std::uint64_t volume_runs = 0;      // sum of runs of these
  std::uint64_t delta_rows = 0;       // cells whose row is a difference
  std::uint64_t shared_rows = 0;      // cells that use an earlier cell's row
  std::uint64_t row_bytes = 0;        // size of the rows section
  std::uint64_t directory_bytes = 0;  // size of the row directory and the code tables

  [[nodiscard]] double runs_per_cell() const { return per_cell(static_cast<double>(runs)); }
  [[nodiscard]] double ranges_per_cell() const { return per_cell(static_cast<double>(ranges)); }
  [[nodiscard]] double delta_row_percent() const { return per_cell(100.0 * static_cast<double>(delta_rows)); }
  [[nodiscard]] double shared_row_percent() const { return per_cell(100.0 * static_cast<double>(shared_rows)); }
  [[nodiscard]] double volumes_per_cell() const { return per_cell(static_cast<double>(volumes)); }
  [[nodiscard]] double volume_runs_per_cell() const { return per_cell(static_cast<double>(volume_runs)); }
  // Bits per (cell, visible polygon): rows, with what volumes take of them, directory and code tables. 0 when no cell
  // sees anything.
  [[nodiscard]] double bits_per_visible_polygon() const {
    return polygons == 0 ? 0.0 : 8.0 * static_cast<double>(row_bytes + directory_bytes) / static_cast<double>(polygons);
  }

 private:
  [[nodiscard]] double per_cell(double sum) const { return cells == 0 ? 0.0 : sum / static_cast<double>(cells); }
};

// A view of one file: cheap to copy, valid as long as the bytes are. A default-made reader is an empty file.
class reader {
 public:
  // Checks the header, the section table, the draw table, the named groups, the cells, the volumes, the row directory,
  // the certificate and the settings, with their checksums; rows are left to check_chunk and decode_row. bytes: the
  // whole file and nothing behind it, any alignment; they stay the caller's and must outlive out. out is set only on
  // ok. not_ours: no .pvs file; version: a version, or a required section, of another Sightcell; truncated: fewer bytes
  // than the header says; checksum; corrupt: values that contradict each other, bytes behind the end; limit: a number
  // above layout.h.
  static status open(std::span<const std::byte> bytes, reader& out) noexcept;

  // For who keeps rows elsewhere. front_size: how many bytes from the start of a file hold all that open looks at;
  // begin: its first bytes, min(total_size, most_header_bytes) of them. open_front: open with these alone, of which no
  // more is to be asked than facts, tables, chunk_place, and rows whose chunk the caller brings. A file of version 0
  // has no such front: version. total_size: of the whole file, bytes.
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
  // At least the most (draw, first, count) ranges of any cell set: the most there are where volumes count as the
  // polygons of one more draw behind the last.
  [[nodiscard]] std::uint32_t range_bound() const noexcept { return range_bound_; }

  // One record, in stored order, read and checked anew. argument: number too high; corrupt: the bytes changed since
  // open.
  status draw(std::uint32_t number, draw_record& out) const noexcept;
  status cell_box(std::uint32_t cell, box& out) const noexcept;

  // What ranges count in, in stored order: draws, or draw groups of the merged layout.
  [[nodiscard]] std::uint32_t range_unit_count() const noexcept { return range_units_; }
  // Stored number of the first polygon of one, read anew; number may be range_unit_count().
  [[nodiscard]] std::uint32_t range_unit_begin(std::uint32_t number) const noexcept;

  // In which order polygons are stored: draws share orders, numbered 0 .. order_count() - 1. A draw group has the order
  // of its number.
  [[nodiscard]] std::uint32_t order_count() const noexcept { return order_count_; }
  // Which order a draw has, and how many polygons all orders before one have together (number may be order_count()).
  // 0 for numbers that there are not.
  [[nodiscard]] std::uint32_t order_of_draw(std::uint32_t draw) const noexcept;
  [[nodiscard]] std::uint32_t order_begin(std::uint32_t number) const noexcept;
  // All orders, one behind the other: which polygon of its draw, or draw group, as the source has them, is stored at
  // each place. out: order_begin(order_count()) numbers, all below the count of their order when the answer is ok.
  // argument: another size; corrupt. That no polygon is there twice is left to check().
  status orders(std::span<std::uint32_t> out) const noexcept;
  // The source id of every stored polygon. out: polygon_count() numbers, all below that when the answer is ok. Else as
  // orders().
  status source_of_stored(std::span<std::uint32_t> out) const noexcept;

  // The cells' lattice, where they lie on one: chunk by chunk for who looks cells up. Null where they do not.
  [[nodiscard]] const cell_lattice* lattice() const noexcept { return on_lattice_ ? &lattice_ : nullptr; }

  // What the host shows and hides by name: draw_record::named_group counts in them. None in most files.
  [[nodiscard]] const named_group_table& named_groups() const noexcept { return named_groups_; }

  // The volumes, which sets hold behind the polygons: volume v is number polygon_count() + v there. None in most files.
  [[nodiscard]] const volume_table& volumes() const noexcept { return volumes_; }

  // The section table in file order, for tools. argument: number too high; corrupt: the bytes changed since open.
  [[nodiscard]] std::uint32_t section_count() const noexcept { return section_count_; }
  status section(std::uint32_t number, section_record& out) const noexcept;

  // The settings text (JSON) that made the file, empty when there is none. Points into the caller's bytes.
  [[nodiscard]] std::string_view settings() const noexcept;

  // 0 or cell_count(). argument: number too high; corrupt: the bytes changed since open.
  [[nodiscard]] std::uint32_t certificate_count() const noexcept { return certificate_count_; }
  status certificate(std::uint32_t number, certificate_record& out) const noexcept;

  // Rows lie in chunks of 64 consecutive cells; a chunk is decoded without any other and has its own checksum.
  [[nodiscard]] std::uint32_t chunk_count() const noexcept;
  [[nodiscard]] static std::uint32_t chunk_of(std::uint32_t cell) noexcept;
  // ok, or checksum when the chunk's bytes are damaged; argument: no such chunk. Reads the whole chunk: remember it.
  status check_chunk(std::uint32_t chunk) const noexcept;
  // Where a chunk lies in the file, and whether these bytes are its own: for who keeps it elsewhere.
  status chunk_place(std::uint32_t chunk, std::uint64_t& offset, std::uint32_t& size) const noexcept;
  status check_chunk(std::uint32_t chunk, std::span<const std::byte> bytes) const noexcept;

  // How a cell's row is stored. argument: no such cell; corrupt.
  status row(std::uint32_t cell, row_record& out) const noexcept;

  // Bytes that the code tables take (about 110,000; 0 in version 0), and making them there: memory of that size at a
  // multiple of 8, which must outlive their use. capacity: less memory; corrupt: no codes.
  [[nodiscard]] std::size_t codes_size() const noexcept;
  status make_codes(std::span<std::byte> memory, const row_codes*& out) const noexcept;
  // Bytes of scratch that decode_row needs, at a multiple of 4.
  [[nodiscard]] std::size_t scratch_size() const noexcept;

  // The polygons of the cell set as runs in stored order: ascending, disjoint, not touching, inside polygon_count. out
  // must hold run_bound() runs, scratch scratch_size() bytes; both are overwritten, out[0 .. count) is the answer.
  // codes: of this file. Looks at no checksum: call check_chunk once before. O(runs of the row and its references).
  // argument: no such cell, no codes; capacity: out or scratch too small; corrupt: the row is no row (count is 0 then).
  status decode_row(std::uint32_t cell, const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
                    std::size_t& count) const noexcept;
  // The same with the volumes of the set, both in out, which must hold row_room() runs: a run may go from polygons on
  // to volumes, and is two then. parts is empty when the answer is not ok.
  [[nodiscard]] std::size_t row_room() const noexcept {
    return std::size_t{run_bound_} + (volumes_.count() > 0 ? 1u : 0u);
  }
  status decode_row(std::uint32_t cell, const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
                    row_parts& parts) const noexcept;
  // The same with the cell's chunk from elsewhere; not for version 0 (version).
  status decode_row(std::uint32_t cell, std::span<const std::byte> chunk, const row_codes* codes, std::span<run> out,
                    std::span<std::byte> scratch, row_parts& parts) const noexcept;

  // How many (draw, first, count) ranges the polygons of runs make. runs: as decode_row gives them.
  [[nodiscard]] std::uint64_t count_ranges(std::span<const run> runs) const noexcept;

  // Is there an importance section, for the order of polygons inside a cell?
  [[nodiscard]] bool has_importance() const noexcept { return has_importance_; }
  // Opens it: open() leaves all of it out, as a file is as good without. argument: there is none; else as
  // importance_classes::open.
  status importance(importance_classes& out) const noexcept;

  // Everything open leaves out: every section's checksum, every chunk and row, that rows fill their chunks without gaps
  // and keep the bounds, importance, that every source id is stored once, that no two volumes are the same. out,
  // scratch, codes: as for decode_row; stored: room for check_room() numbers. ok, or the first fault found.
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
  status check_stored(std::span<std::uint32_t> stored) const noexcept;
  status check_rows(const row_codes* codes, std::span<run> out, std::span<std::byte> scratch) const noexcept;
  // What sets are of: polygons, and volumes behind them.
  [[nodiscard]] std::uint32_t item_count() const noexcept { return facts_.polygon_count + volumes_.count(); }
  status decode_items(std::uint32_t cell, const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
                      std::size_t& count) const noexcept;
  status decode_items(std::uint32_t cell, std::span<const std::byte> chunk, const row_codes* codes, std::span<run> out,
                      std::span<std::byte> scratch, std::size_t& count) const noexcept;
  [[nodiscard]] row_parts split(std::span<run> out, std::size_t count) const noexcept;
  status check_importance(const row_codes* codes, std::span<run> out, std::span<std::byte> scratch,
                          std::span<std::uint8_t> classes) const noexcept;
  status chunk_extent(std::uint32_t chunk, extent& out, std::uint32_t& checksum) const noexcept;
  [[nodiscard]] std::uint32_t rows_of_chunk(std::uint32_t chunk) const noexcept;
  status check_chunk_filled(std::uint32_t chunk, const row_codes* codes, std::span<std::byte> scratch) const noexcept;

  // Version 0, in reader_v0.cpp.
  status v0_draw(std::uint32_t number, draw_record& out) const noexcept;
  status v0_certificate(std::uint32_t number, certificate_record& out) const noexcept;
  status v0_row_bytes(std::uint32_t cell, row_place& out) const noexcept;
  status v0_row(std::uint32_t cell, row_record& out) const noexcept;
  status v0_decode_row(std::uint32_t cell, std::span<run> out, std::span<run> scratch,
                       std::size_t& count) const noexcept;
  status v0_check_chunk_filled(std::uint32_t chunk) const noexcept;

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
      named_group_bytes_;
  bool has_importance_ = false;
  bool has_volumes_ = false;
  bool has_named_groups_ = false;
  bool on_lattice_ = false;
  cell_lattice lattice_;
  volume_table volumes_;
  named_group_table named_groups_;
  std::array<packed_column, layout::draw_columns> draw_columns_;
  std::array<packed_column, layout::certificate_columns> certificate_columns_;
  packed_column order_begin_;
};

}  // namespace sightcell::format
