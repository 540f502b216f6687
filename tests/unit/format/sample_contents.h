#pragma once
// Contents of .pvs files for tests: small hand-made ones and random ones, kept with the vectors they point into.
#include <cstdint>
#include <string>
#include <vector>

#include "sightcell/format/file_parts.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/writer.h"

namespace sightcell::test {

struct sample_contents : format::file_parts {
  std::vector<std::vector<std::uint32_t>> sets;

  // Valid as long as this is.
  [[nodiscard]] format::file_contents view() const;
  // Fails the running test, and gives no bytes, when the writer refuses.
  [[nodiscard]] std::vector<std::byte> encode() const;
};

// polygons shared out over draws; every fifth draw is empty.
void add_draws(sample_contents& contents, std::uint32_t polygons, std::uint32_t draws);

struct random_options {
  std::uint32_t polygons = 1000;
  std::uint32_t draws = 7;
  std::uint32_t cells = 150;
  double visible = 0.1;      // share of the scene that a cell sees
  double changed = 0.2;      // share of runs that differ from the cell before
  bool overlapping = false;  // explicit boxes of different sizes; else a grid of 1 m cells
};

// Sets that resemble their neighbors, some equal, some empty, some full. Same seed, same contents.
sample_contents random_contents(std::uint32_t seed, const random_options& options);

// Two cells, one draw, six polygons: the worked example of SPEC.md.
sample_contents tiny_contents();
// The draws of some contents in a random order of their own, draws of equal size sharing one, or the other way round.
void put_in_order(sample_contents& contents, std::uint32_t seed);
// The draws of some contents in the merged layout: groups of a few materials, some draws that move, random orders.
void put_in_groups(sample_contents& contents, std::uint32_t seed);
// The cells of some contents, as many as they are, on a lattice: cells of 4 m around the origin, then of half the size.
void put_on_lattice(sample_contents& contents);
// So many volumes around the origin, some of which each cell sees: none, all, or such as the cell before.
void add_volumes(sample_contents& contents, std::uint32_t count, std::uint32_t seed);
// Everything the format has in one small file: three draws (one empty), 67 cells in two chunks, own, delta and shared
// rows, an empty set and a full one, certificate and settings.
sample_contents small_contents();

// The bytes of a golden file, of which name.pvs lies in tests/golden.
std::vector<std::byte> golden_file(const std::string& name);

// Makes all checksums of a damaged file fit its bytes again, as far as its directory can be followed: what a clever
// attacker would do, and the way to test the decoder behind the checksums.
void reseal(std::vector<std::byte>& file);

// Little-endian access for tests that change files.
std::uint32_t get_u32(const std::vector<std::byte>& file, std::size_t at);
std::uint64_t get_u64(const std::vector<std::byte>& file, std::size_t at);
void set_u32(std::vector<std::byte>& file, std::size_t at, std::uint32_t value);
void set_u64(std::vector<std::byte>& file, std::size_t at, std::uint64_t value);

// Where the record of section id lies in the table; fails the test when there is none.
std::size_t section_place(const std::vector<std::byte>& file, std::uint32_t id);
// Where the section's bytes begin.
std::size_t section_offset(const std::vector<std::byte>& file, std::uint32_t id);

// Source ids of a cell, and volumes behind them, ascending. s: status of decoding.
std::vector<std::uint32_t> decode_set(const format::reader& file, std::uint32_t cell, format::status& s);
// What reader::check says.
format::status check_all(const format::reader& file);

}  // namespace sightcell::test
