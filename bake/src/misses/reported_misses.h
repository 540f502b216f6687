#pragma once
// Known misses as an input of a bake: which of them a cell has to do with, what they are named by in a checkpoint's
// key, and what of another bake stays when they change.
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

class reported_misses {
 public:
  reported_misses() = default;
  // In any order; those that are there twice count once.
  explicit reported_misses(std::vector<reported_miss> misses);

  const std::vector<reported_miss>& all() const { return all_; }  // by eye, then by polygon
  bool empty() const { return all_.empty(); }

  // Places in all(), ascending, of those whose eye a host may take for one of a cell with this box: the box grown by
  // margin holds it, as the runtime asks.
  std::vector<std::uint32_t> in(const glm::vec3& min, const glm::vec3& max, float margin) const;

  // Names the number of misses, and for each block with any in a cell's grown box which those are: "3; 0:12ab 7:34cd".
  std::string key_of(const cell_blocks& blocks, std::span<const view_cell> cells, float margin) const;

 private:
  std::vector<reported_miss> all_;
};

// The settings text with a member "misses", which is JSON; as it was where no miss is known.
std::string with_misses(const std::string& settings, const reported_misses& known, const std::string& value);

// Blocks of which two keys of checkpoints know other misses; nothing where the keys differ in anything else.
std::optional<std::vector<std::uint32_t>> blocks_with_other_misses(const std::string& key, const std::string& other);

// Is a record of another bake none of this one? Of the blocks themselves nothing stays; of the cells around them
// nothing that has read what they found.
std::function<bool(std::uint32_t cell, cell_stage)> stale_records(const std::vector<std::uint32_t>& changed,
                                                                  const cell_blocks& blocks);

}  // namespace sightcell::bake
