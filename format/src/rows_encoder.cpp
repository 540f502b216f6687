#include "rows_encoder.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "byte_sink.h"
#include "checksum.h"
#include "code_table_writer.h"
#include "row_chunk_encoder.h"
#include "sightcell/format/draw_ranges.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

// Approximate number of blocks that are planned to estimate the cost of differences.
constexpr std::size_t sampled_blocks = 8;
// Slack takes longer than planning, and its result varies little over a file.
constexpr std::size_t sampled_slack_blocks = 3;
// Usual bytes of rows before and after slack is added.
constexpr std::uint64_t exact_bytes = 4;
constexpr std::uint64_t widened_bytes = 3;

}  // namespace

rows_encoder::rows_encoder(const file_contents& contents, stored_sets& stored, std::vector<std::uint32_t> unit_borders)
    : contents_(contents),
      stored_(stored),
      columns_(stored.columns()),
      items_(columns_ + static_cast<std::uint32_t>(contents.volumes.places.size())),
      borders_(std::move(unit_borders)),
      slack_share_(static_cast<std::uint64_t>(std::llround(contents.slack * double{slack_share_unit}))) {
  if (items_ > columns_) borders_.push_back(items_);
}

std::size_t rows_encoder::block_count() const {
  return (contents_.cell_sets.count + layout::cells_per_block - 1) / layout::cells_per_block;
}

// The distance between sampled blocks.
std::size_t rows_encoder::sample_step(std::size_t samples) const {
  return std::max<std::size_t>(1, block_count() / samples);
}

std::size_t rows_encoder::directory_size() const {
  std::size_t chunks = 0;
  for (const std::vector<planned_chunk>& block : blocks_) chunks += block.size();
  return chunks * layout::chunk_record_size;
}

status rows_encoder::read_set(std::uint32_t cell, std::vector<run>& runs) {
  ids_.clear();
  if (const status s = contents_.cell_sets.get(cell, ids_); s != status::ok) return s;
  if (!ids_.empty() && ids_.back() >= items_ - columns_ + contents_.facts.polygon_count) return status::argument;
  if (std::adjacent_find(ids_.begin(), ids_.end(), std::greater_equal<>()) != ids_.end()) return status::argument;
  stored_.runs_of(ids_, runs);
  return status::ok;
}

template <class Visit>
status rows_encoder::for_each_block(std::size_t step, const Visit& visit) {
  for (std::size_t block = 0; block < block_count(); block += step) {
    const std::size_t begin = block * layout::cells_per_block;
    sets_.resize(std::min<std::size_t>(contents_.cell_sets.count - begin, layout::cells_per_block));
    for (std::size_t i = 0; i < sets_.size(); ++i) {
      if (const status s = read_set(static_cast<std::uint32_t>(begin + i), sets_[i]); s != status::ok) return s;
    }
    if (const status s = visit(block); s != status::ok) return s;
  }
  return status::ok;
}

std::uint32_t rows_encoder::count_ranges(std::span<const run> runs) const {
  std::uint32_t ranges = 0;
  for_each_draw_range(
      runs, static_cast<std::uint32_t>(borders_.size() - 1), borders_.back(),
      [&](std::uint32_t unit) { return borders_[unit]; },
      [&](std::uint32_t, std::uint32_t, std::uint32_t) { ++ranges; });
  return ranges;
}

// Slack makes differences cheaper than they are now, so those that save little yet are used too.
void rows_encoder::widen_sets(std::size_t block, slack_sums& sums) {
  if (!exact_encoders_) return;
  std::vector<planned_chunk>& chunks = exact_blocks_[block];
  if (chunks.empty()) {
    const std::uint64_t most = std::uint64_t{contents_.chunk_bytes} * exact_bytes / widened_bytes;
    chunks = split_block(sets_, *exact_encoders_, items_, most, least_saving::anything);
  }
  take_volumes();
  for (const planned_chunk& c : chunks) add_slack(c.part(sets_), c.plan, borders_, prices_, slack_share_, sums);
  put_volumes_back();
}

// The sets with slack have the chunks by which it was added, because it depends on the references, or parts of these.
std::vector<planned_chunk> rows_encoder::planned(std::size_t block, const row_encoders& encoders) {
  if (!exact_encoders_) return split_block(sets_, encoders, items_, contents_.chunk_bytes);
  std::vector<planned_chunk> chunks;
  for (const planned_chunk& exact : exact_blocks_[block]) {
    for (planned_chunk& c : split_block(exact.part(sets_), encoders, items_, contents_.chunk_bytes)) {
      chunks.push_back({exact.first + c.first, c.cells, std::move(c.plan)});
    }
  }
  return chunks;
}

void rows_encoder::take_volumes() {
  volumes_.resize(sets_.size());
  for (std::size_t i = 0; i < sets_.size(); ++i) {
    std::vector<run>& set = sets_[i];
    const auto has_volumes = [&](const run& r) { return r.first + r.count > columns_; };
    const auto from = std::find_if(set.begin(), set.end(), has_volumes);
    volumes_[i].assign(from, set.end());
    set.erase(from, set.end());
    if (volumes_[i].empty() || volumes_[i].front().first >= columns_) continue;
    run& cut = volumes_[i].front();
    set.push_back({cut.first, columns_ - cut.first});
    cut = {columns_, cut.count - set.back().count};
  }
}

void rows_encoder::put_volumes_back() {
  for (std::size_t i = 0; i < sets_.size(); ++i) {
    std::vector<run>& set = sets_[i];
    std::span<const run> volumes = volumes_[i];
    if (!set.empty() && !volumes.empty() && set.back().first + set.back().count == volumes.front().first) {
      set.back().count += volumes.front().count;
      volumes = volumes.subspan(1);
    }
    set.insert(set.end(), volumes.begin(), volumes.end());
  }
}

// Counts every set as an own row.
status rows_encoder::count_own(row_counts& counts) {
  return for_each_block(1, [&](std::size_t) {
    for (const std::vector<run>& set : sets_) counts.own.add(set);
    return status::ok;
  });
}

// Differences are assumed to cost as much per run as own rows, until some of them are known.
status rows_encoder::sample(row_counts& counts) {
  row_counts guess = counts;
  guess.removed = guess.added = guess.own;
  const row_encoders encoders(guess);
  row_counts sampled;
  const status s = for_each_block(sample_step(sampled_blocks), [&](std::size_t block) {
    for (const planned_chunk& c : planned(block, encoders)) count_chunk(c.part(sets_), c.plan, sampled);
    return status::ok;
  });
  counts.removed = sampled.removed;
  counts.added = sampled.added;
  return s;
}

// counts: of the sets without slack; becomes those of sampled sets with slack.
status rows_encoder::sample_slack(row_counts& counts) {
  exact_encoders_ = std::make_unique<row_encoders>(counts);
  prices_ = slack_prices_of(counts, *exact_encoders_);
  exact_blocks_.resize(block_count());
  row_counts own;
  row_counts sampled;
  const status s = for_each_block(sample_step(sampled_slack_blocks), [&](std::size_t block) {
    slack_sums unused;
    widen_sets(block, unused);
    for (const std::vector<run>& set : sets_) own.own.add(set);
    for (const planned_chunk& c : planned(block, *exact_encoders_)) count_chunk(c.part(sets_), c.plan, sampled);
    return status::ok;
  });
  counts = sampled;
  counts.own = own.own;
  return s;
}

status rows_encoder::choose(const row_encoders& encoders, row_counts& counts) {
  return for_each_block(1, [&](std::size_t block) {
    widen_sets(block, sums_);
    for (const std::vector<run>& set : sets_) {
      run_bound_ = std::max(run_bound_, static_cast<std::uint32_t>(set.size()));
      range_bound_ = std::max(range_bound_, count_ranges(set));
    }
    blocks_.push_back(planned(block, encoders));
    for (const planned_chunk& c : blocks_.back()) count_chunk(c.part(sets_), c.plan, counts);
    return status::ok;
  });
}

status rows_encoder::plan() {
  row_counts expected;
  if (const status s = count_own(expected); s != status::ok) return s;
  if (const status s = sample(expected); s != status::ok) return s;
  if (slack_share_ > 0) {
    if (const status s = sample_slack(expected); s != status::ok) return s;
  }
  row_counts counts;
  if (const status s = choose(row_encoders(expected), counts); s != status::ok) return s;
  list_bound_ = counts.list_runs;
  encoders_ = std::make_unique<row_encoders>(counts);
  return status::ok;
}

std::vector<std::byte> rows_encoder::codes() const {
  std::vector<std::byte> bytes;
  for (const run_encoder* kind : {&encoders_->own, &encoders_->removed, &encoders_->added}) {
    put_code_lengths(kind->gap_lengths(), bytes);
    put_code_lengths(kind->more_lengths(), bytes);
  }
  return bytes;
}

status rows_encoder::write(std::vector<std::byte>& file, std::vector<std::byte>& directory) {
  const std::size_t rows_begin = file.size();
  byte_sink records(directory);
  return for_each_block(1, [&](std::size_t block) {
    slack_sums unused;
    widen_sets(block, unused);
    for (const planned_chunk& c : blocks_[block]) {
      const std::size_t begin = file.size();
      encode_chunk(c.part(sets_), c.plan, *encoders_, file);
      if (file.size() - begin > layout::max_chunk_size) return status::limit;
      records.put_u64(begin - rows_begin);
      records.put_u32(static_cast<std::uint32_t>(file.size() - begin));
      records.put_u32(crc32c(std::span(file).subspan(begin)));
    }
    return status::ok;
  });
}

}  // namespace sightcell::format
