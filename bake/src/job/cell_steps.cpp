#include "job/cell_steps.h"

#include <algorithm>

namespace sightcell::bake {

step_queue step_queue::phase_1(const stage_plan& plan, const stage_table& have, std::span<const std::uint32_t> blocks) {
  step_queue queue(plan);
  queue.sampling_left_.resize(plan.blocks().count());
  queue.second_round_.resize(plan.blocks().count());
  for (const std::uint32_t block : blocks) queue.add_block(block, have);
  queue.left_ = queue.count_;
  return queue;
}

void step_queue::add_block(std::uint32_t block, const stage_table& have) {
  const std::span<const std::uint32_t> cells = plan_->blocks().cells_of(block);
  std::vector<std::uint32_t>& waiting = second_round_[block];
  for (const std::uint32_t cell : cells) {
    if (plan_->through_phase_1(have, cell)) continue;
    if (plan_->shares_in_block(cell)) {
      waiting.push_back(cell);
    } else {
      ready_.push_back({cell, plan_->end_of_phase_1(cell)});
    }
    ++count_;
  }
  if (waiting.empty()) return;
  // The second round of a cell reads the first round of all its neighbors in the block. Cells that are through phase 1
  // may have lost the record of their first round, so they are sampled again.
  for (const std::uint32_t cell : cells)
    if (plan_->shares_in_block(cell) && !have.has(cell, cell_stage::sampled)) {
      ready_.push_back({cell, cell_stage::sampled});
      ++sampling_left_[block];
      ++count_;
    }
  if (sampling_left_[block] > 0) return;
  for (const std::uint32_t cell : waiting) ready_.push_back({cell, cell_stage::bounded});
  waiting.clear();
}

step_queue step_queue::phase_2(const stage_plan& plan, const stage_table& have, std::span<const std::uint32_t> blocks) {
  step_queue queue(plan);
  for (const std::uint32_t block : blocks)
    for (const std::uint32_t cell : plan.blocks().cells_of(block))
      if (!have.has(cell, cell_stage::finished)) queue.ready_.push_back({cell, cell_stage::finished});
  queue.count_ = static_cast<std::uint32_t>(queue.ready_.size());
  queue.left_ = queue.count_;
  return queue;
}

step_queue step_queue::both_phases(const stage_plan& plan, const stage_table& have,
                                   std::span<const std::uint32_t> blocks) {
  step_queue queue = phase_1(plan, have, blocks);
  queue.phase_1_left_.resize(plan.blocks().cell_count());
  queue.checks_.resize(plan.blocks().cell_count());
  for (const std::uint32_t block : blocks)
    for (const std::uint32_t cell : plan.blocks().cells_of(block)) queue.add_check(cell, have);
  queue.left_ = queue.count_;
  return queue;
}

void step_queue::add_check(std::uint32_t cell, const stage_table& have) {
  if (have.has(cell, cell_stage::finished) || plan_->end_of_phase_1(cell) == cell_stage::finished) return;
  const auto wait_for = [&](std::uint32_t other) {
    if (plan_->through_phase_1(have, other)) return;
    checks_[other].push_back(cell);
    ++phase_1_left_[cell];
  };
  wait_for(cell);
  for (const std::uint32_t neighbor : plan_->blocks().neighbors_of(cell)) wait_for(neighbor);
  if (phase_1_left_[cell] == 0) ready_first_.push_back({cell, cell_stage::finished});
  ++count_;
}

step_queue step_queue::listed(const stage_plan& plan, std::span<const cell_step> steps) {
  step_queue queue(plan);
  queue.ready_.assign(steps.begin(), steps.end());
  queue.count_ = static_cast<std::uint32_t>(steps.size());
  queue.left_ = queue.count_;
  return queue;
}

std::optional<cell_step> step_queue::begin_next() {
  std::deque<cell_step>& from = ready_first_.empty() ? ready_ : ready_first_;
  if (from.empty()) return std::nullopt;
  const cell_step step = from.front();
  from.pop_front();
  --left_;
  ++in_work_;
  return step;
}

void step_queue::committed(const cell_step& step) {
  --in_work_;
  if (step.to != cell_stage::sampled) {
    if (checks_.empty() || step.to != plan_->end_of_phase_1(step.cell)) return;
    for (const std::uint32_t cell : checks_[step.cell])
      if (--phase_1_left_[cell] == 0) ready_first_.push_back({cell, cell_stage::finished});
    return;
  }
  const std::uint32_t block = plan_->blocks().block_of(step.cell);
  if (--sampling_left_[block] > 0) return;
  for (const std::uint32_t cell : second_round_[block]) ready_first_.push_back({cell, cell_stage::bounded});
  second_round_[block].clear();
}

}  // namespace sightcell::bake
