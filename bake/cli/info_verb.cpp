// sightcell info SCENE|FILE.pvs
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "exit_codes.h"
#include "file_info.h"
#include "help.h"
#include "metric_options.h"
#include "number_text.h"
#include "pvs_file.h"
#include "scene_info.h"
#include "sightcell/format/reader.h"
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

// Returns whether the settings of a file are those of a bake with --cell-limit.
bool is_trial(const ordered_json& settings) {
  const auto limit = settings.is_object() ? settings.find("cell_limit") : settings.end();
  return settings.is_object() && limit != settings.end() && limit->is_number_unsigned() && *limit > 0;
}

void print_file(const std::filesystem::path& path, const ordered_json& info) {
  fmt::print("{}: {} cells, {} polygons, {} draws, {} bytes, format version {}\n", path.string(),
             grouped(info["cells"]), grouped(info["polygons"]), grouped(info["draws"]), grouped(info["bytes"]),
             info["format_version"].get<std::uint32_t>());
  fmt::print("  visible per cell   {:.3f} % of all polygons, {:.1f} runs, {:.1f} ranges\n",
             info["visible_set_percent"].get<double>(), info["runs_per_cell"].get<double>(),
             info["ranges_per_cell"].get<double>());
  fmt::print(
      "  calls per cell     {:.1f} of whole objects, {:.1f} of ranges, {:.1f} with gaps below {} polygons drawn too\n",
      info["draws_per_cell"].get<double>(), info["ranges_per_cell"].get<double>(),
      info["joined_ranges_per_cell"].get<double>(), format::row_statistics::joined_gap);
  if (is_trial(info["settings"]))
    fmt::print(
        "  trial              not all cells of the scene: the whole bake has more ranges per cell and more bits\n");
  if (info["clusters"].get<std::uint32_t>() > 0)
    fmt::print("  clusters           {} in the scene, {:.1f} per cell\n", grouped(info["clusters"]),
               info["clusters_per_cell"].get<double>());
  fmt::print("  size               {:.3f} bits per visible polygon, {:.0f} % of the rows are differences\n",
             info["bits_per_visible_polygon"].get<double>(), info["delta_row_percent"].get<double>());
  fmt::print("  chunks             {} of {:.1f} cells, the largest has {} bytes\n", grouped(info["chunks"]),
             info["cells_per_chunk"].get<double>(), grouped(info["largest_chunk_bytes"]));
  if (info["false_visible_percent"].is_number())
    fmt::print("  slack              {:.2f} % more {} than are seen\n", info["false_visible_percent"].get<double>(),
               info["clusters"].get<std::uint32_t>() > 0 ? "clusters" : "polygons");
  if (info["importance"].is_object())
    fmt::print("  importance         {:.3f} bits per visible polygon\n",
               info["importance"]["bits_per_visible_polygon"].get<double>());
  if (info["residency"].is_object())
    fmt::print("  texture residency  {} textures, {:.1f} % of their texels per cell, at {:.0f} pixels per radian\n",
               grouped(info["residency"]["textures"]), info["residency"]["texels_percent"].get<double>(),
               info["residency"]["pixels_per_radian"].get<double>());
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
  ordered_json info;
  if (pvs) {
    info = file_info(*pvs, options.path.string());
  } else {
    const scene::scene s = scene::load_gltf(options.path, options.scene);
    info = scene_info(s);
    add_embedded(options.path, s, info);
  }
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
