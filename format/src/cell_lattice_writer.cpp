#include "cell_lattice_writer.h"

#include <algorithm>
#include <tuple>

#include "byte_sink.h"
#include "packed_columns_writer.h"
#include "record_rules.h"

namespace sightcell::format {
namespace {

// Rounds down, also below 0.
std::int32_t chunk_of(std::int32_t place) noexcept {
  return place >> 3;
}
static_assert(lattice_chunk_width == 8);

unsigned bit_of(const lattice_place& p) noexcept {
  return static_cast<unsigned>((p.z & 7) * lattice_chunk_width + (p.x & 7));
}

auto chunk_key(const lattice_place& p) noexcept {
  return std::tuple(p.level, chunk_of(p.z), chunk_of(p.x), p.y);
}

}  // namespace

bool lattice_comes_before(const lattice_place& a, const lattice_place& b) noexcept {
  return std::tuple(chunk_key(a), bit_of(a)) < std::tuple(chunk_key(b), bit_of(b));
}

bool put_lattice(const lattice_shape& shape, std::span<const lattice_place> places, std::vector<std::byte>& out) {
  if (!shape_is_valid(shape)) return false;
  std::vector<std::vector<std::uint32_t>> columns(7);
  std::uint64_t mask = 0;
  const auto finish_chunk = [&] {
    columns[5].push_back(static_cast<std::uint32_t>(mask));
    columns[6].push_back(static_cast<std::uint32_t>(mask >> 32));
    mask = 0;
  };
  for (std::size_t i = 0; i < places.size(); ++i) {
    const lattice_place& p = places[i];
    if (p.level > max_lattice_level || !box_is_valid(box_of(shape, p))) return false;
    if (i > 0 && !lattice_comes_before(places[i - 1], p)) return false;
    if (i == 0 || chunk_key(places[i - 1]) != chunk_key(p)) {
      if (i > 0) finish_chunk();
      columns[0].push_back(from_signed(chunk_of(p.x)));
      columns[1].push_back(from_signed(p.y));
      columns[2].push_back(from_signed(chunk_of(p.z)));
      columns[3].push_back(p.level);
      columns[4].push_back(static_cast<std::uint32_t>(i));
    }
    mask |= std::uint64_t{1} << bit_of(p);
  }
  if (!places.empty()) finish_chunk();
  byte_sink bytes(out);
  bytes.put_f64(shape.width);
  bytes.put_f64(shape.height);
  bytes.put_u32(static_cast<std::uint32_t>(columns[0].size()));
  put_columns(columns, out);
  return true;
}

}  // namespace sightcell::format
