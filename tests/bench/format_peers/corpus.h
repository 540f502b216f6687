#pragma once
// The cell sets of a .pvs file, read through the C ABI: whatever version the file has. How its rows are coded is the
// only thing that the format's reader says.
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "sightcell/sightcell.h"

namespace sightcell::bench {

// Source ids first .. first + count - 1.
struct id_run {
  std::uint32_t first, count;
  bool operator==(const id_run&) const = default;
};

struct close_db {
  void operator()(sightcell_db* db) const { sightcell_db_close(db); }
};
struct destroy_view {
  void operator()(sightcell_view* view) const { sightcell_view_destroy(view); }
};
using db_handle = std::unique_ptr<sightcell_db, close_db>;
using view_handle = std::unique_ptr<sightcell_view, destroy_view>;

struct corpus {
  db_handle db;
  sightcell_info info{};
  std::uint64_t file_bytes = 0;
  std::vector<std::array<float, 3>> middles;  // of the cells
  std::vector<std::vector<id_run>> runs;      // of the cells, in source order, as long as can be
  std::vector<std::uint32_t> ranges;          // of the cells, as delivered
  std::vector<std::uint8_t> depth;  // of the cells' rows: how many others each is the difference to, one after another
  std::uint64_t most_polygons = 0;  // in a cell

  std::uint64_t visible = 0;  // polygons of all cells
  std::uint64_t run_count = 0, range_count = 0;
  std::uint64_t polygons_seen = 0;  // by any cell
  std::uint64_t atoms = 0;          // sets of cells that some polygons are seen from, and no others
};

// Throws std::runtime_error where the file cannot be opened, where an output contradicts another, and where the middle
// of a cell is in another one.
corpus read_corpus(const std::filesystem::path& file);

view_handle make_view(const corpus& of);

// Throws with the name of what failed.
void require(sightcell_status status, const char* what);

// The ids of runs, in place of what ids held.
void expand(std::span<const id_run> runs, std::vector<std::uint32_t>& ids);

}  // namespace sightcell::bench
