#pragma once
// Contents of .pvs files for tests: small hand-made ones and random ones, with the vectors that they point into.
#include <cstdint>
#include <string>
#include <vector>

#include "sightcell/format/file_parts.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/writer.h"

namespace sightcell::test {

struct sample_contents : format::file_parts {
  std::vector<std::vector<std::uint32_t>> sets;

  // Valid as long as this object.
  [[nodiscard]] format::file_contents view() const;
  // Fails the running test, and returns no bytes, if the writer fails.
  [[nodiscard]] std::vector<std::byte> encode() const;
};

// Distributes polygons over draws; every fifth draw is empty.
void add_draws(sample_contents& contents, std::uint32_t polygons, std::uint32_t draws);

struct random_options {
  std::uint32_t polygons = 1000;
  std::uint32_t draws = 7;
  std::uint32_t cells = 150;
  double visible = 0.1;      // share of the scene in a set
  double changed = 0.2;      // share of runs that differ from the cell before
  bool overlapping = false;  // explicit boxes of different sizes; else a grid of 1 m cells
};

// Sets that resemble their neighbors, some equal, some empty, some full. Equal seeds give equal contents.
sample_contents random_contents(std::uint32_t seed, const random_options& options);

// Two cells, one draw, six polygons: the worked example of SPEC.md.
sample_contents tiny_contents();
// The draws of some contents in a random order of their own, draws of equal size sharing one, or the other way round.
void put_in_order(sample_contents& contents, std::uint32_t seed);
// The draws of some contents in the merged layout: groups of a few materials, some draws that move, random orders.
void put_in_groups(sample_contents& contents, std::uint32_t seed);
// Moves the cells of some contents to a lattice: cells of 4 m around the origin, then of half the size.
void put_on_lattice(sample_contents& contents);
// Moves them to a grid: boxes of several widths and heights around the origin, some of which overlap.
void put_on_grid(sample_contents& contents);
// Adds volumes around the origin. The set of each cell has none of them, all, or mostly those of the cell before.
void add_volumes(sample_contents& contents, std::uint32_t count, std::uint32_t seed);
// All features of the format in one small file: three draws (one empty), 67 cells in two chunks, own, delta and shared
// rows, an empty set and a full one, certificate and settings.
sample_contents small_contents();

// The bytes of the golden file tests/golden/NAME.pvs.
std::vector<std::byte> golden_file(const std::string& name);

// Corrects all checksums of a damaged file, as far as its directory can be followed: as an attacker would, and to test
// the decoder below the checksums.
void reseal(std::vector<std::byte>& file);

// The number of chunks by the section table.
std::uint64_t chunks_of(const std::vector<std::byte>& file);

// Little-endian access for tests that change files.
std::uint32_t get_u32(const std::vector<std::byte>& file, std::size_t at);
std::uint64_t get_u64(const std::vector<std::byte>& file, std::size_t at);
void set_u32(std::vector<std::byte>& file, std::size_t at, std::uint32_t value);
void set_u64(std::vector<std::byte>& file, std::size_t at, std::uint64_t value);

// The offset of the record of section id in the table; fails the test if there is none.
std::size_t section_place(const std::vector<std::byte>& file, std::uint32_t id);
// The offset of the section's bytes.
std::size_t section_offset(const std::vector<std::byte>& file, std::uint32_t id);

// Source ids of a cell, then its volumes, ascending. s: status of decoding.
std::vector<std::uint32_t> decode_set(const format::reader& file, std::uint32_t cell, format::status& s);
// The result of reader::check.
format::status check_all(const format::reader& file);

}  // namespace sightcell::test
