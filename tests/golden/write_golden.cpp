// Writes the golden files of this version, and what is in them as text, into a folder. Run by hand when a new version
// gets files of its own; the files of old versions stay as they are.
#include <cstdio>
#include <string>

#include "sightcell/format/writer.h"
#include "unit/format/sample_contents.h"

namespace {

using sightcell::test::sample_contents;

void dump_cell(const sample_contents& contents, std::size_t cell, std::FILE* out) {
  const auto& b = contents.cells[cell];
  std::fprintf(out, "cell %zu: %.9g %.9g %.9g  %.9g %.9g %.9g  sees", cell, b.min[0], b.min[1], b.min[2], b.max[0],
               b.max[1], b.max[2]);
  for (const std::uint32_t polygon : contents.sets[cell]) std::fprintf(out, " %u", polygon);
  std::fputc('\n', out);
}

void dump(const sample_contents& contents, std::FILE* out) {
  std::fprintf(out, "version 0\nfingerprint ");
  for (const unsigned byte : contents.facts.scene_fingerprint) std::fprintf(out, "%02x", byte);
  std::fprintf(out, "\npolygons %u\nmargin %.9g\nmax_pixel_error %.9g\nconfidence %.9g\nrepeatable %d\nsettings %s\n",
               contents.facts.polygon_count, contents.facts.margin, contents.facts.max_pixel_error,
               contents.facts.confidence, contents.facts.repeatable ? 1 : 0, contents.settings.c_str());
  for (std::size_t i = 0; i < contents.draws.size(); ++i) {
    const auto& d = contents.draws[i];
    std::fprintf(out, "draw %zu: %u %u %u %u %u %u %u %u %u %u %llu\n", i, d.node, d.mesh, d.primitive, d.instance,
                 d.material, d.group, d.first_source, d.polygon_count, d.first_stored, d.base_vertex,
                 static_cast<unsigned long long>(d.host_tag));
  }
  for (std::size_t cell = 0; cell < contents.cells.size(); ++cell) dump_cell(contents, cell, out);
  for (const auto& c : contents.certificate) {
    std::fprintf(out, "certificate %u: %llu %llu %.17g %.17g %llu\n", c.cell, static_cast<unsigned long long>(c.rays),
                 static_cast<unsigned long long>(c.misses), c.upper_bound, c.confidence,
                 static_cast<unsigned long long>(c.seed));
  }
}

bool write(const sample_contents& contents, const std::string& name) {
  std::vector<std::byte> bytes;
  if (sightcell::format::encode(contents.view(), bytes) != sightcell::format::status::ok) return false;
  if (sightcell::format::write_file((name + ".pvs").c_str(), bytes) != sightcell::format::status::ok) return false;
  std::FILE* text = std::fopen((name + ".txt").c_str(), "wb");
  if (text == nullptr) return false;
  dump(contents, text);
  return std::fclose(text) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: write_golden FOLDER\n");
    return 2;
  }
  const std::string folder = argv[1];
  const bool written = write(sightcell::test::tiny_contents(), folder + "/v0_tiny") &&
                       write(sightcell::test::small_contents(), folder + "/v0_small");
  if (!written) std::fprintf(stderr, "write_golden: cannot write to %s\n", folder.c_str());
  return written ? 0 : 1;
}
