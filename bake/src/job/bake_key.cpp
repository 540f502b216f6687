#include "job/bake_key.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "cell_set/cell_record.h"
#include "cells/path_file.h"
#include "input/two_scenes.h"
#include "sightcell/base/json_text.h"

namespace sightcell::bake {
namespace {

// Raised whenever the same settings may result in other bytes. A bake rejects checkpoints of another version by name.
constexpr int bake_version = 29;

std::string text_of(const settings& how, const bake_cells& cells, const chosen_source& chosen) {
  auto text = scene::parse_ordered_json(describe(how));
  if (cells.list.of_scene) text["cells"] = "scene";  // instead of "automatic": describe() does not know the scene
  text["source"] = chosen.name;
  text["device"] = chosen.source->device();
  text["bake_version"] = bake_version;
  return text.dump();
}

// Hashes numbers as they are in memory.
class number_hash {
 public:
  number_hash() : state_(XXH3_createState()) { XXH3_64bits_reset(state_); }
  ~number_hash() { XXH3_freeState(state_); }
  number_hash(const number_hash&) = delete;
  number_hash& operator=(const number_hash&) = delete;

  void add_bytes(std::span<const std::byte> bytes) { XXH3_64bits_update(state_, bytes.data(), bytes.size()); }
  template <typename Number>
  void add(const Number& number) {
    add_bytes(std::as_bytes(std::span(&number, 1)));
  }
  std::uint64_t digest() const { return XXH3_64bits_digest(state_); }

 private:
  XXH3_state_t* state_;
};

std::uint64_t hash_of_cells(const bake_cells& cells, const overrides& given) {
  number_hash hash;
  for (const view_cell& cell : cells.list.cells) {
    for (const glm::vec3* corner : {&cell.min, &cell.max})
      for (int axis = 0; axis < 3; ++axis) hash.add((*corner)[axis]);
    hash.add(cell.place);
  }
  // The volumes are those of all cells, some of which --cell-limit may leave out.
  if (cells.volumes) hash.add_bytes(std::as_bytes(std::span(cells.volumes->places())));
  if (const std::uint64_t by_hand = hash_of(given); by_hand != 0) hash.add(by_hand);
  return hash.digest();
}

void add_paths(const std::vector<camera_path>& paths, number_hash& hash) {
  hash.add(std::uint64_t{paths.size()});
  for (const camera_path& path : paths) {
    hash.add(std::uint64_t{path.size()});
    for (const auto& point : path) hash.add(point);
  }
}

// Everything that the fingerprints of scenes and the settings text leave out.
std::uint64_t hash_of_other_inputs(const scene::scene& s, const settings& how, const bake_input& input) {
  number_hash hash;
  hash.add(hash_of(input.given));
  for (const scene::scene* one : {&s, how.cells_from}) {
    if (one == nullptr) continue;
    hash.add(std::uint64_t{one->cells.size()});
    hash.add(std::uint64_t{one->starts.size()});
    for (const scene::start_point& start : one->starts) {
      hash.add(start.position);
      hash.add(std::uint8_t{start.is_camera});
    }
  }
  if (how.path_file) add_paths(read_paths(*how.path_file), hash);
  add_paths(how.paths, hash);
  return hash.digest();
}

}  // namespace

std::string inputs_of_cells(const scene::scene& s, const settings& how, const bake_input& input) {
  settings of_cells = how;
  of_cells.time_budget = 0.0;  // has no effect on cells
  return fmt::format("version {} scene {} others {:016x} settings {}", bake_version, fingerprint_text(s),
                     hash_of_other_inputs(s, how, input), describe(of_cells));
}

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
  return fmt::format("records {} scene {:02x} cells {} {:016x}{} settings {}", record_version,
                     fmt::join(s.fingerprint, ""), cells.list.cells.size(), hash_of_cells(cells, input.given),
                     how.keep_found ? " keep-found" : "", settings_text);
}

std::string steps_key_of(const bake_cells& cells, const std::string& settings_text) {
  number_hash volumes;
  if (cells.volumes) volumes.add_bytes(std::as_bytes(std::span(cells.volumes->places())));
  return fmt::format("records {} volumes {:016x} settings {}", record_version, volumes.digest(), settings_text);
}

stale_key_test stale_test_of(const std::string& key, const cell_blocks& blocks) {
  return [key, &blocks](const std::string& stored) -> std::optional<stale_record> {
    const auto changed = blocks_with_other_misses(stored, key);
    if (!changed) return std::nullopt;
    return stale_records(*changed, blocks);
  };
}

}  // namespace sightcell::bake
