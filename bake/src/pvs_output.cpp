#include "pvs_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sightcell/format/writer.h"
#include "sightcell/scene/error.h"

namespace sightcell::bake {
namespace {

std::vector<format::draw_record> draw_table(const scene::scene& s) {
  std::vector<format::draw_record> table;
  table.reserve(s.draws.size());
  for (const scene::draw& d : s.draws)
    table.push_back({.node = d.node,
                     .mesh = d.mesh,
                     .primitive = d.primitive,
                     .instance = d.instance,
                     .material = d.material,
                     .group = 0,
                     .first_source = d.first_source,
                     .polygon_count = d.polygon_count,
                     .first_stored = d.first_source,  // version 0: stored order is source order
                     .base_vertex = d.base_vertex,
                     .host_tag = d.host_tag});
  return table;
}

// A bound may only be rounded upwards.
float rounded_up(double bound) {
  const auto nearest = static_cast<float>(bound);
  return static_cast<double>(nearest) < bound ? std::nextafter(nearest, 2.0f) : nearest;
}

void require_ok(format::status outcome, const std::filesystem::path& output, const char* doing) {
  if (outcome == format::status::ok) return;
  const bool disk = outcome == format::status::io;
  throw error(
      error_kind::failed, disk ? "output.io" : "output.encode", output.string(),
      fmt::format("{} failed: {}", doing, format::status_text(outcome)),
      disk ? "free space or choose another folder, then run the same command: it resumes" : "report this scene");
}

}  // namespace

void write_pvs(const scene::scene& s, const settings& how, const std::string& settings_text,
               const std::vector<view_cell>& cells, std::vector<cell_record>& records,
               const std::filesystem::path& output, const callbacks& tell, summary& sum) {
  std::vector<format::box> boxes;
  std::vector<std::vector<std::uint32_t>> sets;
  std::vector<format::certificate_record> certificate;
  double visible = 0.0;
  sum.max_upper_bound = 0.0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cell_record& record = records[i];
    const view_cell& c = cells[i];
    if (!record.stored) {
      ++sum.cells_left_out;
      continue;
    }
    certificate.push_back({.cell = static_cast<std::uint32_t>(boxes.size()),
                           .rays = record.rays,
                           .misses = record.misses,
                           .upper_bound = record.upper_bound,
                           .confidence = record.confidence,
                           .seed = how.seed});
    boxes.push_back({{c.min.x, c.min.y, c.min.z}, {c.max.x, c.max.y, c.max.z}});
    visible += static_cast<double>(record.set.size());
    sum.max_upper_bound = std::max(sum.max_upper_bound, record.upper_bound);
    if (!record.bound_met) ++sum.cells_over_bound;
    sets.push_back(std::move(record.set));
  }
  if (boxes.empty())
    throw error(error_kind::failed, "bake.no-free-cell", s.name, "no cell has a place where an eye can be",
                "give boxes with --cells-file or --cells-grid, or a smaller --player-radius");
  if (sum.cells_left_out > 0 && tell.on_message)
    tell.on_message(severity::warning,
                    fmt::format("{} of {} cells have no free point and are left out; an eye there is outside",
                                sum.cells_left_out, cells.size()));

  const std::vector<format::draw_record> draws = draw_table(s);
  format::file_contents contents;
  contents.facts.polygon_count = s.polygon_count;
  contents.facts.margin = how.margin;
  contents.facts.max_pixel_error = rounded_up(sum.max_upper_bound);
  contents.facts.scene_fingerprint = s.fingerprint;
  contents.draws = draws;
  contents.cells = boxes;
  contents.cell_sets = sets;
  contents.certificate = certificate;
  contents.settings = settings_text;
  std::vector<std::byte> bytes;
  require_ok(format::encode(contents, bytes), output, "encoding");
  require_ok(format::write_file(output.string().c_str(), bytes), output, "writing");

  sum.cells = static_cast<std::uint32_t>(boxes.size());
  sum.visible_percent = 100.0 * visible / (static_cast<double>(boxes.size()) * std::max(s.polygon_count, 1u));
  sum.bytes = bytes.size();
  if (sum.cells_over_bound > 0) sum.result = outcome::bound_not_met;
}

}  // namespace sightcell::bake
