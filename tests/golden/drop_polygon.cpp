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

#include "sightcell/format/reader.h"
#include "sightcell/format/writer.h"

namespace {

using namespace sightcell::format;

// A file's contents, taken apart.
struct parts {
  std::vector<draw_record> draws;
  std::vector<box> cells;
  std::vector<std::vector<std::uint32_t>> sets;
  std::vector<certificate_record> certificate;
};

int fail(const char* what, status s) {
  std::fprintf(stderr, "sightcell-test-drop-polygon: %s: %s\n", what, status_text(s));
  return 1;
}

bool read_number(const char* text, std::uint32_t& out) {
  const char* end = text + std::strlen(text);
  const auto [stop, error] = std::from_chars(text, end, out);
  return error == std::errc() && stop == end;
}

status take_apart(const reader& file, parts& out) {
  out.draws.resize(file.draw_count());
  out.cells.resize(file.cell_count());
  out.sets.resize(file.cell_count());
  out.certificate.resize(file.certificate_count());
  std::vector<run> runs(file.run_bound());
  std::vector<run> scratch(file.run_bound());
  if (const status s = file.check(runs, scratch); s != status::ok) return s;
  for (std::uint32_t i = 0; i < file.draw_count(); ++i) {
    if (const status s = file.draw(i, out.draws[i]); s != status::ok) return s;
  }
  for (std::uint32_t i = 0; i < file.certificate_count(); ++i) {
    if (const status s = file.certificate(i, out.certificate[i]); s != status::ok) return s;
  }
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    std::size_t count = 0;
    if (const status s = file.cell_box(cell, out.cells[cell]); s != status::ok) return s;
    if (const status s = file.decode_row(cell, runs, scratch, count); s != status::ok) return s;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::uint32_t k = 0; k < runs[i].count; ++k) out.sets[cell].push_back(runs[i].first + k);
    }
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
  parts contents;
  if (const status s = reader::open(std::as_bytes(std::span(text)), file); s != status::ok) return fail(argv[1], s);
  if (const status s = take_apart(file, contents); s != status::ok) return fail(argv[1], s);
  if (cell >= contents.sets.size()) return fail("no such cell", status::argument);
  auto& set = contents.sets[cell];
  const auto found = std::lower_bound(set.begin(), set.end(), polygon);
  if (found == set.end() || *found != polygon) return fail("the cell does not see that polygon", status::argument);
  set.erase(found);
  std::vector<std::byte> bytes;
  const file_contents changed{file.facts(),           contents.draws,       contents.cells,
                              sets_of(contents.sets), contents.certificate, file.settings()};
  if (const status s = encode(changed, bytes); s != status::ok) return fail(argv[2], s);
  if (const status s = write_file(argv[2], bytes); s != status::ok) return fail(argv[2], s);
  return 0;
}
