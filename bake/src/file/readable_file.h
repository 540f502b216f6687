#pragma once
// The errors of a .pvs file that a command reads.
#include <string>

#include "sightcell/format/reader.h"
#include "sightcell/format/status.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Throws pvs.broken unless a reader of the file returned ok. name: of the file.
void require_readable(format::status outcome, const std::string& name);

// Throws pvs.other-scene unless the file was baked from the scene.
void require_scene(const format::reader& file, const scene::scene& s, const std::string& name);

[[noreturn]] void refuse_other_scene(const std::string& name, const scene::scene& s);

}  // namespace sightcell::bake
