#include "file_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "number_text.h"
#include "sightcell/bake/inspect.h"
#include "sightcell/base/json_text.h"
#include "sightcell/format/identity_table.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/light_table.h"
#include "sightcell/format/residency_table.h"

namespace sightcell::cli {
namespace {

using nlohmann::ordered_json;

std::string section_name(std::uint32_t id) {
  switch (id) {
    case format::layout::section_draws:
      return "draws";
    case format::layout::section_cells:
      return "cells";
    case format::layout::section_rows:
      return "rows";
    case format::layout::section_row_directory:
      return "row directory";
    case format::layout::section_certificate:
      return "certificate";
    case format::layout::section_settings:
      return "settings";
    case format::layout::section_orders:
      return "orders";
    case format::layout::section_codes:
      return "codes";
    case format::layout::section_importance:
      return "importance";
    case format::layout::section_volumes:
      return "volumes";
    case format::layout::section_named_groups:
      return "named groups";
    case format::layout::section_viewpoints:
      return "viewpoints";
    case format::layout::section_eyes:
      return "eyes";
    case format::layout::section_identity:
      return "draw identity";
    case format::layout::section_casters:
      return "shadow casters";
    case format::layout::section_lights:
      return "lights";
    case format::layout::section_residency:
      return "texture residency";
    case format::layout::section_borders:
      return "chunk borders";
    case format::layout::section_clusters:
      return "clusters";
    default:
      return fmt::format("unknown {}", id);
  }
}

ordered_json sections_json(const format::reader& file) {
  ordered_json list = ordered_json::array();
  for (std::uint32_t i = 0; i < file.section_count(); ++i) {
    format::section_record section;
    if (file.section(i, section) != format::status::ok) continue;
    list.push_back({{"id", section.id},
                    {"name", section_name(section.id)},
                    {"offset", section.offset},
                    {"size", section.size},
                    {"required", section.required}});
  }
  return list;
}

ordered_json certificate_json(const format::reader& file) {
  ordered_json list = ordered_json::array();
  for (std::uint32_t i = 0; i < file.certificate_count(); ++i) {
    format::certificate_record c;
    if (file.certificate(i, c) != format::status::ok) continue;
    list.push_back({{"cell", c.cell},
                    {"rays", c.rays},
                    {"misses", c.misses},
                    {"upper_bound", c.upper_bound},
                    {"confidence", c.confidence},
                    {"seed", c.seed}});
  }
  return list;
}

// What the order of polygons inside cells takes; null where there is none.
ordered_json importance_json(const format::reader& file, std::uint64_t visible_polygons) {
  for (std::uint32_t i = 0; i < file.section_count(); ++i) {
    format::section_record section;
    if (file.section(i, section) != format::status::ok || section.id != format::layout::section_importance) continue;
    const double bits =
        8.0 * static_cast<double>(section.size) / static_cast<double>(std::max<std::uint64_t>(visible_polygons, 1));
    return {{"bytes", section.size}, {"bits_per_visible_polygon", bits}};
  }
  return nullptr;
}

// Texels of a texture from a level on, with all coarser ones.
double texels_from(const format::texture_record& texture, std::uint8_t number) {
  if (number == format::no_level) return 0.0;
  const int finest = std::max(number - format::level_zero, 0) / format::quarters_of_level;
  double texels = 0.0;
  for (int level = finest; level <= (format::coarsest_level(texture) - format::level_zero) / 4; ++level)
    texels += static_cast<double>(std::max(texture.width >> level, 1u)) * std::max(texture.height >> level, 1u);
  return texels;
}

// What a host keeps in memory by the levels of cells; null where there are none.
ordered_json residency_json(const format::reader& file) {
  format::residency_table table;
  const format::status opened = format::residency_table::open(file, table);
  if (opened == format::status::absent) return nullptr;
  std::vector<std::byte> memory(format::residency_table::codes_size());
  std::vector<std::uint8_t> levels(table.texture_count());
  const format::residency_codes* codes = nullptr;
  format::status s = opened == format::status::ok ? table.make_codes(memory, codes) : opened;
  double all = 0.0, needed = 0.0;
  for (std::uint32_t i = 0; i < table.texture_count(); ++i) all += texels_from(table.texture(i), format::level_zero);
  for (std::uint32_t cell = 0; s == format::status::ok && cell < file.cell_count(); ++cell) {
    s = table.decode(cell, codes, levels);
    for (std::uint32_t i = 0; i < table.texture_count(); ++i) needed += texels_from(table.texture(i), levels[i]);
  }
  if (s != format::status::ok) return std::string(format::status_text(s));
  return {{"textures", table.texture_count()},
          {"pixels_per_radian", table.pixels_per_radian()},
          {"anisotropy", table.anisotropy()},
          {"texels_percent", all > 0.0 ? 100.0 * needed / (all * file.cell_count()) : 0.0}};
}

// Of each light what it is and its bound; null where there are none.
ordered_json lights_json(const format::reader& file) {
  format::light_table table;
  const format::status opened = format::light_table::open(file, table);
  if (opened == format::status::absent) return nullptr;
  if (opened != format::status::ok) return std::string(format::status_text(opened));
  ordered_json list = ordered_json::array();
  for (std::uint32_t i = 0; i < table.light_count(); ++i) {
    format::light_record light;
    format::certificate_record proof;
    if (table.light(i, light) != format::status::ok) continue;
    if (table.sets().certificate(i, i, proof) != format::status::ok) continue;
    std::uint32_t cells = 0;
    for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) cells += table.touches(cell, i) ? 1 : 0;
    list.push_back({{"node", light.node},
                    {"position", light.position},
                    {"range", std::isfinite(light.range) ? ordered_json(light.range) : ordered_json(nullptr)},
                    {"cone", light.cone},
                    {"upper_bound", proof.upper_bound},
                    {"cells", cells}});
  }
  return list;
}

ordered_json named_groups_json(const format::reader& file) {
  ordered_json names = ordered_json::array();
  std::string_view name;
  for (std::uint32_t i = 0; i < file.named_groups().count(); ++i) {
    if (file.named_groups().name(i, name)) names.push_back(std::string(name));
  }
  return names;
}

// Geometry hashes and names; null where there are none.
ordered_json identity_json(const format::reader& file) {
  format::identity_table table;
  const format::status opened = format::identity_table::open(file, table);
  if (opened == format::status::absent) return nullptr;
  if (opened != format::status::ok) return std::string(format::status_text(opened));
  return {{"draws", table.draw_count()}, {"geometries", table.hash_count()}, {"names", table.name_count()}};
}

// The settings text is somebody's JSON: shown as such when it is, as text when it is not.
ordered_json settings_json(std::string_view text) {
  if (text.empty()) return nullptr;
  ordered_json parsed = scene::parse_ordered_json(text, false);
  return parsed.is_discarded() ? ordered_json(std::string(text)) : parsed;
}

double visible_percent(const format::row_statistics& sums, std::uint32_t polygons) {
  const double all = static_cast<double>(sums.cells) * polygons;
  return all > 0.0 ? 100.0 * static_cast<double>(sums.polygons) / all : 0.0;
}

}  // namespace

std::string safety_ring_of(const ordered_json& settings) {
  if (!settings.is_object() || !settings.contains("safety_ring")) return {};
  const ordered_json& named = settings["safety_ring"];
  return named.is_string() ? named.get<std::string>() : std::string();
}

ordered_json file_info(const pvs_file& pvs, const std::string& name) {
  const format::reader& file = pvs.content();
  const format::row_statistics sums = pvs.statistics();
  const format::file_facts& facts = file.facts();
  const ordered_json settings = settings_json(file.settings());
  return {{"cells", file.cell_count()},
          {"polygons", file.polygon_count()},
          {"draws", file.draw_count()},
          {"bytes", pvs.size()},
          {"visible_set_percent", visible_percent(sums, file.polygon_count())},
          {"bits_per_visible_polygon", sums.bits_per_visible_polygon()},
          {"runs_per_cell", sums.runs_per_cell()},
          {"ranges_per_cell", sums.ranges_per_cell()},
          {"joined_ranges_per_cell", sums.joined_ranges_per_cell()},
          {"draws_per_cell", sums.draws_per_cell()},
          {"clusters", file.cluster_count()},  // 0: sets are of polygons
          {"clusters_per_cell", sums.clusters_per_cell()},
          {"chunks", sums.chunks},
          {"cells_per_chunk", sums.cells_per_chunk()},
          {"largest_chunk_bytes", sums.largest_chunk},
          {"delta_row_percent", sums.delta_row_percent()},
          {"shared_row_percent", sums.shared_row_percent()},
          // Of slack, in percent of what is seen. Which of a safety ring's polygons can be seen nobody has asked.
          {"false_visible_percent", safety_ring_of(settings).empty()
                                        ? ordered_json(100.0 * static_cast<double>(facts.slack))
                                        : ordered_json(nullptr)},
          {"importance", importance_json(file, sums.polygons)},
          {"residency", residency_json(file)},
          {"lights", lights_json(file)},
          {"volumes", file.volumes().count()},
          {"volume_width", file.volumes().count() > 0 ? ordered_json(file.volumes().shape().width) : nullptr},
          {"volumes_per_cell", sums.volumes_per_cell()},
          // Of the bytes, those that would not be there without them.
          {"volume_percent", 100.0 - 100.0 * static_cast<double>(bake::size_without_volumes(pvs.bytes(), name)) /
                                         static_cast<double>(pvs.size())},
          {"named_groups", named_groups_json(file)},
          {"identity", identity_json(file)},
          {"layout", facts.layout == format::host_layout::merged ? "merged" : "instanced"},
          {"margin", facts.margin},
          {"metric", pvs.metric()},
          {"max_pixel_error", facts.max_pixel_error},
          {"confidence", facts.confidence},
          {"format_version", file.format_version()},
          {"sections", sections_json(file)},
          {"fingerprint", hex(facts.scene_fingerprint)},
          {"settings", settings},
          {"repeatable", facts.repeatable},
          {"certificate", certificate_json(file)}};
}

}  // namespace sightcell::cli
