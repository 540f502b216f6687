#include "job/bake_input.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "input/two_scenes.h"
#include "job/memory_limit.h"
#include "misses/misses_file.h"
#include "sightcell/base/error.h"
#include "sightcell/base/nearest_name.h"

namespace sightcell::bake {
namespace {

scene::world_geometry flatten_with(const overrides& given, const scene::scene& s, const settings& how) {
  scene::world_geometry geometry = scene::flatten(s, how.animated, how.closed);
  apply(given, geometry);
  if (std::all_of(geometry.kinds.begin(), geometry.kinds.end(),
                  [](const scene::polygon_kind& kind) { return kind.absent; }))
    throw error(error_kind::bad_input, "bake.nothing-to-see", s.name, "has no triangle that could be seen",
                "export meshes with triangles, or name another file");
  return geometry;
}

void require_groups(const scene::scene& s, const settings& how) {
  std::vector<std::string_view> names(s.groups.begin(), s.groups.end());
  if (how.cells_from != nullptr)
    names.insert(names.end(), how.cells_from->groups.begin(), how.cells_from->groups.end());
  for (const std::string& closed : how.closed) {
    if (std::find(names.begin(), names.end(), closed) != names.end()) continue;
    throw error(error_kind::wrong_use, "settings.no-such-group", "--closed",
                "\"" + closed + "\" is no named group of " + s.name,
                names.empty() ? "give nodes the mark extras.sightcell.group"
                              : "give a name that `sightcell info --json` lists" + did_you_mean(closed, names));
  }
}

}  // namespace

bake_input load_input(const scene::scene& s, const settings& how) {
  require_groups(s, how);
  require_memory(s, how);
  bake_input input;
  if (how.cells_file) input.given = read_overrides(*how.cells_file, s);
  if (how.misses_file) input.misses = reported_misses(read_misses(*how.misses_file, s));
  input.geometry = flatten_with(input.given, s, how);
  if (how.cells_from) {
    scene::world_geometry other = scene::flatten(*how.cells_from, how.animated, how.closed);
    input.cells = make_all_cells(other, how);
    append(input.geometry, std::move(other), how.all_double_sided, how.cells_from->name);
  }
  require_memory(s, how, &input.geometry);
  return input;
}

}  // namespace sightcell::bake
