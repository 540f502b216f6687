#include "bench/frames/baked_world.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace sightcell::bench {
namespace {

const scene::material default_material{};

template <class T>
T required(result<T> found, const std::filesystem::path& file) {
  if (!found) throw std::runtime_error(file.string() + ": " + found.text());
  return std::move(*found);
}

std::vector<surface_group> groups_of(const baked_world& world, const std::filesystem::path& file) {
  std::vector<sightcell_draw> draws(world.info.draw_count);
  if (!world.db.draws(draws)) throw std::runtime_error(file.string() + ": has no draw table");
  std::vector<surface_group> groups;
  for (const sightcell_draw& d : draws) {
    if (d.group >= groups.size()) groups.resize(d.group + 1);
    surface_group& group = groups[d.group];
    const auto& all = world.s.materials;
    group.material = d.material < all.size() ? &all[d.material] : &default_material;
    group.first = d.first_stored;
    group.count += d.polygon_count;
  }
  return groups;
}

}  // namespace

baked_world::baked_world(const std::filesystem::path& scene_file, const std::filesystem::path& pvs_file)
    : s(scene::load_gltf(scene_file)),
      geometry(scene::flatten(s)),
      db(required(sightcell::db::open_file(pvs_file.c_str()), pvs_file)),
      info(required(db.info(), pvs_file)),
      source_of_stored(info.polygon_count),
      groups(groups_of(*this, pvs_file)) {
  if (!std::equal(s.fingerprint.begin(), s.fingerprint.end(), info.scene_fingerprint))
    throw std::runtime_error(pvs_file.string() + ": was baked from another scene");
  if (info.layout != 1) throw std::runtime_error(pvs_file.string() + ": has not the layout merged");
  if (geometry.absent.tagged + geometry.absent.coarser_level > 0)
    throw std::runtime_error(scene_file.string() + ": has things that move, or levels of detail, which are not drawn");
  if (!db.order(source_of_stored)) throw std::runtime_error(pvs_file.string() + ": has no order");
  for (const std::uint32_t source : source_of_stored) {
    const auto corner = geometry.indices.begin() + 3 * std::ptrdiff_t{source};
    stored_corners.insert(stored_corners.end(), corner, corner + 3);
  }
  draw_order.resize(groups.size());
  std::iota(draw_order.begin(), draw_order.end(), 0u);
  const auto rank = [&](std::uint32_t g) {
    return groups[g].material == nullptr ? scene::alpha_mode::opaque : groups[g].material->alpha;
  };
  std::stable_sort(draw_order.begin(), draw_order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return rank(a) < rank(b); });
}

}  // namespace sightcell::bench
