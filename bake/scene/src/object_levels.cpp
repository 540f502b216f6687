#include "sightcell/scene/object_levels.h"

#include <map>
#include <new>
#include <tuple>
#include <utility>

#include "gltf_file.h"
#include "import_scene.h"

namespace sightcell::scene {
namespace {

using draw_key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;

draw_key draw_key_of(const draw& d) {
  return {d.node, d.primitive, d.instance};
}

// all: the scene with all levels in its tree.
object_levels split_levels(scene all, const scene& s, const std::vector<object_switches>& switches) {
  std::map<draw_key, std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < s.draws.size(); ++i) numbers.emplace(draw_key_of(s.draws[i]), i);
  object_levels out;
  out.objects.resize(switches.size());
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<draw>> draws;  // by object and level
  for (draw& d : all.draws) {
    if (d.lod_object == no_index) continue;
    const std::pair place(d.lod_object, d.lod_level);
    if (d.lod_level == 0) {
      const auto found = numbers.find(draw_key_of(d));
      if (found != numbers.end()) out.objects[d.lod_object].finest.push_back(found->second);
    } else {
      draw& level = draws[place].emplace_back(d);
      level.lod_object = no_index, level.lod_level = 0;
    }
  }
  out.coarser = std::move(all);
  out.coarser.draws.clear();
  out.coarser.warnings.clear();
  for (auto& [place, of_level] : draws) {
    const auto& [object, level] = place;
    const object_switches& known = switches[object];
    out.objects[object].least_coverage = known.least_coverage;
    object_level& added = out.objects[object].coarser.emplace_back();
    if (level <= known.begins.size()) added.begins = known.begins[level - 1];
    // A range of draws, until `finish` has numbered their polygons.
    added.polygons.first = static_cast<std::uint32_t>(out.coarser.draws.size());
    added.polygons.count = static_cast<std::uint32_t>(of_level.size());
    out.coarser.draws.insert(out.coarser.draws.end(), of_level.begin(), of_level.end());
  }
  finish(out.coarser);
  for (leveled_object& object : out.objects)
    for (object_level& level : object.coarser) {
      const std::uint32_t first = level.polygons.first, after = first + level.polygons.count;
      const auto source_of = [&](std::uint32_t d) {
        return d < out.coarser.draws.size() ? out.coarser.draws[d].first_source : out.coarser.polygon_count;
      };
      level.polygons = {source_of(first), source_of(after) - source_of(first)};
    }
  return out;
}

}  // namespace

object_levels load_object_levels(const std::filesystem::path& path, const scene& s, int scene_index) {
  const gltf_source source = source_of(path);
  try {
    std::vector<object_switches> switches;
    scene all = import_gltf(split_gltf(read_scene_bytes(path), source.name), source, s.name, scene_index, nullptr,
                            &switches, true);
    return split_levels(std::move(all), s, switches);
  } catch (const std::bad_alloc&) {
    refuse_for_memory(source.name);
  }
}

}  // namespace sightcell::scene
