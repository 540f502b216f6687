// Compiled with -fno-exceptions -fno-rtti, like the writer that is linked to it. Writes the two-cell file of SPEC.md
// and compares it with the golden one, then opens it through the C++ interface. usage: no_exceptions v1_tiny.pvs
#include <cstdio>
#include <vector>

#include "sightcell/format/writer.h"
#include "sightcell/sightcell.hpp"

namespace format = sightcell::format;

namespace {

std::vector<std::byte> written() {
  format::file_contents contents;
  contents.facts.polygon_count = 6;
  contents.facts.margin = 0.25f;
  for (std::uint8_t i = 0; i < 16; ++i) contents.facts.scene_fingerprint[i] = static_cast<std::uint8_t>(0xA0 + i);
  const format::draw_record draw{.node = 2, .mesh = 1, .material = 0, .polygon_count = 6};
  const format::box cells[] = {{{0, 0, 0}, {4, 2, 4}}, {{4, 0, 0}, {8, 2, 4}}};
  const std::vector<std::uint32_t> sets[] = {{0, 1, 2, 4}, {5}};
  contents.draws = {&draw, 1};
  contents.cells = cells;
  contents.cell_sets = format::sets_of(sets);
  std::vector<std::byte> bytes;
  if (format::encode(contents, bytes) != format::status::ok) bytes.clear();
  return bytes;
}

std::vector<std::byte> read(const char* path) {
  std::vector<std::byte> bytes(4096);
  std::FILE* file = std::fopen(path, "rb");
  if (file == nullptr) return {};
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file));
  std::fclose(file);
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::vector<std::byte> bytes = written();
  if (bytes.empty() || bytes != read(argv[1])) return 1;
  const auto file = sightcell::db::open(bytes);
  return file && file->cell_count() == 2 ? 0 : 1;
}
