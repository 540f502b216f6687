// sightcell info SCENE|FILE.pvs
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "exit_codes.h"
#include "help.h"
#include "metric_options.h"
#include "number_text.h"
#include "pvs_file.h"
#include "scene_info.h"
#include "sightcell/bake/inspect.h"
#include "sightcell/base/json_text.h"
#include "sightcell/format/layout.h"
#include "sightcell/scene/scene.h"
#include "verbs.h"

namespace sightcell::cli {

namespace {

using nlohmann::ordered_json;

struct info_options {
  std::filesystem::path path;
  bool json = false;
  int scene = -1;
};

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
    case format::layout::section_borders:
      return "chunk borders";
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

ordered_json named_groups_json(const format::reader& file) {
  ordered_json names = ordered_json::array();
  std::string_view name;
  for (std::uint32_t i = 0; i < file.named_groups().count(); ++i) {
    if (file.named_groups().name(i, name)) names.push_back(std::string(name));
  }
  return names;
}

// The settings text is somebody's JSON: shown as such when it is, as text when it is not.
ordered_json settings_json(std::string_view text) {
  if (text.empty()) return nullptr;
  ordered_json parsed = scene::parse_ordered_json(text, false);
  return parsed.is_discarded() ? ordered_json(std::string(text)) : parsed;
}

// How the sets were dilated unseen, by the settings text: "edge", "vertex"; empty where they were not.
std::string safety_ring_of(const ordered_json& settings) {
  if (!settings.is_object() || !settings.contains("safety_ring")) return {};
  const ordered_json& named = settings["safety_ring"];
  return named.is_string() ? named.get<std::string>() : std::string();
}

double visible_percent(const format::row_statistics& sums, std::uint32_t polygons) {
  const double all = static_cast<double>(sums.cells) * polygons;
  return all > 0.0 ? 100.0 * static_cast<double>(sums.polygons) / all : 0.0;
}

ordered_json file_json(const pvs_file& pvs, const std::string& name) {
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
          {"volumes", file.volumes().count()},
          {"volume_width", file.volumes().count() > 0 ? ordered_json(file.volumes().shape().width) : nullptr},
          {"volumes_per_cell", sums.volumes_per_cell()},
          // Of the bytes, those that would not be there without them.
          {"volume_percent", 100.0 - 100.0 * static_cast<double>(bake::size_without_volumes(pvs.bytes(), name)) /
                                         static_cast<double>(pvs.size())},
          {"named_groups", named_groups_json(file)},
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

void print_file(const std::filesystem::path& path, const ordered_json& info) {
  fmt::print("{}: {} cells, {} polygons, {} draws, {} bytes, format version {}\n", path.string(),
             grouped(info["cells"]), grouped(info["polygons"]), grouped(info["draws"]), grouped(info["bytes"]),
             info["format_version"].get<std::uint32_t>());
  fmt::print("  visible per cell   {:.3f} % of all polygons, {:.1f} runs, {:.1f} ranges\n",
             info["visible_set_percent"].get<double>(), info["runs_per_cell"].get<double>(),
             info["ranges_per_cell"].get<double>());
  fmt::print("  size               {:.3f} bits per visible polygon, {:.0f} % of the rows are differences\n",
             info["bits_per_visible_polygon"].get<double>(), info["delta_row_percent"].get<double>());
  fmt::print("  chunks             {} of {:.1f} cells, the largest has {} bytes\n", grouped(info["chunks"]),
             info["cells_per_chunk"].get<double>(), grouped(info["largest_chunk_bytes"]));
  if (info["false_visible_percent"].is_number())
    fmt::print("  slack              {:.2f} % more polygons than are seen\n",
               info["false_visible_percent"].get<double>());
  if (info["importance"].is_object())
    fmt::print("  importance         {:.3f} bits per visible polygon\n",
               info["importance"]["bits_per_visible_polygon"].get<double>());
  if (info["volumes"].get<std::uint32_t>() > 0)
    fmt::print("  volumes            {} of {:g} m, {:.0f} seen per cell, {:.1f} % of the bytes\n",
               grouped(info["volumes"]), info["volume_width"].get<double>(), info["volumes_per_cell"].get<double>(),
               info["volume_percent"].get<double>());
  fmt::print("  {:<18} at most {:g} in every cell, confidence {:g}\n", error_name(info["metric"].get<std::string>()),
             info["max_pixel_error"].get<double>(), info["confidence"].get<double>());
  if (const std::string ring = safety_ring_of(info["settings"]); !ring.empty())
    fmt::print("  safety ring        {}: what shares one with a polygon that was found is in the sets too, unseen\n",
               ring);
  fmt::print("  layout             {}, margin {:g} m, {}\n", info["layout"].get<std::string>(),
             info["margin"].get<double>(), info["repeatable"].get<bool>() ? "repeatable" : "not repeatable");
  if (!info["named_groups"].empty())
    fmt::print("  named groups       {}\n",
               info["named_groups"].dump(-1, ' ', false, ordered_json::error_handler_t::replace));
  fmt::print("  scene fingerprint  {}\n", info["fingerprint"].get<std::string>());
  fmt::print("  settings           {}\n", info["settings"].dump());
  for (const ordered_json& section : info["sections"])
    fmt::print("  section            {:<14} {} bytes\n", section["name"].get<std::string>(), grouped(section["size"]));
}

int run_info(const info_options& options) {
  const std::optional<pvs_file> pvs = pvs_file::open_if_pvs(options.path);
  const ordered_json info =
      pvs ? file_json(*pvs, options.path.string()) : scene_info(scene::load_gltf(options.path, options.scene));
  if (options.json)
    fmt::print("{}\n", info.dump(2, ' ', false, ordered_json::error_handler_t::replace));
  else if (pvs)
    print_file(options.path, info);
  else
    print_scene_info(options.path, info);
  return exit_done;
}

}  // namespace

void add_info_verb(CLI::App& program, action& chosen) {
  auto options = std::make_shared<info_options>();
  CLI::App& verb = add_verb(
      program, "info",
      {.summary = "Prints what a scene or a .pvs file contains",
       .usage = "FILE [options]",
       .description = "Of a scene: polygons, materials, marks, extensions, and what a bake would warn about. Of a .pvs "
                      "file: cells, sizes, bounds, settings and sections.",
       .examples = {"sightcell info level.glb", "sightcell info level.pvs"}});
  verb.add_option("FILE", options->path, "A scene (.glb or .gltf) or a .pvs file.")->required();
  verb.add_option("--scene", options->scene,
                  "Number of the glTF scene in the file, from 0. Without it: the default scene of the file.")
      ->type_name("N")
      ->check(CLI::Range(0, INT32_MAX));
  verb.add_flag("--json", options->json, "Prints the result as one JSON object on standard output.");
  verb.callback([options, &chosen] { chosen = [options] { return run_info(*options); }; });
}

}  // namespace sightcell::cli
