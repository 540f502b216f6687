#pragma once
// Reported misses as an input of a bake: which misses affect a cell, their part of a checkpoint's key, and which
// records of another bake stay valid when they change.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cell_set/cell_record.h"
#include "cells/cell_blocks.h"
#include "cells/view_cell.h"
#include "misses/misses_file.h"

namespace sightcell::bake {

// The reported misses of a bake.
class reported_misses {
 public:
  reported_misses() = default;
  // misses: in any order; duplicates are dropped.
  explicit reported_misses(std::vector<reported_miss> misses);

  const std::vector<reported_miss>& all() const { return all_; }  // sorted by eye, then by polygon
  bool empty() const { return all_.empty(); }

  // Returns the indices into all(), ascending, of the misses whose eye the runtime may assign to a cell with this
  // box, which is the case if the box grown by margin contains it.
  std::vector<std::uint32_t> in(const glm::vec3& min, const glm::vec3& max, float margin) const;

  // Returns the part of the key: the number of misses, and a hash of those in the grown boxes of each block's cells,
  // such as "3; 0:12ab 7:34cd".
  std::string key_of(const cell_blocks& blocks, std::span<const view_cell> cells, float margin) const;

 private:
  std::vector<reported_miss> all_;
};

// Returns the settings text with `value`, which is JSON, as the member "misses"; unchanged if there are no misses.
std::string with_misses(const std::string& settings, const reported_misses& known, const std::string& value);

// Returns the blocks whose misses differ between two keys of checkpoints; nothing if the keys differ in anything
// else.
std::optional<std::vector<std::uint32_t>> blocks_with_other_misses(const std::string& key, const std::string& other);

// Returns a function that returns whether a record of another bake is invalid for this one. All records of the
// changed blocks are, and of the cells around them those of the stages that read the changed blocks.
std::function<bool(std::uint32_t cell, cell_stage)> stale_records(const std::vector<std::uint32_t>& changed,
                                                                  const cell_blocks& blocks);

}  // namespace sightcell::bake
