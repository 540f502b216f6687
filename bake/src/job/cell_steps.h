#pragma once
// The steps of a bake and the order in which they can begin. Knows the dependencies between the rounds of a block, and
// nothing about threads.
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "cell_set/cell_record.h"
#include "cells/cell_blocks.h"

namespace sightcell::bake {

// A table of the records that exist, by cell and stage.
class stage_table {
 public:
  explicit stage_table(std::size_t cells) : bits_(cells) {}
  bool has(std::uint32_t cell, cell_stage stage) const { return (bits_[cell] >> static_cast<int>(stage) & 1) != 0; }
  void add(std::uint32_t cell, cell_stage stage) {
    bits_[cell] |= static_cast<std::uint8_t>(1 << static_cast<int>(stage));
  }
  void remove(std::uint32_t cell, cell_stage stage) {
    bits_[cell] &= static_cast<std::uint8_t>(~(1 << static_cast<int>(stage)));
  }

 private:
  std::vector<std::uint8_t> bits_;
};

// One unit of work: makes the record of a stage of a cell.
struct cell_step {
  std::uint32_t cell = 0;
  cell_stage to = cell_stage::finished;
  bool operator==(const cell_step&) const = default;
};

// The stages that a cell goes through:
// - sampled, bounded, finished: if it touches other cells of its block
// - bounded, finished: if it touches cells of other blocks only
// - finished: if it touches no cell, or if cells do not share
class stage_plan {
 public:
  // blocks must outlive the plan. cells_share: cells check what their neighbors found.
  stage_plan(const cell_blocks& blocks, bool cells_share) : blocks_(blocks), cells_share_(cells_share) {}

  bool shares_in_block(std::uint32_t cell) const { return cells_share_ && !blocks_.neighbors_in_block(cell).empty(); }
  // Returns the last stage of phase 1 of the cell.
  cell_stage end_of_phase_1(std::uint32_t cell) const {
    return cells_share_ && !blocks_.neighbors_of(cell).empty() ? cell_stage::bounded : cell_stage::finished;
  }
  // Returns true if phase 1 of the cell is done.
  bool through_phase_1(const stage_table& have, std::uint32_t cell) const {
    return have.has(cell, end_of_phase_1(cell));
  }
  const cell_blocks& blocks() const { return blocks_; }

 private:
  const cell_blocks& blocks_;
  bool cells_share_;
};

// The steps of one phase or of both. In phase 1, the second round of a block can begin when its first round is
// committed. It goes before the first round of later blocks, so that few blocks are in work at a time; and so does a
// step of phase 2, whose cell and neighbors are through phase 1.
// Threads: one call at a time.
class step_queue {
 public:
  // Returns the steps of phase 1 of the blocks, in this order, for the records that `have` lacks. plan must outlive the
  // queue.
  static step_queue phase_1(const stage_plan& plan, const stage_table& have, std::span<const std::uint32_t> blocks);
  // Returns the steps of phase 2 of the blocks. Phase 1 of these and of all adjacent blocks must be done.
  static step_queue phase_2(const stage_plan& plan, const stage_table& have, std::span<const std::uint32_t> blocks);
  // Returns the steps of both phases. blocks: all of the plan.
  static step_queue both_phases(const stage_plan& plan, const stage_table& have, std::span<const std::uint32_t> blocks);

  // Returns a queue of these steps, in this order. None depends on another.
  static step_queue listed(const stage_plan& plan, std::span<const cell_step> steps);

  // Returns the next step that can begin. Nothing if all have begun, or if the others depend on steps that are not
  // committed yet.
  std::optional<cell_step> begin_next();
  // To be called when the record of the step is committed.
  void committed(const cell_step& step);
  std::size_t left() const { return left_; }        // not begun
  std::size_t in_work() const { return in_work_; }  // begun, not committed
  std::uint32_t count() const { return count_; }    // of all steps, whatever their state

 private:
  explicit step_queue(const stage_plan& plan) : plan_(&plan) {}
  void add_block(std::uint32_t block, const stage_table& have);
  void add_check(std::uint32_t cell, const stage_table& have);

  const stage_plan* plan_;
  std::deque<cell_step> ready_first_, ready_;
  std::vector<std::uint32_t> sampling_left_;              // by block: cells still to be sampled before the second round
  std::vector<std::vector<std::uint32_t>> second_round_;  // by block: cells of which the second round waits
  std::vector<std::uint32_t> phase_1_left_;               // by cell: cells that are to pass phase 1 before its check
  std::vector<std::vector<std::uint32_t>> checks_;        // by cell: cells of which the check waits for its phase 1
  std::size_t left_ = 0, in_work_ = 0;
  std::uint32_t count_ = 0;
};

}  // namespace sightcell::bake
