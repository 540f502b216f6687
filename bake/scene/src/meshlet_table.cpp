#include "meshlet_table.h"

#include <algorithm>
#include <numeric>

#include "json_object.h"
#include "meshlet_bytes.h"
#include "meshlet_levels.h"

namespace sightcell::scene {
namespace {

constexpr std::uint32_t header_bytes = 32, group_bytes = 16;

}  // namespace

std::uint64_t meshlet_table_bytes(std::span<const meshlet_group> groups) {
  std::uint64_t bytes = header_bytes + groups.size() * group_bytes;
  for (const meshlet_group& group : groups) bytes += group.triangle_counts.size() * meshlet_record_bytes;
  return bytes;
}

void write_meshlet_table(std::span<const meshlet_group> groups, const scene& packed, const meshlet_levels* levels,
                         std::span<std::byte> into) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, const draw*> draws;
  for (const draw& d : packed.draws) draws.try_emplace({d.mesh, d.primitive}, &d);
  byte_writer out(into);
  std::uint32_t meshlets = 0;
  for (const meshlet_group& group : groups) meshlets += static_cast<std::uint32_t>(group.triangle_counts.size());
  out.put(std::uint32_t{0x4C4D4353});  // "SCML"
  out.put(meshlet_table_version(levels != nullptr));
  out.put(static_cast<std::uint32_t>(groups.size()));
  out.put(meshlets);
  out.put(group_bytes);
  out.put(meshlet_record_bytes);
  const std::uint64_t before_levels = meshlet_table_bytes(groups);
  out.put(levels != nullptr ? static_cast<std::uint32_t>(before_levels) : 0u);
  out.put(std::uint32_t{0});
  std::uint32_t first = 0;
  for (const meshlet_group& group : groups) {
    const auto count = static_cast<std::uint32_t>(group.triangle_counts.size());
    out.put(group.mesh);
    out.put(group.primitive);
    out.put(first);
    out.put(count);
    first += count;
  }
  for (std::uint32_t number = 0; number < groups.size(); ++number) {
    const meshlet_group& group = groups[number];
    const draw& d = *draws.at({group.mesh, group.primitive});
    const geometry& g = packed.geometries[d.geometry];
    const std::uint64_t triangles =
        std::accumulate(group.triangle_counts.begin(), group.triangle_counts.end(), std::uint64_t{0});
    if (3 * triangles != g.indices.size())
      refuse(packed.name, "scene.bad-field", "has changed since it was loaded",
             "run the command again while no other program writes the file");
    const bool sided = d.material != no_index && packed.materials[d.material].double_sided;
    std::uint32_t index = 0;
    for (const std::uint32_t count : group.triangle_counts) {
      const auto corners = std::span<const std::uint32_t>(g.indices).subspan(index, std::size_t{3} * count);
      put_meshlet(out, {number, index}, g, corners, !group.deforms, !sided);
      index += 3 * count;
    }
  }
  if (levels != nullptr) levels->write(into.subspan(before_levels));
}

}  // namespace sightcell::scene
