#include "sightcell/bake/pack.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "file/readable_file.h"
#include "sightcell/base/error.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/writer.h"
#include "sightcell/scene/pack.h"

namespace sightcell::bake {
namespace {

void require_permutation(const std::vector<std::uint32_t>& source_of_stored, const std::string& name) {
  std::vector<bool> there(source_of_stored.size(), false);
  for (const std::uint32_t id : source_of_stored) {
    if (there[id]) require_readable(format::status::corrupt, name);
    there[id] = true;
  }
}

scene::packed_order order_of(const format::reader& file, const scene::scene& s, const std::string& name) {
  require_scene(file, s, name);
  if (file.draw_count() != s.draws.size()) refuse_other_scene(name, s);
  scene::packed_order order;
  order.source_of_stored.resize(s.polygon_count);
  require_readable(file.source_of_stored(order.source_of_stored), name);
  require_permutation(order.source_of_stored, name);
  for (std::uint32_t number = 0; number < file.draw_count(); ++number) {
    format::draw_record record;
    require_readable(file.draw(number, record), name);
    const std::uint32_t draw = scene::draw_of(s, record.first_source);
    const scene::draw& d = s.draws[draw];
    if (d.first_source != record.first_source || d.polygon_count != record.polygon_count ||
        d.base_vertex != record.base_vertex || d.material != record.material)
      refuse_other_scene(name, s);
    if (record.group == order.groups.size()) order.groups.push_back({{}, record.first_stored, 0, false});
    scene::packed_group& group = order.groups.back();
    group.draws.push_back(draw);
    group.polygon_count += record.polygon_count;
    group.moves = (record.flags & format::draw_moves) != 0;
  }
  return order;
}

}  // namespace

pack_result pack(const std::filesystem::path& scene_path, int scene_index, std::span<const std::byte> file,
                 const std::string& name, const std::filesystem::path& output) {
  format::reader opened;
  require_readable(format::reader::open(file, opened), name);
  if (opened.facts().layout != format::host_layout::merged)
    throw error(error_kind::wrong_use, "pack.instanced", name,
                "has the instanced layout, whose host uses the meshes of the scene",
                "for a host with one mesh: sightcell recode FILE --layout merged --scene SCENE");
  scene::gltf_packer packer(scene_path, scene_index);
  const scene::scene& s = packer.content();
  const scene::packed_order order = order_of(opened, s, name);

  pack_result result;
  std::vector<std::string> warnings;
  const std::vector<std::byte> bytes = packer.pack(order, warnings);
  result.warnings = s.warnings;
  for (std::string& warning : warnings)  // missing base colors were reported before
    if (std::find(s.warnings.begin(), s.warnings.end(), warning) == s.warnings.end())
      result.warnings.push_back(std::move(warning));
  const std::string path = output.string();
  format::remove_unfinished(path.c_str());
  if (format::write_file(path.c_str(), bytes) != format::status::ok)
    throw error(error_kind::failed, "pack.not-written", path, "cannot be written", "free space or choose another -o");
  result.polygons = s.polygon_count;
  if (!s.draws.empty()) {
    const scene::draw& last = s.draws.back();
    result.vertices = last.base_vertex + static_cast<std::uint32_t>(s.geometries[last.geometry].positions.size());
  }
  result.groups = static_cast<std::uint32_t>(order.groups.size());
  result.moving = static_cast<std::uint32_t>(
      std::count_if(order.groups.begin(), order.groups.end(), [](const auto& group) { return group.moves; }));
  result.bytes = bytes.size();
  return result;
}

}  // namespace sightcell::bake
