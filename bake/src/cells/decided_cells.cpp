#include "cells/decided_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "cells/cell_blocks.h"
#include "cells/lattice.h"

namespace sightcell::bake {
namespace {

constexpr std::uint64_t bytes_version = 1;
// Limits of a lattice whose boxes have volume in single precision: settings allow cells of 1000 m, which --most-cells
// doubles a few times, and lattice.cpp limits positions of level 0 to 2^30. Layers are an eighth as high as wide.
constexpr double most_width = 1e9;
constexpr std::int64_t most_index = std::int64_t{1} << 34;
constexpr std::int32_t most_layers = 1 << 30;
constexpr std::size_t bytes_of_cell = 3 * 8 + 1 + 4 + 2 * 8;

void put(std::string& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<char>(value >> (8 * i)));
}

void put(std::string& out, double value) {
  put(out, std::bit_cast<std::uint64_t>(value), 8);
}

void put(std::string& out, const std::string& text) {
  put(out, text.size(), 8);
  out += text;
}

void put(std::string& out, const std::vector<view_cell>& cells) {
  put(out, cells.size(), 8);
  for (const view_cell& cell : cells) {
    const lattice_position& p = cell.position;
    for (const std::int64_t index : {p.z, p.y, p.x}) put(out, static_cast<std::uint64_t>(index), 8);
    put(out, static_cast<std::uint64_t>(p.level), 1);
    put(out, static_cast<std::uint64_t>(p.layers), 4);
    put(out, cell.floor_area);
    put(out, cell.floor);
  }
}

// Reading past the end, and values that no cells have, set good to false. All reads return 0 from then on.
class cells_reader {
 public:
  explicit cells_reader(std::string_view bytes) : bytes_(bytes) {}

  bool good() const { return good_; }
  bool at_end() const { return bytes_.empty(); }

  std::uint64_t number(std::size_t count) {
    if (bytes_.size() < count) return fail();
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i) value |= std::uint64_t{static_cast<std::uint8_t>(bytes_[i])} << (8 * i);
    bytes_.remove_prefix(count);
    return value;
  }
  double finite() {
    const auto value = std::bit_cast<double>(number(8));
    if (!std::isfinite(value)) fail();
    return good_ ? value : 0.0;
  }
  // Returns the number of items that follow, each of this number of bytes or more.
  std::uint64_t count_of(std::size_t bytes_of_item) {
    const std::uint64_t count = number(8);
    return count <= bytes_.size() / bytes_of_item ? count : fail();
  }
  std::string text() {
    const std::uint64_t size = count_of(1);
    std::string out(bytes_.substr(0, size));
    bytes_.remove_prefix(size);
    return out;
  }
  // A text that goes into messages.
  std::string line() {
    std::string out = text();
    const auto breaks = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; };
    if (std::any_of(out.begin(), out.end(), breaks)) fail();
    return out;
  }
  std::vector<view_cell> cells(const lattice& on);

 private:
  view_cell cell(const lattice& on);
  std::uint64_t fail() {
    good_ = false;
    bytes_ = {};
    return 0;
  }

  std::string_view bytes_;
  bool good_ = true;
};

view_cell cells_reader::cell(const lattice& on) {
  lattice_position p;
  for (std::int64_t* index : {&p.z, &p.y, &p.x}) {
    *index = static_cast<std::int64_t>(number(8));
    if (*index < -most_index || *index > most_index) fail();
  }
  p.level = static_cast<std::int32_t>(number(1));
  p.layers = static_cast<std::int32_t>(static_cast<std::uint32_t>(number(4)));
  if (p.level > cell_blocks::highest_level || p.layers < 1 || p.layers > most_layers) fail();
  const double area = finite(), floor = finite();
  if (!good_ || area < 0.0 || !on.has_volume(p)) {
    fail();
    return {};
  }
  view_cell made = on.cell(p);
  made.floor_area = area, made.floor = floor;
  return made;
}

std::vector<view_cell> cells_reader::cells(const lattice& on) {
  const std::uint64_t count = count_of(bytes_of_cell);
  std::vector<view_cell> read;
  read.reserve(count);
  for (std::uint64_t i = 0; i < count && good_; ++i) read.push_back(cell(on));
  std::vector<lattice_position> positions;
  positions.reserve(read.size());
  for (const view_cell& one : read) positions.push_back(one.position);
  std::sort(positions.begin(), positions.end());
  if (std::adjacent_find(positions.begin(), positions.end()) != positions.end()) fail();
  return read;
}

}  // namespace

std::string encode(const decided_cells& cells) {
  std::string out;
  put(out, bytes_version, 1);
  put(out, cells.inputs);
  put(out, cells.device);
  put(out, cells.list.how);
  put(out, cells.list.warnings.size(), 8);
  for (const std::string& warning : cells.list.warnings) put(out, warning);
  put(out, cells.list.cell_width);
  put(out, cells.list.cells);
  put(out, cells.boxes);
  return out;
}

std::optional<decided_cells> decode_cells(std::string_view bytes) {
  cells_reader in(bytes);
  if (in.number(1) != bytes_version) return std::nullopt;
  decided_cells cells;
  cells.inputs = in.text();
  cells.device = in.text();
  cells.list.how = in.line();
  cells.list.warnings.resize(in.count_of(8));
  for (std::string& warning : cells.list.warnings) warning = in.line();
  const double width = in.finite();
  if (!in.good() || !(width > 0.0 && width <= most_width)) return std::nullopt;
  const lattice on = lattice::over_floors(width);
  cells.list.cell_width = width;
  cells.list.can_merge = true;
  cells.list.cells = in.cells(on);
  cells.boxes = in.cells(on);
  if (!in.good() || !in.at_end() || cells.list.cells.empty()) return std::nullopt;
  return cells;
}

}  // namespace sightcell::bake
