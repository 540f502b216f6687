// sightcell-test-drop-polygon IN.pvs OUT.pvs CELL POLYGON: the same file without that polygon (source id) in that cell,
// to see that checks notice. Certificate and settings are kept as they are.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "sightcell/format/file_parts.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/format/writer.h"

namespace {

using namespace sightcell::format;

int fail(const char* what, status s) {
  std::fprintf(stderr, "sightcell-test-drop-polygon: %s: %s\n", what, status_text(s));
  return 1;
}

bool read_number(const char* text, std::uint32_t& out) {
  const char* end = text + std::strlen(text);
  const auto [stop, error] = std::from_chars(text, end, out);
  return error == std::errc() && stop == end;
}

status read_sets(const reader& file, std::vector<std::vector<std::uint32_t>>& sets) {
  set_reader stored;
  if (const status s = stored.open(file); s != status::ok) return s;
  if (const status s = stored.check(); s != status::ok) return s;
  sets.resize(file.cell_count());
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    if (const status s = stored.item_ids(cell, sets[cell]); s != status::ok) return s;
  }
  return status::ok;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint32_t cell = 0;
  std::uint32_t polygon = 0;
  if (argc != 5 || !read_number(argv[3], cell) || !read_number(argv[4], polygon)) {
    std::fprintf(stderr, "usage: sightcell-test-drop-polygon IN.pvs OUT.pvs CELL POLYGON\n");
    return 2;
  }
  std::ifstream in(argv[1], std::ios::binary);
  if (!in) return fail(argv[1], status::io);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  reader file;
  file_parts parts;
  std::vector<std::vector<std::uint32_t>> sets;
  if (const status s = reader::open(std::as_bytes(std::span(text)), file); s != status::ok) return fail(argv[1], s);
  if (const status s = read_sets(file, sets); s != status::ok) return fail(argv[1], s);
  if (const status s = take_apart(file, parts); s != status::ok) return fail(argv[1], s);
  if (cell >= sets.size()) return fail("no such cell", status::argument);
  auto& set = sets[cell];
  const auto found = std::lower_bound(set.begin(), set.end(), polygon);
  if (found == set.end() || *found != polygon) return fail("the cell does not see that polygon", status::argument);
  set.erase(found);
  std::vector<std::byte> bytes;
  if (const status s = encode(parts.contents(sets_of(sets)), bytes); s != status::ok) return fail(argv[2], s);
  if (const status s = write_file(argv[2], bytes); s != status::ok) return fail(argv[2], s);
  return 0;
}
