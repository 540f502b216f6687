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
constexpr std::size_t cells_read_at_once = 8;
constexpr std::size_t most_runs_kept = 4 << 20;  // 32 MiB

}  // namespace

rows_encoder::rows_encoder(const file_contents& contents, const stored_sets& stored,
                           std::vector<std::uint32_t> unit_borders)
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

// Reads the sets of consecutive cells.
status rows_encoder::read_sets(std::size_t first_cell, std::span<std::vector<run>> sets) const {
  std::vector<std::uint32_t> ids;
  std::vector<std::uint64_t> members;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    ids.clear();
    if (const status s = contents_.cell_sets.get(static_cast<std::uint32_t>(first_cell + i), ids); s != status::ok)
      return s;
    if (!ids.empty() && ids.back() >= items_ - columns_ + contents_.facts.polygon_count) return status::argument;
    if (std::adjacent_find(ids.begin(), ids.end(), std::greater_equal<>()) != ids.end()) return status::argument;
    stored_.runs_of(ids, members, sets[i]);
  }
  return status::ok;
}

// Reads the sets of a group: of the blocks `first`, `first + step` and so on.
status rows_encoder::read_group(std::size_t first, std::size_t step, std::span<block_work> group) const {
  struct piece {
    std::size_t first_cell;
    std::span<std::vector<run>> sets;
    status outcome;
  };
  const bool at_once = contents_.cell_sets.any_thread && contents_.run_at_once;
  std::vector<piece> pieces;
  for (std::size_t g = 0; g < group.size(); ++g) {
    if (group[g].is_widened) continue;
    const std::size_t begin = (first + g * step) * layout::cells_per_block;
    const std::size_t count = std::min<std::size_t>(contents_.cell_sets.count - begin, layout::cells_per_block);
    group[g].sets.resize(count);
    const std::size_t of_piece = at_once ? cells_read_at_once : count;
    for (std::size_t i = 0; i < count; i += of_piece)
      pieces.push_back({begin + i, std::span(group[g].sets).subspan(i, std::min(of_piece, count - i)), status::ok});
  }
  const auto read = [&](std::size_t p) { pieces[p].outcome = read_sets(pieces[p].first_cell, pieces[p].sets); };
  if (at_once) {
    contents_.run_at_once(pieces.size(), read);
  } else {
    for (std::size_t p = 0; p < pieces.size() && (p == 0 || pieces[p - 1].outcome == status::ok); ++p) read(p);
  }
  const auto failed =
      std::find_if(pieces.begin(), pieces.end(), [](const piece& p) { return p.outcome != status::ok; });
  return failed == pieces.end() ? status::ok : failed->outcome;
}

template <class Work, class Use>
status rows_encoder::for_each_block(std::size_t step, const Work& work, const Use& use) {
  const std::size_t at_once = contents_.run_at_once ? std::max<std::size_t>(contents_.groups_at_once, 1) : 1;
  for (std::size_t first = 0; first < block_count(); first += step * at_once) {
    std::vector<block_work> group(std::min(at_once, (block_count() - first + step - 1) / step));
    for (std::size_t g = 0; g < group.size(); ++g) {
      group[g].is_alone = group.size() == 1;
      const std::size_t block = first + g * step;
      if (block >= widened_.size() || widened_[block].sets.empty()) continue;
      group[g].sets = widened_[block].sets;
      group[g].sums = widened_[block].sums;
      group[g].is_widened = true;
    }
    if (const status s = read_group(first, step, group); s != status::ok) return s;
    const auto work_on = [&](std::size_t g) { work(first + g * step, group[g]); };
    if (group.size() == 1)
      work_on(0);
    else
      contents_.run_at_once(group.size(), work_on);
    for (std::size_t g = 0; g < group.size(); ++g) {
      if (const status s = use(first + g * step, group[g]); s != status::ok) return s;
    }
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

// Blocks are worked on at once, so the cells of one are where it is alone.
plan_settings rows_encoder::how_to_plan(const block_work& w, least_saving least) const {
  return {least, w.is_alone ? contents_.run_at_once : work_runner()};
}

// Slack makes differences cheaper than they are now, so those that save little yet are used too.
void rows_encoder::widen_sets(std::size_t block, block_work& w) {
  if (!exact_encoders_ || w.is_widened) return;
  std::vector<planned_chunk>& chunks = exact_blocks_[block];
  if (chunks.empty()) {
    const std::uint64_t most = std::uint64_t{contents_.chunk_bytes} * exact_bytes / widened_bytes;
    chunks = split_block(w.sets, *exact_encoders_, items_, most, how_to_plan(w, least_saving::anything));
  }
  take_volumes(w);
  std::vector<slack_sums> sums(chunks.size());
  const auto widen = [&](std::size_t c) {
    add_slack(chunks[c].part(w.sets), chunks[c].plan, borders_, prices_, slack_share_, sums[c]);
  };
  if (w.is_alone && contents_.run_at_once) {
    contents_.run_at_once(chunks.size(), widen);
  } else {
    for (std::size_t c = 0; c < chunks.size(); ++c) widen(c);
  }
  for (const slack_sums& of_chunk : sums) {
    w.sums.seen += of_chunk.seen;
    w.sums.added += of_chunk.added;
  }
  put_volumes_back(w);
  w.is_widened = true;
}

void rows_encoder::keep_widened(std::size_t block, block_work& w) {
  if (!w.is_widened) return;
  widened_.resize(block_count());
  widened_block& kept = widened_[block];
  if (!kept.sets.empty()) return;
  std::size_t runs = 0;
  for (const std::vector<run>& set : w.sets) runs += set.size();
  if (runs > most_runs_kept - widened_runs_) return;
  widened_runs_ += runs;
  kept = {std::move(w.sets), w.sums};
}

// The sets with slack have the chunks by which it was added, because it depends on the references, or parts of these.
std::vector<planned_chunk> rows_encoder::planned(std::size_t block, block_work& w, const row_encoders& encoders) const {
  const plan_settings how = how_to_plan(w, least_saving::an_eighth);
  if (!exact_encoders_) return split_block(w.sets, encoders, items_, contents_.chunk_bytes, how);
  std::vector<planned_chunk> chunks;
  for (const planned_chunk& exact : exact_blocks_[block]) {
    for (planned_chunk& c : split_block(exact.part(w.sets), encoders, items_, contents_.chunk_bytes, how)) {
      chunks.push_back({exact.first + c.first, c.cells, std::move(c.plan)});
    }
  }
  return chunks;
}

void rows_encoder::take_volumes(block_work& w) const {
  w.volumes.resize(w.sets.size());
  for (std::size_t i = 0; i < w.sets.size(); ++i) {
    std::vector<run>& set = w.sets[i];
    const auto has_volumes = [&](const run& r) { return r.first + r.count > columns_; };
    const auto from = std::find_if(set.begin(), set.end(), has_volumes);
    w.volumes[i].assign(from, set.end());
    set.erase(from, set.end());
    if (w.volumes[i].empty() || w.volumes[i].front().first >= columns_) continue;
    run& cut = w.volumes[i].front();
    set.push_back({cut.first, columns_ - cut.first});
    cut = {columns_, cut.count - set.back().count};
  }
}

void rows_encoder::put_volumes_back(block_work& w) {
  for (std::size_t i = 0; i < w.sets.size(); ++i) {
    std::vector<run>& set = w.sets[i];
    std::span<const run> volumes = w.volumes[i];
    if (!set.empty() && !volumes.empty() && set.back().first + set.back().count == volumes.front().first) {
      set.back().count += volumes.front().count;
      volumes = volumes.subspan(1);
    }
    set.insert(set.end(), volumes.begin(), volumes.end());
  }
}

// Counts every set as an own row.
status rows_encoder::count_own(row_counts& counts) {
  return for_each_block(
      1,
      [](std::size_t, block_work& w) {
        for (const std::vector<run>& set : w.sets) w.counts.own.add(set);
      },
      [&](std::size_t, const block_work& w) {
        counts.add(w.counts);
        return status::ok;
      });
}

// Differences are assumed to cost as much per run as own rows, until some of them are known.
status rows_encoder::sample(row_counts& counts) {
  row_counts guess = counts;
  guess.removed = guess.added = guess.own;
  const row_encoders encoders(guess);
  row_counts sampled;
  const status s = for_each_block(
      sample_step(sampled_blocks),
      [&](std::size_t block, block_work& w) {
        for (const planned_chunk& c : planned(block, w, encoders)) count_chunk(c.part(w.sets), c.plan, w.counts);
      },
      [&](std::size_t, const block_work& w) {
        sampled.add(w.counts);
        return status::ok;
      });
  counts.removed = sampled.removed;
  counts.added = sampled.added;
  return s;
}

// counts: of the sets without slack; becomes those of sampled sets with slack, of which all count as own rows too.
status rows_encoder::sample_slack(row_counts& counts) {
  exact_encoders_ = std::make_unique<row_encoders>(counts);
  prices_ = slack_prices_of(counts, *exact_encoders_);
  exact_blocks_.resize(block_count());
  row_counts sampled;
  const status s = for_each_block(
      sample_step(sampled_slack_blocks),
      [&](std::size_t block, block_work& w) {
        widen_sets(block, w);
        for (const planned_chunk& c : planned(block, w, *exact_encoders_)) {
          count_chunk(c.part(w.sets), c.plan, w.counts);
        }
        w.counts.own = {};
        for (const std::vector<run>& set : w.sets) w.counts.own.add(set);
      },
      [&](std::size_t block, block_work& w) {
        sampled.add(w.counts);
        keep_widened(block, w);
        return status::ok;
      });
  counts = sampled;
  return s;
}

status rows_encoder::choose(const row_encoders& encoders, row_counts& counts) {
  return for_each_block(
      1,
      [&](std::size_t block, block_work& w) {
        widen_sets(block, w);
        for (const std::vector<run>& set : w.sets) {
          w.run_bound = std::max(w.run_bound, static_cast<std::uint32_t>(set.size()));
          w.range_bound = std::max(w.range_bound, count_ranges(set));
        }
        w.chunks = planned(block, w, encoders);
        for (const planned_chunk& c : w.chunks) count_chunk(c.part(w.sets), c.plan, w.counts);
      },
      [&](std::size_t block, block_work& w) {
        sums_.seen += w.sums.seen;
        sums_.added += w.sums.added;
        run_bound_ = std::max(run_bound_, w.run_bound);
        range_bound_ = std::max(range_bound_, w.range_bound);
        blocks_.push_back(std::move(w.chunks));
        counts.add(w.counts);
        keep_widened(block, w);
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
  return for_each_block(
      1,
      [&](std::size_t block, block_work& w) {
        widen_sets(block, w);
        for (const planned_chunk& c : blocks_[block]) {
          const std::size_t begin = w.rows.size();
          encode_chunk(c.part(w.sets), c.plan, *encoders_, w.rows);
          w.chunk_sizes.push_back(w.rows.size() - begin);
          w.checksums.push_back(crc32c(std::span(w.rows).subspan(begin)));
        }
      },
      [&](std::size_t, const block_work& w) {
        std::size_t begin = file.size() - rows_begin;
        for (std::size_t c = 0; c < w.chunk_sizes.size(); ++c) {
          if (w.chunk_sizes[c] > layout::max_chunk_size) return status::limit;
          records.put_u64(begin);
          records.put_u32(static_cast<std::uint32_t>(w.chunk_sizes[c]));
          records.put_u32(w.checksums[c]);
          begin += w.chunk_sizes[c];
        }
        file.insert(file.end(), w.rows.begin(), w.rows.end());
        return status::ok;
      });
}

}  // namespace sightcell::format
