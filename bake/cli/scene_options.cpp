#include "scene_options.h"

#include <fmt/format.h>

#include <utility>

#include "number_text.h"

namespace sightcell::cli {

void add_scene_options(CLI::App& verb, scene_options& options, const std::string& group) {
  verb.add_option("SCENE", options.scene, ".glb or .gltf")->type_name("FILE");
  CLI::Option* polygons =
      verb.add_option("--polygons-from", options.polygons_from,
                      "in the place of SCENE, with --cells-from: the scene whose polygons sets are about")
          ->type_name("SCENE")
          ->group(group);
  verb.add_option("--cells-from", options.cells_from,
                  "the scene that the cells are in: it stands in the same world, and hides; it is in no set")
      ->type_name("SCENE")
      ->needs(polygons)
      ->group(group);
  polygons->needs("--cells-from");
}

void settle_scenes(scene_options& options, std::filesystem::path* file) {
  if (options.two()) {
    if (file != nullptr && file->empty()) std::swap(*file, options.scene);
    if (!options.scene.empty()) throw CLI::ExcludesError("SCENE", "--polygons-from");
    options.scene = options.polygons_from;
  }
  if (options.scene.empty()) throw CLI::RequiredError("SCENE");
  if (file != nullptr && file->empty()) throw CLI::RequiredError("FILE");
}

std::optional<scene::scene> load_scene_of_cells(const scene_options& options, progress_line& line) {
  if (!options.two()) return std::nullopt;
  scene::scene s = scene::load_gltf(options.cells_from);
  for (const std::string& warning : s.warnings) line.message("warning: " + warning);
  line.message(fmt::format("{}: cells among {} polygons, which hide", s.name, grouped(s.polygon_count)));
  return s;
}

}  // namespace sightcell::cli
