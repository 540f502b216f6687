#include "bench/runtime_frames/switches.h"

#include <cstring>
#include <functional>
#include <numeric>

#include "bench/format_peers/corpus.h"
#include "bench/format_peers/peers.h"

namespace sightcell::bench {
namespace {

std::uint32_t size_of_set(const corpus& of, std::uint32_t cell) {
  std::uint32_t polygons = 0;
  for (const id_run& run : of.runs[cell]) polygons += run.count;
  return polygons;
}

std::uint32_t nearest_cell(const corpus& of, std::uint32_t size) {
  std::uint32_t best = 0;
  const auto away = [&](std::uint32_t cell) {
    const std::int64_t difference = std::int64_t{size_of_set(of, cell)} - size;
    return difference < 0 ? -difference : difference;
  };
  for (std::uint32_t cell = 1; cell < of.info.cell_count; ++cell) {
    if (away(cell) < away(best)) best = cell;
  }
  return best;
}

class switch_timer {
 public:
  switch_timer(const corpus& of, const frame_timing& how)
      : of_(of), how_(how), view_(make_view(of)), walked_(how.walk_bytes / sizeof(std::uint64_t), 1) {
    stored_.resize(std::size_t{3} * of.info.polygon_count);
    std::iota(stored_.begin(), stored_.end(), 0u);
    list_.resize(3 * of.most_polygons);
    copy_.resize(list_.size());
    ids_.resize(of.most_polygons);
    ranges_.resize(of.info.range_bound);
    commands_.resize(of.info.range_bound);
    words_.resize((of.info.draw_count + 63) / 64);
  }

  switch_row measure(std::uint32_t cell, bool cold) {
    switch_row row;
    row.cell = cell;
    row.cold = cold;
    // Away and back: only the way back is timed.
    const std::uint32_t other = cell == 0 ? 1 : 0;
    std::vector<double> moves;
    for (unsigned pass = 0; pass < how_.repeat; ++pass) {
      move(other);
      if (cold) walk();
      moves.push_back(time_of([&] { move(cell); }));
    }
    row.move_us = median_of(moves) / 1000.0;
    row.polygons = frame_.polygon_count;
    row.ranges = of_.ranges[cell];
    row.run_length = double{1} * row.polygons / std::max(row.ranges, 1u);
    row.ranges_us = median(cold, [&] { sightcell_view_ranges(view_.get(), ranges_.data(), ranges_.size(), &count_); });
    row.polygons_us = median(cold, [&] { sightcell_view_polygons(view_.get(), ids_.data(), ids_.size(), &count_); });
    row.commands_us = median(cold, [&] {
      sightcell_view_commands(view_.get(), 1, commands_.data(), sizeof(sightcell_command), commands_.size(), &count_);
    });
    row.objects_us = median(cold, [&] { sightcell_view_objects(view_.get(), words_.data(), words_.size()); });
    row.indices_us =
        median(cold, [&] { sightcell_view_indices(view_.get(), stored_.data(), list_.data(), list_.size(), &count_); });
    // From and to where nothing else is, so that both copies find their bytes as far away.
    const std::size_t from = std::min(stored_.size() / 2, stored_.size() - count_);
    row.memcpy_us =
        median(cold, [&] { std::memcpy(copy_.data(), stored_.data() + from, count_ * sizeof(std::uint32_t)); });
    const std::string roaring = pack_roaring(of_.runs[cell]);
    row.roaring_us = median(cold, [&] { unpack_roaring(roaring.data(), roaring.size(), ids_.data()); });
    return row;
  }

 private:
  void move(std::uint32_t cell) { sightcell_view_move(view_.get(), of_.middles[cell].data(), &frame_); }
  void walk() {
    for (std::uint64_t& word : walked_) word += 3;
  }
  double median(bool cold, const std::function<void()>& call) {
    std::vector<double> passes;
    for (unsigned pass = 0; pass < how_.repeat; ++pass) {
      if (cold) walk();
      passes.push_back(time_of(call));
    }
    return median_of(passes) / 1000.0;
  }

  const corpus& of_;
  const frame_timing& how_;
  view_handle view_;
  sightcell_frame frame_{};
  std::size_t count_ = 0;
  std::vector<std::uint64_t> walked_, words_;
  std::vector<std::uint32_t> stored_, list_, copy_, ids_;
  std::vector<sightcell_range> ranges_;
  std::vector<sightcell_command> commands_;
};

}  // namespace

std::vector<switch_row> measure_switches(const std::string& file, std::span<const std::uint32_t> sizes,
                                         const frame_timing& how) {
  const corpus of = read_corpus(file);
  if (of.info.cell_count < 2) throw std::runtime_error(file + ": has fewer than two cells");
  switch_timer timer(of, how);
  std::vector<switch_row> rows;
  for (const std::uint32_t size : sizes) {
    for (const bool cold : {false, true}) {
      rows.push_back(timer.measure(nearest_cell(of, size), cold));
      rows.back().file = file;
    }
  }
  return rows;
}

}  // namespace sightcell::bench
