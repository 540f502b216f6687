#include "job/bake_key.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

#include "sightcell/base/json_text.h"

namespace sightcell::bake {
namespace {

// Raised whenever the same settings may result in other bytes. A bake rejects checkpoints of another version by name.
constexpr int bake_version = 19;

std::string text_of(const settings& how, const bake_cells& cells, const chosen_source& chosen) {
  auto text = scene::parse_ordered_json(describe(how));
  if (cells.list.of_scene) text["cells"] = "scene";  // instead of "automatic": describe() does not know the scene
  text["source"] = chosen.name;
  text["device"] = chosen.source->device();
  text["bake_version"] = bake_version;
  return text.dump();
}

std::uint64_t hash_of_cells(const bake_cells& cells, const overrides& given) {
  XXH3_state_t* state = XXH3_createState();
  XXH3_64bits_reset(state);
  for (const view_cell& cell : cells.list.cells) {
    const float corners[6] = {cell.min.x, cell.min.y, cell.min.z, cell.max.x, cell.max.y, cell.max.z};
    XXH3_64bits_update(state, corners, sizeof corners);
    XXH3_64bits_update(state, &cell.place, sizeof cell.place);
  }
  // The volumes are those of all cells, some of which --cell-limit may leave out.
  if (cells.volumes)
    XXH3_64bits_update(state, cells.volumes->places().data(), cells.volumes->places().size() * sizeof(volume_place));
  if (const std::uint64_t by_hand = hash_of(given); by_hand != 0) XXH3_64bits_update(state, &by_hand, sizeof by_hand);
  const std::uint64_t hash = XXH3_64bits_digest(state);
  XXH3_freeState(state);
  return hash;
}

}  // namespace

std::string settings_text_of(const settings& how, const bake_input& input, const bake_cells& cells,
                             const bake_device& device) {
  return with_misses(text_of(how, cells, device.chosen), input.misses, fmt::format("{}", input.misses.all().size()));
}

std::string key_of(const scene::scene& s, const settings& how, const bake_input& input, const bake_cells& cells,
                   const bake_device& device) {
  settings of_records = how;  // records of a bake with a time budget are valid for any other budget
  of_records.time_budget = how.time_budget > 0.0 ? 1.0 : 0.0;
  const std::string of_blocks = input.misses.key_of(cells.blocks, cells.list.cells, how.margin);
  const std::string settings_text =
      with_misses(text_of(of_records, cells, device.chosen), input.misses, fmt::format("\"{}\"", of_blocks));
  return fmt::format("scene {:02x} cells {} {:016x} settings {}", fmt::join(s.fingerprint, ""), cells.list.cells.size(),
                     hash_of_cells(cells, input.given), settings_text);
}

stale_key_test stale_test_of(const std::string& key, const cell_blocks& blocks) {
  return [key, &blocks](const std::string& stored) -> std::optional<stale_record> {
    const auto changed = blocks_with_other_misses(stored, key);
    if (!changed) return std::nullopt;
    return stale_records(*changed, blocks);
  };
}

}  // namespace sightcell::bake
