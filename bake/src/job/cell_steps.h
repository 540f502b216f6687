#pragma once
// Which cell goes how far next: the order in which rounds of blocks depend on each other, and nothing of threads.
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "cell_set/cell_record.h"
#include "cells/cell_blocks.h"

namespace sightcell::bake {

// Which records there are, by cell and stage.
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

// A cell is to be brought from one record, or from nothing, to the next.
struct cell_step {
  std::uint32_t cell = 0;
  cell_stage to = cell_stage::finished;
  bool operator==(const cell_step&) const = default;
};

// Which stages there are for a cell: all of them where its block has other cells that it touches; without sampled where
// only cells of other blocks touch it; finished alone where nobody does, or where cells do not share.
class stage_plan {
 public:
  // blocks must outlive the plan.
  stage_plan(const cell_blocks& blocks, bool cells_share) : blocks_(blocks), cells_share_(cells_share) {}

  bool shares_in_block(std::uint32_t cell) const { return cells_share_ && !blocks_.neighbors_in_block(cell).empty(); }
  // The last stage of phase 1.
  cell_stage end_of_phase_1(std::uint32_t cell) const {
    return cells_share_ && !blocks_.neighbors_of(cell).empty() ? cell_stage::bounded : cell_stage::finished;
  }
  // Has the cell what phase 1 leaves behind?
  bool through_phase_1(const stage_table& have, std::uint32_t cell) const {
    return have.has(cell, end_of_phase_1(cell));
  }
  const cell_blocks& blocks() const { return blocks_; }

 private:
  const cell_blocks& blocks_;
  bool cells_share_;
};

// Steps of one phase. In phase 1 those of a block's second round can begin when its first is committed; they go before
// those of later blocks, so that few blocks are in work at a time. Calls come one at a time.
class step_queue {
 public:
  // Phase 1 of these blocks, in this order: what have lacks. plan must outlive the queue.
  static step_queue phase_1(const stage_plan& plan, const stage_table& have, std::span<const std::uint32_t> blocks);
  // Phase 2 of these blocks: phase 1 of all that touches them must be there.
  static step_queue phase_2(const stage_plan& plan, const stage_table& have, std::span<const std::uint32_t> blocks);

  // These steps, in this order: none waits for another.
  static step_queue listed(const stage_plan& plan, std::span<const cell_step> steps);

  // The next step that can begin. Nothing: all have begun, or those that are left wait for others to be committed.
  std::optional<cell_step> begin_next();
  // Its record is committed.
  void committed(const cell_step& step);
  std::size_t left() const { return left_; }        // not begun
  std::size_t in_work() const { return in_work_; }  // begun, not committed
  std::uint32_t count() const { return count_; }    // all of them

 private:
  explicit step_queue(const stage_plan& plan) : plan_(&plan) {}
  void add_block(std::uint32_t block, const stage_table& have);

  const stage_plan* plan_;
  std::deque<cell_step> ready_first_, ready_;
  std::vector<std::uint32_t> sampling_left_;              // by block: cells still to be sampled before the second round
  std::vector<std::vector<std::uint32_t>> second_round_;  // by block: who waits for that
  std::size_t left_ = 0, in_work_ = 0;
  std::uint32_t count_ = 0;
};

}  // namespace sightcell::bake
