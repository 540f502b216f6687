#include "verify/verified_file.h"

#include "input/two_scenes.h"
#include "sightcell/bake/stored_overrides.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

void require_ok(format::status outcome, const std::string& name) {
  if (outcome != format::status::ok)
    throw error(error_kind::bad_input, "pvs.broken", name, format::status_text(outcome), "bake it again");
}

// Occlusion depends on both scenes, so rays in one alone would report false misses.
void require_cells_from(const format::reader& file, const std::string& name, const scene::scene* given) {
  const std::optional<std::string> stored = stored_cells_from(file.settings());
  if (stored && given == nullptr)
    throw error(error_kind::wrong_use, "pvs.two-scenes", name, "has cells of another scene",
                "give both scenes: --polygons-from SCENE --cells-from SCENE");
  if (given == nullptr || stored == fingerprint_text(*given)) return;
  throw error(error_kind::bad_input, "pvs.other-scene", name,
              stored ? "was baked with cells of another scene than " + given->name : "has cells of its own scene",
              stored ? "give the scene of its cells as --cells-from" : "leave out --cells-from");
}

}  // namespace

verified_file::verified_file(const scene::scene& s, const scene::scene* cells_from, std::span<const std::byte> file,
                             const std::string& name)
    : scene_(s), cells_from_(cells_from), name_(name) {
  require_ok(format::reader::open(file, file_), name);
  if (file_.polygon_count() != s.polygon_count || file_.facts().scene_fingerprint != s.fingerprint)
    throw error(error_kind::bad_input, "pvs.other-scene", name, "was baked from another scene than " + s.name,
                "give the scene it was baked from, or bake again");
  require_cells_from(file_, name, cells_from);
  require_ok(sets_.open(file_), name);
  rules_ = stored_rules_of(file_.settings());
}

void verified_file::build_rays() {
  geometry_ = scene::flatten(scene_, rules_.animated, rules_.closed);
  apply_stored_overrides(file_.settings(), geometry_);
  if (cells_from_ != nullptr)
    append(geometry_, scene::flatten(*cells_from_, rules_.animated, rules_.closed), rules_.all_double_sided,
           cells_from_->name);
  rays_.emplace(geometry_, rules_.all_double_sided);
}

void verified_file::cell_set(std::uint32_t cell, std::vector<std::uint32_t>& seen) {
  require_ok(file_.check_chunk(file_.chunk_of(cell)), name_);
  require_ok(sets_.source_ids(cell, seen), name_);
}

void verified_file::cell_items(std::uint32_t cell, std::vector<std::uint32_t>& items) {
  require_ok(file_.check_chunk(file_.chunk_of(cell)), name_);
  require_ok(sets_.item_ids(cell, items), name_);
}

stored_volumes verified_file::volumes() const {
  std::vector<format::lattice_place> places(file_.volumes().count());
  for (std::uint32_t volume = 0; volume < places.size(); ++volume)
    if (!file_.volumes().place(volume, places[volume])) require_ok(format::status::corrupt, name_);
  return {file_.volumes().shape(), places};
}

viewpoint_region verified_file::region(std::uint32_t cell) const {
  const box grown = cell_box(cell).grown(file_.facts().margin);
  const std::span<const std::byte> bytes = file_.viewpoints().region_bytes(cell);
  auto region = viewpoint_region::decode(grown, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  if (!region) require_ok(format::status::corrupt, name_);
  return std::move(*region);
}

box verified_file::cell_box(std::uint32_t cell) const {
  format::box corners;
  require_ok(file_.cell_box(cell, corners), name_);
  return {{corners.min[0], corners.min[1], corners.min[2]}, {corners.max[0], corners.max[1], corners.max[2]}};
}

}  // namespace sightcell::bake
