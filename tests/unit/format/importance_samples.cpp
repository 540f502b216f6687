#include "importance_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "checksum.h"
#include "code_table.h"
#include "sample_contents.h"
#include "sightcell/format/importance_classes.h"
#include "sightcell/format/importance_writer.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/set_reader.h"

namespace sightcell::test {
namespace layout = format::layout;
using format::run;
using format::status;

std::uint8_t sample_class(std::uint32_t cell, std::uint32_t polygon) {
  const std::uint32_t stretch = polygon / 8 + cell;
  if (stretch % 5 == 0) return format::least_important;
  return static_cast<std::uint8_t>(std::min(stretch % 7 + (polygon * 11 + cell) % 13 / 3, 14u));
}

std::vector<std::byte> with_importance(const std::vector<std::byte>& file, const class_function& class_of) {
  format::reader opened;
  format::set_reader sets;
  EXPECT_EQ(format::reader::open(file, opened), status::ok);
  EXPECT_EQ(sets.open(opened), status::ok);
  const format::importance_source source{[&](std::uint32_t cell, std::vector<std::uint8_t>& classes) {
    std::span<const run> runs;
    if (const status s = sets.runs(cell, runs); s != status::ok) return s;
    for (const run& r : runs)
      for (std::uint32_t i = 0; i < r.count; ++i)
        classes.push_back(class_of(cell, sets.source_of_stored()[r.first + i]));
    return status::ok;
  }};
  std::vector<std::byte> out;
  EXPECT_EQ(format::put_importance(file, source, out), status::ok);
  return out;
}

std::vector<std::uint8_t> classes_of(const format::reader& file, std::uint32_t cell) {
  format::set_reader sets;
  format::importance_classes importance;
  std::span<const run> runs;
  EXPECT_EQ(file.importance(importance), status::ok);
  EXPECT_EQ(sets.open(file), status::ok);
  EXPECT_EQ(sets.runs(cell, runs), status::ok);
  std::vector<std::pair<std::uint32_t, std::uint8_t>> polygons;
  for (const run& r : runs)
    for (std::uint32_t i = 0; i < r.count; ++i) polygons.emplace_back(sets.source_of_stored()[r.first + i], 0);
  std::vector<std::uint8_t> classes(polygons.size());
  EXPECT_EQ(importance.decode(cell, classes), status::ok);
  for (std::size_t i = 0; i < classes.size(); ++i) polygons[i].second = classes[i];
  std::sort(polygons.begin(), polygons.end());
  for (std::size_t i = 0; i < classes.size(); ++i) classes[i] = polygons[i].second;
  return classes;
}

status use_importance(const format::reader& file) {
  format::importance_classes importance;
  if (const status s = file.importance(importance); s != status::ok) return s;
  status all = status::ok;
  for (std::uint32_t chunk = 0; chunk < file.chunk_count(); ++chunk) {
    if (const status s = importance.check_chunk(chunk); s != status::ok) all = s;
  }
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{300}}) {
      // Memory of exactly this size: the sanitizers detect an access outside.
      const auto classes = std::make_unique<std::uint8_t[]>(size);
      if (importance.decode(cell, {classes.get(), size}) != status::ok) continue;
      for (std::size_t i = 0; i < size; ++i) EXPECT_LT(classes[i], format::importance_class_count);
    }
  }
  return all;
}

namespace {

std::uint32_t sum_of(const std::vector<std::byte>& file, std::size_t at, std::size_t size) {
  return format::crc32c(std::span(file).subspan(at, size));
}

}  // namespace

void reseal_importance(std::vector<std::byte>& file) {
  for (std::size_t i = 0; i < get_u32(file, layout::header_section_count); ++i) {
    const std::size_t record = layout::header_size + i * layout::section_record_size;
    if (record + layout::section_record_size > file.size()) break;
    const std::uint64_t at = get_u64(file, record + 8);
    const std::uint64_t size = get_u64(file, record + 16);
    const std::uint64_t chunks = chunks_of(file);
    if (get_u32(file, record) != layout::section_importance || at > file.size() || size > file.size() - at) continue;
    if (chunks > size || 4 + 16 * chunks > size) continue;
    std::span<const std::byte> rest = std::span<const std::byte>(file).subspan(at, size).subspan(4 + 16 * chunks);
    format::symbol_lengths unused{};
    for (int table = 0; table < 17; ++table) {
      if (!format::read_code_lengths(rest, unused)) break;
    }
    const std::size_t first = at + size - rest.size();
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
      const std::size_t here = at + 4 + 16 * chunk;
      const std::uint64_t offset = get_u64(file, here);
      const std::uint32_t length = get_u32(file, here + 8);
      if (offset > rest.size() || length > rest.size() - offset) continue;
      set_u32(file, here + 12, sum_of(file, first + offset, length));
    }
    set_u32(file, at, sum_of(file, at + 4, first - at - 4));
  }
  reseal(file);
}

}  // namespace sightcell::test
