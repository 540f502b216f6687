// Writes the golden files of the writer's version, and what is in them as text, into a folder, and damaged ones into
// golden_errors there. Run by hand when that version's bytes change, which they may not once it is released; the files
// of older versions stay as they are.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <numeric>
#include <string>
#include <system_error>

#include "damaged_file.h"
#include "golden_casters.h"
#include "golden_contents.h"
#include "golden_importance.h"
#include "golden_lights.h"
#include "golden_residency.h"
#include "sightcell/format/eye_table.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/viewpoint_table.h"
#include "sightcell/format/writer.h"

namespace {

using sightcell::test::sample_contents;

void dump_numbers(const std::vector<std::uint32_t>& numbers, std::FILE* out) {
  for (const std::uint32_t number : numbers) std::fprintf(out, " %u", number);
  std::fputc('\n', out);
}

void dump_facts(const sample_contents& contents, std::FILE* out) {
  std::fprintf(out, "version %u\nfingerprint ", sightcell::format::layout::version);
  for (const unsigned byte : contents.facts.scene_fingerprint) std::fprintf(out, "%02x", byte);
  std::fprintf(out, "\npolygons %u\nmargin %.9g\nmax_pixel_error %.9g\nconfidence %.9g\nslack %.9g\n",
               contents.facts.polygon_count, static_cast<double>(contents.facts.margin),
               static_cast<double>(contents.facts.max_pixel_error), static_cast<double>(contents.facts.confidence),
               static_cast<double>(contents.facts.slack));
  if (contents.facts.layout == sightcell::format::host_layout::merged) std::fputs("layout merged\n", out);
  std::fprintf(out, "repeatable %d\nsettings %s\n", contents.facts.repeatable ? 1 : 0, contents.settings.c_str());
}

// Without orders, the writer gives each draw one that is the source's.
void dump_draws(const sample_contents& contents, std::FILE* out) {
  const bool in_source_order = contents.orders.empty();
  for (std::size_t i = 0; i < contents.draws.size(); ++i) {
    const auto& d = contents.draws[i];
    std::fprintf(out, "draw %zu: %u %u %u %u %u %u %u %u %u %u %llu %u %zu\n", i, d.node, d.mesh, d.primitive,
                 d.instance, d.material, d.group, d.first_source, d.polygon_count, d.first_stored, d.base_vertex,
                 static_cast<unsigned long long>(d.host_tag), d.flags, in_source_order ? i : contents.order_of_draw[i]);
  }
  for (std::size_t i = 0; i < contents.named_groups.size(); ++i) {
    std::fprintf(out, "named group %zu: %s\n", i, contents.named_groups[i].c_str());
  }
  for (std::size_t i = 0; i < contents.draws.size(); ++i) {
    const std::uint32_t group = contents.draws[i].named_group;
    if (group != sightcell::format::no_named_group) std::fprintf(out, "named group of draw %zu: %u\n", i, group);
  }
  std::vector<std::vector<std::uint32_t>> orders = contents.orders;
  for (std::size_t i = 0; i < contents.draws.size() && in_source_order; ++i) {
    orders.emplace_back(contents.draws[i].polygon_count);
    std::iota(orders.back().begin(), orders.back().end(), 0u);
  }
  for (std::size_t i = 0; i < orders.size(); ++i) {
    std::fprintf(out, "order %zu:", i);
    dump_numbers(orders[i], out);
  }
  for (std::size_t i = 0; i < contents.clusters.size(); ++i) {
    std::fprintf(out, "clusters of order %zu:", i);
    dump_numbers(contents.clusters[i], out);
  }
}

// What a cell sees of polygons, or of volumes by their own numbers.
std::vector<std::uint32_t> items_of(const sample_contents& contents, std::size_t cell, bool volumes) {
  const std::uint32_t polygons = contents.facts.polygon_count;
  std::vector<std::uint32_t> items;
  for (const std::uint32_t item : contents.sets[cell]) {
    if ((item >= polygons) == volumes) items.push_back(volumes ? item - polygons : item);
  }
  return items;
}

void dump_volumes(const sample_contents& contents, std::FILE* out) {
  if (contents.volumes.empty()) return;
  std::fprintf(out, "volumes %.17g %.17g\n", contents.volume_shape.width, contents.volume_shape.height);
  for (std::size_t i = 0; i < contents.volumes.size(); ++i) {
    const auto& place = contents.volumes[i];
    std::fprintf(out, "volume %zu: %d %d %d\n", i, place.x, place.y, place.z);
  }
  for (std::size_t cell = 0; cell < contents.sets.size(); ++cell) {
    std::fprintf(out, "volumes of %zu:", cell);
    dump_numbers(items_of(contents, cell, true), out);
  }
}

void dump_box(const sightcell::format::box& b, std::FILE* out) {
  for (const float value : b.min) std::fprintf(out, " %.9g", static_cast<double>(value));
  std::fputc(' ', out);
  for (const float value : b.max) std::fprintf(out, " %.9g", static_cast<double>(value));
}

void dump_cells(const sample_contents& contents, std::FILE* out) {
  if (contents.lattice) std::fprintf(out, "lattice %.17g %.17g\n", contents.lattice->width, contents.lattice->height);
  if (contents.grid) std::fprintf(out, "grid %.17g %.17g\n", contents.grid->width, contents.grid->height);
  for (std::size_t cell = 0; cell < contents.cells.size(); ++cell) {
    const auto& b = contents.cells[cell];
    std::fprintf(out, "cell %zu:", cell);
    dump_box(b, out);
    std::fputs("  sees", out);
    dump_numbers(items_of(contents, cell, false), out);
  }
  dump_volumes(contents, out);
  for (const auto& c : contents.certificate) {
    std::fprintf(out, "certificate %u: %llu %llu %.17g %.17g %llu\n", c.cell, static_cast<unsigned long long>(c.rays),
                 static_cast<unsigned long long>(c.misses), c.upper_bound, c.confidence,
                 static_cast<unsigned long long>(c.seed));
  }
}

void dump_viewpoints(const sample_contents& contents, std::FILE* out) {
  if (contents.viewpoints.empty()) return;
  std::fprintf(out, "player_radius %.9g\n", static_cast<double>(contents.player_radius));
  for (const auto& v : contents.viewpoints) {
    std::fprintf(out, "viewpoints %u: %.9g %.9g\n", v.cell, static_cast<double>(v.valid_share), v.outside_share);
  }
  for (const auto& v : contents.viewpoints) {
    sightcell::format::region_walk walk(v.region,
                                        sightcell::format::grown_box(contents.cells[v.cell], contents.facts.margin));
    for (sightcell::format::region_part part; walk.next(part);) {
      std::fprintf(out, "%s of %u:", part.inside ? "inside" : "outside", v.cell);
      dump_box(part.bounds, out);
      std::fputc('\n', out);
    }
  }
}

void dump_eyes(const sample_contents& contents, std::FILE* out) {
  for (const auto& v : contents.viewpoints) {
    for (const auto& eye : v.eyes) {
      std::fprintf(out, "eye of %u:", v.cell);
      for (const float value : sightcell::format::eye_position(contents.cells[v.cell], eye)) {
        std::fprintf(out, " %.9g", static_cast<double>(value));
      }
      std::fputc('\n', out);
    }
  }
}

void dump_identity(const sample_contents& contents, std::FILE* out) {
  if (contents.geometry_hashes.empty()) return;
  const auto dump_name = [&](const char* of, std::size_t draw, std::uint32_t number, const auto& names) {
    if (number >= names.size() || names[number].empty()) return;
    std::fprintf(out, "%s of draw %zu: %s\n", of, draw, names[number].c_str());
  };
  for (std::size_t i = 0; i < contents.draws.size(); ++i) {
    const auto& d = contents.draws[i];
    if (d.polygon_count > 0) {
      const auto place = std::count_if(contents.draws.begin(), contents.draws.end(), [&](const auto& other) {
        return other.polygon_count > 0 && other.first_source < d.first_source;
      });
      const auto hash = contents.geometry_hashes[static_cast<std::size_t>(place)];
      std::fprintf(out, "geometry hash of draw %zu: %016llx\n", i, static_cast<unsigned long long>(hash));
    }
    dump_name("node", i, d.node, contents.node_names);
    dump_name("mesh", i, d.mesh, contents.mesh_names);
  }
}

// By ascending source id, as sets are.
void dump_importance(const sample_contents& contents, std::FILE* out) {
  for (std::size_t cell = 0; cell < contents.sets.size(); ++cell) {
    std::vector<std::uint32_t> classes;
    for (const std::uint32_t polygon : contents.sets[cell])
      classes.push_back(sightcell::test::sample_class(static_cast<std::uint32_t>(cell), polygon));
    std::fprintf(out, "importance %zu:", cell);
    dump_numbers(classes, out);
  }
}

void dump_casters(const sample_contents& contents, std::FILE* out) {
  using namespace sightcell::test;
  const sample_casters casters(contents);
  for (std::size_t i = 0; i < casters.suns.size(); ++i) {
    std::fprintf(out, "sun %zu:", i);
    for (const auto* direction : {&casters.suns[i].from, &casters.suns[i].to}) {
      for (const float value : *direction) std::fprintf(out, " %.9g", static_cast<double>(value));
    }
    std::fputc('\n', out);
  }
  for (std::size_t i = 0; i < casters.sets.size(); ++i) {
    const auto& c = casters.certificate[i];
    const std::size_t cell = i / casters.suns.size(), sun = i % casters.suns.size();
    std::fprintf(out, "casters %zu %zu:", cell, sun);
    dump_numbers(casters.sets[i], out);
    std::fprintf(out, "certificate of casters %zu %zu: %llu %llu %.17g %.17g %llu\n", cell, sun,
                 static_cast<unsigned long long>(c.rays), static_cast<unsigned long long>(c.misses), c.upper_bound,
                 c.confidence, static_cast<unsigned long long>(c.seed));
  }
}

void dump_residency(const sample_contents& contents, std::FILE* out) {
  const sightcell::test::sample_residency residency(contents);
  std::fprintf(out, "residency: %.9g pixels per radian, anisotropy %.9g\n",
               static_cast<double>(residency.pixels_per_radian), static_cast<double>(residency.anisotropy));
  for (std::size_t i = 0; i < residency.textures.size(); ++i) {
    const auto& one = residency.textures[i];
    std::fprintf(out, "texture %zu: image %u, %u x %u\n", i, one.image, one.width, one.height);
  }
  for (std::size_t cell = 0; cell < residency.levels.size(); ++cell) {
    std::fprintf(out, "levels %zu:", cell);
    dump_numbers({residency.levels[cell].begin(), residency.levels[cell].end()}, out);
  }
}

void dump_lights(const sample_contents& contents, std::FILE* out) {
  const sightcell::test::sample_lights lights(contents);
  for (std::size_t i = 0; i < lights.lights.size(); ++i) {
    const auto& light = lights.lights[i];
    std::fprintf(out, "light %zu: node %u at", i, light.node);
    for (const float value : light.position) std::fprintf(out, " %.9g", static_cast<double>(value));
    std::fputs(" along", out);
    for (const float value : light.direction) std::fprintf(out, " %.9g", static_cast<double>(value));
    std::fprintf(out, ", range %.9g, cone %.9g\n", static_cast<double>(light.range), static_cast<double>(light.cone));
    std::fprintf(out, "polygons of light %zu:", i);
    dump_numbers(lights.sets[i], out);
    const auto& c = lights.certificate[i];
    std::fprintf(out, "certificate of light %zu: %llu %llu %.17g %.17g %llu\n", i,
                 static_cast<unsigned long long>(c.rays), static_cast<unsigned long long>(c.misses), c.upper_bound,
                 c.confidence, static_cast<unsigned long long>(c.seed));
  }
  for (std::size_t cell = 0; cell < lights.touching.size(); ++cell) {
    std::vector<std::uint32_t> touching;
    for (std::uint32_t i = 0; i < lights.lights.size(); ++i) {
      if (lights.touching[cell][i]) touching.push_back(i);
    }
    std::fprintf(out, "lights of cell %zu:", cell);
    dump_numbers(touching, out);
  }
}

enum class extra { nothing, importance, casters, residency, lights };

bool write(const sample_contents& contents, const std::vector<std::byte>& bytes, extra with, const std::string& name) {
  if (sightcell::format::write_file((name + ".pvs").c_str(), bytes) != sightcell::format::status::ok) return false;
  std::FILE* text = std::fopen((name + ".txt").c_str(), "wb");
  if (text == nullptr) return false;
  dump_facts(contents, text);
  dump_draws(contents, text);
  dump_cells(contents, text);
  dump_viewpoints(contents, text);
  dump_eyes(contents, text);
  dump_identity(contents, text);
  if (with == extra::importance) dump_importance(contents, text);
  if (with == extra::casters) dump_casters(contents, text);
  if (with == extra::residency) dump_residency(contents, text);
  if (with == extra::lights) dump_lights(contents, text);
  return std::fclose(text) == 0;
}

// All files anew, so that none stays of which the fault has another name now.
bool write_damaged(const std::string& folder) {
  std::error_code failed;
  std::filesystem::remove_all(folder, failed);
  if (!std::filesystem::create_directory(folder, failed)) return false;
  std::FILE* statuses = std::fopen((folder + "/statuses.txt").c_str(), "wb");
  if (statuses == nullptr) return false;
  bool written = true;
  for (const auto& file : sightcell::test::damaged_files()) {
    const std::string name = file.name + ".pvs";
    written = written &&
              sightcell::format::write_file((folder + "/" + name).c_str(), file.bytes) == sightcell::format::status::ok;
    std::fprintf(statuses, "%s %s\n", name.c_str(), sightcell::test::status_name(file.expected));
  }
  return std::fclose(statuses) == 0 && written;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: write_golden FOLDER\n");
    return 2;
  }
  const std::string folder = argv[1];
  bool written = true;
  for (const auto& [name, contents] : sightcell::test::golden_files()) {
    written = written && write(contents, contents.encode(), extra::nothing, folder + "/" + name);
  }
  for (const auto& [name, contents] : sightcell::test::golden_files_with_importance()) {
    const auto bytes = sightcell::test::importance_golden_bytes(contents);
    written = written && write(contents, bytes, extra::importance, folder + "/" + name);
  }
  const sample_contents with_casters = sightcell::test::caster_golden_contents();
  written =
      written && write(with_casters, sightcell::test::caster_golden_bytes(), extra::casters, folder + "/v1_casters");
  written = written && write(sightcell::test::residency_golden_contents(), sightcell::test::residency_golden_bytes(),
                             extra::residency, folder + "/v1_residency");
  written = written && write(sightcell::test::light_golden_contents(), sightcell::test::light_golden_bytes(),
                             extra::lights, folder + "/v1_lights");
  written = written && write_damaged(folder + "/golden_errors");
  if (!written) std::fprintf(stderr, "write_golden: cannot write to %s\n", folder.c_str());
  return written ? 0 : 1;
}
