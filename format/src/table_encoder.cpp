#include "table_encoder.h"

#include <bit>
#include <cmath>

#include "byte_sink.h"
#include "cell_lattice_writer.h"
#include "grid_boxes_writer.h"
#include "packed_columns_writer.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

using column_list = std::vector<std::vector<std::uint32_t>>;

std::uint32_t low(std::uint64_t value) {
  return static_cast<std::uint32_t>(value);
}
std::uint32_t high(std::uint64_t value) {
  return static_cast<std::uint32_t>(value >> 32);
}

}  // namespace

// A bound may only be rounded up, its confidence only down.
std::uint32_t bits_toward(double value, float direction) {
  const auto nearest = static_cast<float>(value);
  const auto back = static_cast<double>(nearest);
  const bool wrong = direction > 1.0f ? back < value : back > value;
  return std::bit_cast<std::uint32_t>(wrong ? std::nextafter(nearest, direction) : nearest);
}

std::vector<std::byte> encode_draws(std::span<const draw_record> draws, std::span<const std::uint32_t> order_of_draw) {
  column_list columns(layout::draw_columns);
  for (std::size_t i = 0; i < draws.size(); ++i) {
    const draw_record& d = draws[i];
    std::size_t column = 0;
    for (const std::uint32_t value :
         {d.node, d.mesh, d.primitive, d.instance, d.material, d.group, order_of_draw[i], d.first_source,
          d.first_stored, d.base_vertex, low(d.host_tag), high(d.host_tag), d.flags}) {
      columns[column++].push_back(value);
    }
  }
  std::vector<std::byte> bytes;
  put_columns(columns, bytes);
  return bytes;
}

std::size_t cell_count(const file_contents& contents) noexcept {
  if (contents.lattice) return contents.lattice->places.size();
  return contents.grid ? contents.grid->places.size() : contents.cells.size();
}

box box_of_cell(const file_contents& contents, std::size_t cell) noexcept {
  if (contents.lattice) return box_of(contents.lattice->shape, contents.lattice->places[cell]);
  return contents.grid ? box_of(contents.grid->step, contents.grid->places[cell]) : contents.cells[cell];
}

bool encode_cells(const file_contents& contents, std::vector<std::byte>& bytes) {
  byte_sink out(bytes);
  if (contents.lattice) {
    out.put_u32(layout::cells_are_on_lattice);
    return put_lattice(contents.lattice->shape, contents.lattice->places, bytes);
  }
  if (contents.grid) {
    out.put_u32(layout::cells_are_on_grid);
    return put_grid(contents.grid->step, contents.grid->places, bytes);
  }
  out.put_u32(layout::cells_are_boxes);
  for (const box& b : contents.cells) {
    for (const float value : b.min) out.put_f32(value);
    for (const float value : b.max) out.put_f32(value);
  }
  return true;
}

std::vector<std::byte> encode_certificate(std::span<const certificate_record> certificate) {
  column_list columns(layout::certificate_columns);
  for (const certificate_record& c : certificate) {
    std::size_t column = 0;
    for (const std::uint32_t value :
         {low(c.rays), high(c.rays), low(c.misses), high(c.misses), bits_toward(c.upper_bound, 2.0f),
          bits_toward(c.confidence, -1.0f), low(c.seed), high(c.seed)}) {
      columns[column++].push_back(value);
    }
  }
  std::vector<std::byte> bytes;
  put_columns(columns, bytes);
  return bytes;
}

}  // namespace sightcell::format
