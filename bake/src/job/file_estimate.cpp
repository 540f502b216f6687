#include "job/file_estimate.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "file/pvs_output.h"
#include "search/radical_inverse.h"

namespace sightcell::bake {
namespace {

// The bytes of a file grow with this power of the number of cells: the more of them there are, the less do neighbors
// differ, and the order of polygons is stored once. Files of some cells of whole bakes, 5 choices of 8 to 32 cells
// each, had powers of 0.50 to 0.65. With 0.6, estimates are 0.77 to 1.31 times the file (czest3ctf, zdm2, sponza,
// accident, denhaag_01).
constexpr double growth = 0.6;
constexpr double smallest_cell = 24.0;  // bytes: certificate, viewpoints and place

}  // namespace

std::vector<std::uint32_t> choose_trials(std::size_t cells, std::size_t count) {
  std::vector<std::uint32_t> parts(count);
  std::iota(parts.begin(), parts.end(), 0u);
  std::stable_sort(parts.begin(), parts.end(),
                   [](std::uint32_t a, std::uint32_t b) { return radical_inverse(a, 2) < radical_inverse(b, 2); });
  std::vector<std::uint32_t> trials;
  for (const std::uint32_t part : parts)
    trials.push_back(static_cast<std::uint32_t>((2 * std::size_t{part} + 1) * cells / (2 * count)));
  return trials;
}

double estimate_file_bytes(const bake_context& context, std::vector<stage_record> records) {
  const auto tried = static_cast<double>(records.size());
  std::erase_if(records, [](const stage_record& one) { return !one.record.stored; });
  if (records.empty()) return 0.0;
  std::sort(records.begin(), records.end(),
            [](const stage_record& a, const stage_record& b) { return a.cell < b.cell; });
  pvs_frame frame = context.frame();
  std::vector<format::box> boxes;
  for (const stage_record& one : records) boxes.push_back(frame.cells[one.cell]);
  frame.cells = std::move(boxes);
  const auto bytes = static_cast<double>(encoded_bytes(frame, [&](std::uint32_t i) { return records[i].record; }));
  const auto stored = static_cast<double>(records.size());
  const double cells = static_cast<double>(context.cells->list.cells.size()) * stored / tried;
  return std::max(bytes * std::pow(std::max(cells / stored, 1.0), growth), cells * smallest_cell);
}

}  // namespace sightcell::bake
