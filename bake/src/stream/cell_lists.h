#pragma once
// The pages, draws and images that each cell needs, and the chunks that clients load them in (docs/streaming.md, "Cell
// chunks").
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sightcell/format/records.h"
#include "sightcell/scene/stream_pages.h"
#include "stream/page_plan.h"
#include "stream/payload.h"
#include "stream/polygon_numbers.h"
#include "stream/visible_polygons.h"

namespace sightcell::bake {

struct weighted_number {
  std::uint32_t number = 0;
  float weight = 0.0f;  // solid angle in sr
};

// A page, with the directions that its visible polygons are in: bit k for headings of 45 k to 45 (k + 1) degrees.
struct listed_page {
  std::uint32_t number = 0;
  float weight = 0.0f;
  std::uint8_t sectors = 0;
};

struct streamed_cell {
  std::uint32_t cell = 0;
  format::box box;
  float weight = 0.0f;                  // of all its polygons
  std::vector<listed_page> pages;       // ascending
  std::vector<std::uint32_t> draws;     // ascending, without those that are in every cell
  std::vector<weighted_number> images;  // ascending
};

// Makes the list of one cell after the other.
class cell_lists {
 public:
  // All arguments must outlive the object.
  cell_lists(const scene::gltf_pager& pager, const polygon_numbers& numbers, const page_plan& plan);

  // polygons: with the set of the cell read.
  streamed_cell list_of(std::uint32_t cell, const visible_polygons& polygons);

 private:
  const scene::gltf_pager& pager_;
  const polygon_numbers& numbers_;
  const page_plan& plan_;
  // Weights by number; entries of this cell are in `used`.
  struct sums {
    std::vector<double> weights;
    std::vector<bool> is_used;
    std::vector<std::uint32_t> used;
    void add(std::uint32_t number, double weight);
    std::vector<weighted_number> take();
  };
  std::vector<listed_page> with_sectors(const std::vector<weighted_number>& pages);

  sums pages_, draws_, images_;
  std::vector<std::array<double, 8>> sectors_;  // by page; those of pages that are not used are 0
};

// Returns the payload of a chunk.
payload chunk_payload(std::span<const streamed_cell* const> cells);

// Divides cells at the middle of their longest axis, and the halves again, until each part is a file of at most `limit`
// bytes or one cell. So few boxes of chunks contain a point.
// cells: their order changes.
// use: receives the file and the cells of each chunk.
// Cost: O(n log n) bytes are deflated.
void write_chunks(std::span<streamed_cell> cells, std::size_t limit,
                  const std::function<void(std::vector<std::uint8_t> file, std::span<const streamed_cell> cells)>& use);

}  // namespace sightcell::bake
