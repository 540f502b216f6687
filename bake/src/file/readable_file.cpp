#include "file/readable_file.h"

#include "sightcell/base/error.h"

namespace sightcell::bake {

void require_readable(format::status outcome, const std::string& name) {
  if (outcome != format::status::ok)
    throw error(error_kind::bad_input, "pvs.broken", name, format::status_text(outcome), "bake it again");
}

void require_scene(const format::reader& file, const scene::scene& s, const std::string& name) {
  if (file.facts().scene_fingerprint != s.fingerprint || file.polygon_count() != s.polygon_count)
    refuse_other_scene(name, s);
}

void refuse_other_scene(const std::string& name, const scene::scene& s) {
  throw error(error_kind::bad_input, "pvs.other-scene", name, "was baked from another scene than " + s.name,
              "give the scene of the bake, or bake again");
}

}  // namespace sightcell::bake
