#pragma once
// The texts that name a bake: the settings text of its file, and the key of its checkpoint.
#include <string>

#include "checkpoint/checkpoint.h"
#include "job/bake_cells.h"
#include "job/bake_device.h"
#include "job/bake_input.h"
#include "sightcell/bake/settings.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Returns the settings as JSON with source, device, bake version and the number of reported misses. The text in a file
// also has the overrides.
std::string settings_text_of(const settings& how, const bake_input& input, const bake_cells& cells,
                             const bake_device& device);

// Returns the key of the checkpoint. It names everything that decides a byte of the file: the scene with the textures
// that decide alpha, cells, overrides, volumes, settings, device and version.
std::string key_of(const scene::scene& s, const settings& how, const bake_input& input, const bake_cells& cells,
                   const bake_device& device);

// Returns the text that names all that automatic cells are made from, apart from the device: scene, starts, overrides,
// paths, settings and version. A bake with the same text and the same device has the same cells, before and after they
// are merged.
std::string inputs_of_cells(const scene::scene& s, const settings& how, const bake_input& input);

// Returns the text that names what steps of cells depend on besides the scene and the cells: settings, device, version
// and volumes. Kept records of another text cannot be taken.
std::string steps_key_of(const bake_cells& cells, const std::string& settings_text);

// Returns the test that decides which stored records are stale in a bake with this key: if two keys differ only in
// their reported misses, the records of the blocks with other misses. blocks must outlive the test.
stale_key_test stale_test_of(const std::string& key, const cell_blocks& blocks);

}  // namespace sightcell::bake
