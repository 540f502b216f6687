// sightcell-city: see README.md beside this file.
#include <CLI/CLI.hpp>
#include <cstdint>
#include <iostream>
#include <string>

#include "city.h"
#include "glb_writer.h"
#include "sightcell/base/error.h"

namespace {

int exit_code(sightcell::error_kind kind) {
  switch (kind) {
    case sightcell::error_kind::wrong_use:
      return 2;
    case sightcell::error_kind::bad_input:
      return 4;
    default:
      return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Writes a town of exactly as many polygons as asked for; the same numbers give the same bytes.",
               "sightcell-city");
  std::uint64_t polygons = 100'000;
  std::uint64_t seed = 1;
  std::string out, cells, preset;
  bool textured = false;
  CLI::Option* count = app.add_option("--polygons", polygons, "how many polygons, 500 or more")->capture_default_str();
  CLI::Option* named =
      app.add_option("--preset", preset, "a larger, richer town: " + std::string(sightcell::city::preset_names()));
  named->excludes(count);
  app.add_flag("--textured", textured, "with textures; the polygons stay the same")->needs(named);
  app.add_option("--seed", seed, "another number gives another town")->capture_default_str();
  app.add_option("--out", out, "the .glb to write")->required();
  app.add_option("--cells", cells, "a JSON file of view cells to write");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    const sightcell::city::style* style = nullptr;
    if (!preset.empty()) {
      style = sightcell::city::find_preset(preset);
      if (style == nullptr) {
        throw sightcell::error(sightcell::error_kind::wrong_use, "city.preset", "the preset '" + preset + "'",
                               "there is none of that name", "ask for " + std::string(sightcell::city::preset_names()));
      }
      polygons = style->polygons;
    }
    const sightcell::city::model city = style != nullptr ? sightcell::city::make_town(*style, polygons, seed)
                                                         : sightcell::city::make_city(polygons, seed);
    sightcell::city::write_glb(city, out, textured);
    if (!cells.empty()) sightcell::city::write_cells(city, cells);
    std::cerr << out << ": " << polygons << " polygons, " << city.nodes.size() << " nodes, " << city.meshes.size()
              << " meshes, " << city.cells.size() << " cells, seed " << seed << '\n';
  } catch (const sightcell::error& e) {
    std::cerr << e.what() << '\n';
    return exit_code(e.kind());
  } catch (const std::exception& e) {
    std::cerr << "sightcell-city: " << e.what() << '\n';
    return 1;
  }
  return 0;
}
