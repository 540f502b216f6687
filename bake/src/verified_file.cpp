#include "verified_file.h"

#include "sightcell/bake/bake.h"
#include "sightcell/scene/error.h"

namespace sightcell::bake {
namespace {

void require_ok(format::status outcome, const std::string& name) {
  if (outcome != format::status::ok)
    throw error(error_kind::bad_input, "pvs.broken", name, format::status_text(outcome), "bake it again");
}

}  // namespace

verified_file::verified_file(const scene::scene& s, std::span<const std::byte> file, const std::string& name)
    : name_(name) {
  require_ok(format::reader::open(file, file_), name);
  if (file_.polygon_count() != s.polygon_count || file_.facts().scene_fingerprint != s.fingerprint)
    throw error(error_kind::bad_input, "pvs.other-scene", name, "was baked from another scene than " + s.name,
                "give the scene it was baked from, or bake again");
  require_ok(sets_.open(file_), name);
  rules_ = stored_rules_of(file_.settings());
}

void verified_file::build_rays(const scene::scene& s) {
  geometry_ = scene::flatten(s, rules_.animated);
  apply_stored_overrides(file_.settings(), geometry_);
  rays_.emplace(geometry_, rules_.all_double_sided);
}

void verified_file::cell_set(std::uint32_t cell, std::vector<std::uint32_t>& seen) {
  require_ok(file_.check_chunk(format::reader::chunk_of(cell)), name_);
  require_ok(sets_.source_ids(cell, seen), name_);
}

box verified_file::cell_box(std::uint32_t cell) const {
  format::box corners;
  require_ok(file_.cell_box(cell, corners), name_);
  return {{corners.min[0], corners.min[1], corners.min[2]}, {corners.max[0], corners.max[1], corners.max[2]}};
}

}  // namespace sightcell::bake
