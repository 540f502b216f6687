#include "scene_options.h"

#include <fmt/format.h>

#include <utility>

#include "help.h"
#include "number_text.h"

namespace sightcell::cli {

void add_scene_argument(CLI::App& verb, scene_options& options, const std::string& help) {
  verb.add_option("SCENE", options.scene, help)->type_name("FILE");
}

void add_two_scene_options(CLI::App& verb, scene_options& options, const std::string& group) {
  CLI::Option* polygons =
      add_plain_option(verb, group, "--polygons-from", options.polygons_from, "SCENE",
                       "Instead of SCENE, with --cells-from: the scene whose polygons are in the sets.");
  add_plain_option(verb, group, "--cells-from", options.cells_from, "SCENE",
                   "With --polygons-from: the scene of the view cells. It is in the same world and occludes; none of "
                   "its polygons is in a set.")
      ->needs(polygons);
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
  line.loading(options.cells_from);
  scene::scene s = scene::load_gltf(options.cells_from);
  for (const std::string& warning : s.warnings) line.message("warning: " + warning);
  line.message(fmt::format("{}: cells among {} polygons, which occlude", s.name, grouped(s.polygon_count)));
  return s;
}

}  // namespace sightcell::cli
