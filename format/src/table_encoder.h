#pragma once
// Encodes the sections of a file except its rows: draws, cells, certificate.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/format/records.h"
#include "sightcell/format/writer.h"

namespace sightcell::format {

// order_of_draw: one per draw.
std::vector<std::byte> encode_draws(std::span<const draw_record> draws, std::span<const std::uint32_t> order_of_draw);
// However the cells are given.
[[nodiscard]] std::size_t cell_count(const file_contents& contents) noexcept;
[[nodiscard]] box box_of_cell(const file_contents& contents, std::size_t cell) noexcept;
// False if cells on a lattice or grid have no valid box, or those on a lattice are in a wrong order.
[[nodiscard]] bool encode_cells(const file_contents& contents, std::vector<std::byte>& out);
std::vector<std::byte> encode_certificate(std::span<const certificate_record> certificate);
// The bits of a share as an f32, rounded up (direction 2) or down (direction -1).
[[nodiscard]] std::uint32_t bits_toward(double value, float direction);

}  // namespace sightcell::format
