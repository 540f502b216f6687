#include "sample_contents.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <numeric>

#include "checksum.h"
#include "random_source.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/set_reader.h"

namespace sightcell::test {
namespace layout = format::layout;

format::file_contents sample_contents::view() const {
  return file_parts::contents(format::sets_of(sets));
}

std::vector<std::byte> sample_contents::encode() const {
  std::vector<std::byte> bytes;
  const format::status s = format::encode(view(), bytes);
  EXPECT_EQ(s, format::status::ok) << format::status_text(s);
  return bytes;
}

void add_draws(sample_contents& contents, std::uint32_t polygons, std::uint32_t draws) {
  contents.facts.polygon_count = polygons;
  contents.draws.clear();
  std::uint32_t next = 0;
  for (std::uint32_t d = 0; d < draws; ++d) {
    format::draw_record r;
    r.node = d + 10;
    r.mesh = d % 3;
    r.primitive = d % 2;
    r.material = d % 4 == 3 ? 0xFFFFFFFFu : d;
    r.first_source = r.first_stored = next;
    r.polygon_count = d + 1 == draws ? polygons - next : (d % 5 == 1 ? 0 : std::min(polygons - next, polygons / draws));
    r.base_vertex = next * 2;
    r.host_tag = 0x1122334455667788u + d;
    next += r.polygon_count;
    contents.draws.push_back(r);
  }
}

namespace {

// A file has floats here, so only values of a float are read back exactly.
double as_stored(double value) {
  return static_cast<double>(static_cast<float>(value));
}

format::box grid_box(std::uint32_t number) {
  const auto x = static_cast<float>(number % 8);
  const auto y = static_cast<float>(number / 64);
  const auto z = static_cast<float>(number / 8 % 8);
  return {{x, y, z}, {x + 1, y + 1, z + 1}};
}

format::box random_box(random_source& random) {
  format::box b;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    b.min[axis] = 0.5f * static_cast<float>(random.below(21));
    b.max[axis] = b.min[axis] + 0.5f * static_cast<float>(1 + random.below(8));
  }
  return b;
}

std::vector<std::uint32_t> numbers_of(const std::vector<bool>& seen) {
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < seen.size(); ++i) {
    if (seen[i]) numbers.push_back(i);
  }
  return numbers;
}

}  // namespace

sample_contents random_contents(std::uint32_t seed, const random_options& options) {
  random_source random(seed);
  sample_contents contents;
  add_draws(contents, options.polygons, options.draws);
  contents.facts.margin = 0.25f;
  contents.facts.max_pixel_error = 0.001f;
  for (std::size_t i = 0; i < 16; ++i) contents.facts.scene_fingerprint[i] = static_cast<std::uint8_t>(random());
  contents.settings = "{\"seed\":" + std::to_string(seed) + "}";
  const std::uint32_t polygons = options.polygons;
  std::vector<bool> seen(polygons, false);
  const auto mark = [&](bool value, double amount) {
    for (double left = amount * polygons; left > 0.0 && polygons > 0;) {
      const std::uint32_t first = random.below(polygons);
      const std::uint32_t count = std::min(polygons - first, 1 + random.below(12));
      std::fill_n(seen.begin() + first, count, value);
      left -= count;
    }
  };
  for (std::uint32_t cell = 0; cell < options.cells; ++cell) {
    contents.cells.push_back(options.overlapping ? random_box(random) : grid_box(cell));
    if (cell % 16 == 0) {
      seen.assign(polygons, false);
      mark(true, options.visible);
    } else if (cell % 7 != 3) {  // every seventh cell has the set of the one before
      mark(false, options.visible * options.changed);
      mark(true, options.visible * options.changed);
    }
    contents.sets.push_back(numbers_of(cell % 41 == 5   ? std::vector<bool>(polygons, false)
                                       : cell % 41 == 6 ? std::vector<bool>(polygons, true)
                                                        : seen));
    contents.certificate.push_back(
        {cell, random() % 100000 + 10, cell % 3, as_stored(1e-3 * random.share()), as_stored(0.95), random()});
  }
  return contents;
}

void put_in_order(sample_contents& contents, std::uint32_t seed) {
  random_source random(seed);
  shuffle(random, contents.draws);
  std::map<std::uint32_t, std::uint32_t> order_of_count;
  contents.order_of_draw.clear();
  contents.orders.clear();
  std::uint32_t next = 0;
  for (format::draw_record& d : contents.draws) {
    d.first_stored = next;
    next += d.polygon_count;
    const auto number = static_cast<std::uint32_t>(contents.orders.size());
    const auto [found, fresh] = order_of_count.try_emplace(d.polygon_count, number);
    contents.order_of_draw.push_back(found->second);
    if (!fresh) continue;
    std::vector<std::uint32_t>& order = contents.orders.emplace_back(d.polygon_count);
    std::iota(order.begin(), order.end(), 0u);
    shuffle(random, order);
  }
}

void put_in_groups(sample_contents& contents, std::uint32_t seed) {
  random_source random(seed);
  const auto place = [](const format::draw_record& d) { return std::pair(d.first_source, d.polygon_count > 0); };
  std::sort(contents.draws.begin(), contents.draws.end(),
            [&](const format::draw_record& a, const format::draw_record& b) { return place(a) < place(b); });
  std::vector<std::vector<format::draw_record>> groups(3);
  for (std::size_t i = 0; i < contents.draws.size(); ++i) {
    format::draw_record d = contents.draws[i];
    d.material = i % 3 == 2 ? 0xFFFFFFFFu : static_cast<std::uint32_t>(i % 3);
    d.flags = i % 7 == 5 ? format::draw_moves : 0;
    (d.flags != 0 ? groups.emplace_back() : groups[i % 3]).push_back(d);
  }
  std::erase_if(groups, [](const auto& group) { return group.empty(); });
  shuffle(random, groups);
  contents.facts.layout = format::host_layout::merged;
  contents.draws.clear();
  contents.order_of_draw.clear();
  contents.orders.clear();
  std::uint32_t next = 0;
  for (std::uint32_t group = 0; group < groups.size(); ++group) {
    const std::uint32_t begin = next;
    for (format::draw_record& d : groups[group]) {
      d.group = group;
      d.first_stored = next;
      next += d.polygon_count;
      contents.draws.push_back(d);
      contents.order_of_draw.push_back(group);
    }
    std::vector<std::uint32_t>& order = contents.orders.emplace_back(next - begin);
    std::iota(order.begin(), order.end(), 0u);
    shuffle(random, order);
  }
}

void put_on_lattice(sample_contents& contents) {
  contents.lattice = format::lattice_shape{4.0, 2.0};
  contents.grid.reset();
  contents.places.clear();
  const auto cells = static_cast<int>(contents.cells.size());
  for (int i = 0; i < cells; ++i) {
    const bool small = i > cells / 2;
    contents.places.push_back({i % 9 - 4, i / 9 % 2, i / 18 - 2 + (small ? 40 : 0), small ? 1u : 0u});
  }
  std::sort(contents.places.begin(), contents.places.end(), format::lattice_comes_before);
  for (std::size_t i = 0; i < contents.cells.size(); ++i)
    contents.cells[i] = format::box_of(*contents.lattice, contents.places[i]);
}

void put_on_grid(sample_contents& contents) {
  contents.grid = format::lattice_shape{1.4, 0.175};
  contents.lattice.reset();
  contents.places.clear();
  contents.grid_places.clear();
  for (std::size_t cell = 0; cell < contents.cells.size(); ++cell) {
    const auto i = static_cast<std::int32_t>(cell);
    const auto more = static_cast<std::uint32_t>(i % 5);
    contents.grid_places.push_back(
        {3 * (i % 9 - 4), 11 * (i / 9 % 2) - 7, 2 * (i / 18) - 9, 2 + more % 2, 8 + more, 2 + more / 3});
    contents.cells[cell] = format::box_of(*contents.grid, contents.grid_places.back());
  }
}

void add_volumes(sample_contents& contents, std::uint32_t count, std::uint32_t seed) {
  random_source random(seed);
  const std::uint32_t polygons = contents.facts.polygon_count;
  contents.volume_shape = {1.5, 2.0};
  contents.volumes.clear();
  // Every second position of a block, row by row.
  for (std::int32_t i = 0; contents.volumes.size() < count; ++i) {
    if (random() % 2 == 0) contents.volumes.push_back({i % 9 - 4, i / 9 % 3 - 1, i / 27 - 3, 0});
  }
  std::vector<bool> seen(count, false);
  for (std::size_t cell = 0; cell < contents.sets.size(); ++cell) {
    for (unsigned changes = random() % 4; changes > 0 && count > 0; --changes) {
      const std::uint32_t first = random() % count;
      const std::uint32_t length = std::min(count - first, 1 + random() % 9);
      std::fill_n(seen.begin() + first, length, random() % 3 != 0);
    }
    for (std::uint32_t volume = 0; volume < count; ++volume) {
      if (cell % 23 != 4 && (cell % 41 == 6 || seen[volume])) contents.sets[cell].push_back(polygons + volume);
    }
  }
}

sample_contents tiny_contents() {
  sample_contents contents;
  contents.facts.polygon_count = 6;
  contents.facts.margin = 0.25f;
  for (std::uint8_t i = 0; i < 16; ++i) contents.facts.scene_fingerprint[i] = static_cast<std::uint8_t>(0xA0 + i);
  contents.draws.push_back({.node = 2, .mesh = 1, .material = 0, .polygon_count = 6});
  contents.cells = {{{0, 0, 0}, {4, 2, 4}}, {{4, 0, 0}, {8, 2, 4}}};
  contents.sets = {{0, 1, 2, 4}, {5}};
  return contents;
}

sample_contents small_contents() {
  sample_contents contents;
  contents.facts.polygon_count = 300;
  contents.facts.margin = 0.25f;
  contents.facts.max_pixel_error = 0.5f;
  contents.facts.repeatable = false;
  for (std::uint8_t i = 0; i < 16; ++i) contents.facts.scene_fingerprint[i] = static_cast<std::uint8_t>(17 * i);
  contents.settings = "{\"sampler\":\"importance-depth\",\"seed\":1}";
  contents.draws = {
      {.node = 5, .mesh = 1, .primitive = 2, .material = 3, .polygon_count = 120, .host_tag = 77},
      {.node = 6, .mesh = 0, .material = 0xFFFFFFFFu, .first_source = 120, .first_stored = 120, .base_vertex = 300},
      {.node = 6,
       .mesh = 4,
       .instance = 9,
       .material = 1,
       .first_source = 120,
       .polygon_count = 180,
       .first_stored = 120,
       .base_vertex = 300,
       .host_tag = 0xFFFFFFFFFFFFFFFFu}};
  for (std::uint32_t cell = 0; cell < 67; ++cell) {
    contents.cells.push_back(grid_box(cell));
    std::vector<std::uint32_t> set;
    for (std::uint32_t p = 0; p < 300; ++p) {
      const bool common = p % 12 < 5 && p > 30;   // visible from nearly all cells, so that differences save bits
      const bool own = p / 4 % 67 == cell;        // visible from this cell only
      const bool lost = p / 7 % 35 == cell % 35;  // not visible from a few cells
      if (cell == 12 || (cell != 11 && ((common && !lost) || own))) set.push_back(p);
    }
    contents.sets.push_back(cell == 20 ? contents.sets[19] : set);
    contents.certificate.push_back(
        {cell, 1000 + cell, cell % 2, as_stored(0.5 / (1.0 + cell)), as_stored(0.95), cell * 0x100000001u});
  }
  return contents;
}

std::uint64_t get_u64(const std::vector<std::byte>& file, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) value |= static_cast<std::uint64_t>(file.at(at + i)) << (8 * i);
  return value;
}

std::uint32_t get_u32(const std::vector<std::byte>& file, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(file.at(at + i)) << (8 * i);
  return value;
}

void set_u32(std::vector<std::byte>& file, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) file.at(at + i) = static_cast<std::byte>(value >> (8 * i) & 0xFFu);
}

void set_u64(std::vector<std::byte>& file, std::size_t at, std::uint64_t value) {
  for (std::size_t i = 0; i < 8; ++i) file.at(at + i) = static_cast<std::byte>(value >> (8 * i) & 0xFFu);
}

std::uint64_t chunks_of(const std::vector<std::byte>& file) {
  std::uint64_t directory_size = 0;
  bool has_borders = false;
  for (std::size_t i = 0; i < get_u32(file, layout::header_section_count); ++i) {
    const std::size_t at = layout::header_size + i * layout::section_record_size;
    if (at + layout::section_record_size > file.size()) break;
    if (get_u32(file, at) == layout::section_row_directory) directory_size = get_u64(file, at + 16);
    if (get_u32(file, at) == layout::section_borders) has_borders = true;
  }
  const std::uint64_t blocks = (std::uint64_t{get_u32(file, layout::header_cell_count)} + 63) / 64;
  return has_borders ? directory_size / layout::chunk_record_size : blocks;
}

namespace {

bool inside(const std::vector<std::byte>& file, std::uint64_t offset, std::uint64_t size) {
  return offset <= file.size() && size <= file.size() - offset;
}

std::uint32_t sum_of(const std::vector<std::byte>& file, std::uint64_t offset, std::uint64_t size) {
  return format::crc32c(std::span(file).subspan(offset, size));
}

void reseal_chunks(std::vector<std::byte>& file, std::size_t directory, std::size_t rows) {
  const std::uint64_t chunks = chunks_of(file);
  const std::uint64_t at = get_u64(file, directory + 8);
  if (chunks > file.size() || !inside(file, at, chunks * layout::chunk_record_size)) return;
  for (std::uint64_t c = 0; c < chunks; ++c) {
    const std::uint64_t record = at + c * layout::chunk_record_size;
    const std::uint64_t start = get_u64(file, rows + 8);
    const std::uint64_t offset = get_u64(file, record);
    const std::uint32_t size = get_u32(file, record + 8);
    if (!inside(file, start, 0) || offset > file.size() || !inside(file, start + offset, size)) continue;
    set_u32(file, record + 12, sum_of(file, start + offset, size));
  }
}

}  // namespace

void reseal(std::vector<std::byte>& file) {
  if (file.size() < layout::header_size) return;
  const std::uint64_t count = get_u32(file, layout::header_section_count);
  const std::uint64_t table = count * layout::section_record_size;
  if (inside(file, layout::header_size, table)) {
    std::size_t directory = 0;
    std::size_t rows = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::size_t at = layout::header_size + i * layout::section_record_size;
      if (get_u32(file, at) == layout::section_row_directory) directory = at;
      if (get_u32(file, at) == layout::section_rows) rows = at;
    }
    if (directory != 0 && rows != 0) reseal_chunks(file, directory, rows);
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::size_t at = layout::header_size + i * layout::section_record_size;
      const std::uint64_t offset = get_u64(file, at + 8);
      const std::uint64_t size = get_u64(file, at + 16);
      if (inside(file, offset, size)) set_u32(file, at + 24, sum_of(file, offset, size));
    }
    set_u32(file, layout::header_table_checksum, sum_of(file, layout::header_size, table));
  }
  set_u32(file, layout::header_checksum, sum_of(file, 0, layout::header_checksum));
}

std::size_t section_place(const std::vector<std::byte>& file, std::uint32_t id) {
  for (std::size_t i = 0; i < get_u32(file, layout::header_section_count); ++i) {
    const std::size_t at = layout::header_size + i * layout::section_record_size;
    if (get_u32(file, at) == id) return at;
  }
  ADD_FAILURE() << "no section " << id;
  return layout::header_size;
}

std::size_t section_offset(const std::vector<std::byte>& file, std::uint32_t id) {
  return get_u64(file, section_place(file, id) + 8);
}

std::vector<std::uint32_t> decode_set(const format::reader& file, std::uint32_t cell, format::status& s) {
  format::set_reader sets;
  std::vector<std::uint32_t> ids;
  s = sets.open(file);
  if (s == format::status::ok) s = sets.item_ids(cell, ids);
  return ids;
}

format::status check_all(const format::reader& file) {
  format::set_reader sets;
  const format::status s = sets.open(file);
  return s == format::status::ok ? sets.check() : s;
}

std::vector<std::byte> golden_file(const std::string& name) {
  std::ifstream in(std::string(SIGHTCELL_TEST_GOLDEN_FOLDER "/") + name + ".pvs", std::ios::binary);
  EXPECT_TRUE(in.good()) << name;
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

}  // namespace sightcell::test
