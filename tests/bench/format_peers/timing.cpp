#include "bench/format_peers/timing.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>
#include <iterator>
#include <numeric>
#include <random>
#include <stdexcept>

namespace sightcell::bench {
namespace {

using clock = std::chrono::steady_clock;

std::uint32_t ns_since(clock::time_point start) {
  const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(clock::now() - start).count();
  return static_cast<std::uint32_t>(std::min<std::int64_t>(ns, 0xFFFFFFFF));
}

double median(std::vector<std::uint32_t>& values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (double{1} * values[half - 1] + values[half]);
}

// The times of one kind of call, by cell.
class call_record {
 public:
  call_record(std::string name, std::size_t cells) : name_(std::move(name)), of_cell_(cells) {}
  void add(std::uint32_t cell, std::uint32_t ns) { of_cell_[cell].push_back(ns); }

  call_times sum_up(const corpus& of, bool ours) {
    call_times times;
    times.name = name_;
    double total = 0.0, cells = 0.0, runs = 0.0, polygons = 0.0;
    std::array<double, 3> ns_of_depth{}, runs_of_depth{};
    for (std::size_t cell = 0; cell < of_cell_.size(); ++cell) {
      if (of_cell_[cell].empty()) continue;
      const double ns = median(of_cell_[cell]);
      total += ns;
      cells += 1.0;
      const double cell_runs = ours ? of.ranges[cell] : static_cast<double>(of.runs[cell].size());
      runs += cell_runs;
      ns_of_depth.at(of.depth[cell]) += ns;
      runs_of_depth.at(of.depth[cell]) += cell_runs;
      for (const id_run& run : of.runs[cell]) polygons += run.count;
      times.worst_cell_ns = std::max(times.worst_cell_ns, ns);
    }
    times.ns_per_cell = total / std::max(cells, 1.0);
    times.ns_per_run = total / std::max(runs, 1.0);
    times.ns_per_polygon = total / std::max(polygons, 1.0);
    for (std::size_t depth = 0; depth < ns_of_depth.size(); ++depth)
      times.ns_per_run_of_depth[depth] = ns_of_depth[depth] / std::max(runs_of_depth[depth], 1.0);
    return times;
  }

 private:
  std::string name_;
  std::vector<std::vector<std::uint32_t>> of_cell_;
};

// A view and room for all that it says, touched before.
class ours {
 public:
  explicit ours(const corpus& of)
      : of_(of),
        view_(make_view(of)),
        ranges_(of.info.range_bound),
        ids_(of.most_polygons),
        stored_(3 * std::size_t{of.info.polygon_count}),
        list_(3 * of.most_polygons),
        copy_(list_.size()) {
    std::iota(stored_.begin(), stored_.end(), 0u);
  }

  // False where the view was in this cell already, so that nothing was decoded.
  bool move(std::uint32_t cell) {
    const std::uint32_t before = frame_.cell;
    sightcell_view_move(view_.get(), of_.middles[cell].data(), &frame_);
    return frame_.cell == cell && before != cell;
  }
  void ranges() { sightcell_view_ranges(view_.get(), ranges_.data(), ranges_.size(), &range_count_); }
  void polygons() {
    std::size_t count = 0;
    sightcell_view_polygons(view_.get(), ids_.data(), ids_.size(), &count);
  }
  void indices() { sightcell_view_indices(view_.get(), stored_.data(), list_.data(), list_.size(), &index_count_); }
  // As many bytes to a place of its own, from half the buffer past where the cell's polygons begin: neither is in a
  // nearer cache than what the index list was copied from and to.
  void plain_copy() {
    const std::size_t from = (3 * first_polygon_ + stored_.size() / 2) % std::max<std::size_t>(stored_.size(), 1);
    std::memcpy(copy_.data(), stored_.data() + std::min(from, stored_.size() - index_count_),
                index_count_ * sizeof(std::uint32_t));
  }
  void note_first(std::uint32_t polygon) { first_polygon_ = polygon; }

 private:
  const corpus& of_;
  view_handle view_;
  std::vector<sightcell_range> ranges_;
  std::vector<std::uint32_t> ids_, stored_, list_, copy_;
  sightcell_frame frame_{};
  std::size_t range_count_ = 0, index_count_ = 0, first_polygon_ = 0;
};

struct timed_call {
  const char* name;
  std::function<void(std::uint32_t cell)> call;
};

class peer_calls {
 public:
  peer_calls(const corpus& of, const peer_rows& peers)
      : peers_(peers), dictionary_(peers.dictionary), ids_(of.most_polygons), runs_(of.most_polygons) {
    std::size_t most = 1;
    for (const std::string& row : peers.roaring) most = std::max(most, row.size());
    for (const std::string& row : peers.varint) most = std::max(most, row.size());
    room_.assign(most, 1);
  }

  std::vector<timed_call> all() {
    return {{"roaring",
             [this](std::uint32_t cell) {
               unpack_roaring(peers_.roaring[cell].data(), peers_.roaring[cell].size(), ids_.data());
             }},
            {"roaring_zstd",
             [this](std::uint32_t cell) {
               const std::size_t size = plain_.unpack(peers_.roaring_zstd[cell], room_.data(), room_.size());
               unpack_roaring(room_.data(), size, ids_.data());
             }},
            {"varint",
             [this](std::uint32_t cell) {
               unpack_varints(peers_.varint[cell].data(), peers_.varint[cell].size(), runs_.data());
             }},
            {"varint_zstd_dictionary", [this](std::uint32_t cell) {
               const auto& row = peers_.varint_dictionary[cell];
               unpack_varints(room_.data(), dictionary_.unpack(row, room_.data(), room_.size()), runs_.data());
             }}};
  }

 private:
  const peer_rows& peers_;
  zstd_unpacker plain_, dictionary_;
  std::vector<std::uint32_t> ids_;
  std::vector<id_run> runs_;
  std::string room_;
};

// Calls that follow one another in every cell of every pass, the first of which moves the view there.
std::vector<call_times> measure_calls(const corpus& of, ours& own, const std::vector<timed_call>& calls,
                                      const std::vector<std::uint32_t>& order, unsigned repeat) {
  std::vector<call_record> records;
  for (const timed_call& one : calls) records.emplace_back(one.name, of.runs.size());
  for (unsigned pass = 0; pass < repeat; ++pass) {
    own.move(order.back());
    for (const std::uint32_t cell : order) {
      own.note_first(of.runs[cell].empty() ? 0 : of.runs[cell].front().first);
      for (std::size_t i = 0; i < calls.size(); ++i) {
        const auto start = clock::now();
        calls[i].call(cell);
        records[i].add(cell, ns_since(start));
      }
    }
  }
  std::vector<call_times> times;
  for (call_record& record : records) times.push_back(record.sum_up(of, true));
  return times;
}

std::vector<call_times> measure_peers(const corpus& of, const peer_rows& peers, const std::vector<std::uint32_t>& order,
                                      unsigned repeat) {
  peer_calls others(of, peers);
  std::vector<call_times> times;
  for (const timed_call& one : others.all()) {
    call_record record(one.name, of.runs.size());
    for (unsigned pass = 0; pass < repeat; ++pass) {
      for (const std::uint32_t cell : order) {
        const auto start = clock::now();
        one.call(cell);
        record.add(cell, ns_since(start));
      }
    }
    times.push_back(record.sum_up(of, false));
  }
  return times;
}

// The passes of one order of the cells: into the next cell to its ranges, and nothing else between; into the next cell
// to its index list, and a plain copy of as many bytes; then every call alone.
std::vector<call_times> measure_order(const corpus& of, const peer_rows& peers, const std::vector<std::uint32_t>& order,
                                      unsigned repeat) {
  ours own(of);
  const auto enter = [&](std::uint32_t cell) {
    if (!own.move(cell)) throw std::runtime_error("cell " + std::to_string(cell) + ": was not entered");
  };
  const timed_call to_ranges = {"to_ranges", [&](std::uint32_t cell) {
                                  enter(cell);
                                  own.ranges();
                                }};
  const timed_call to_indices = {"to_indices", [&](std::uint32_t cell) {
                                   enter(cell);
                                   own.indices();
                                 }};
  const timed_call copy = {"memcpy_of_indices", [&](std::uint32_t) { own.plain_copy(); }};
  const std::vector<timed_call> alone = {{"move", enter},
                                         {"ranges", [&](std::uint32_t) { own.ranges(); }},
                                         {"polygons", [&](std::uint32_t) { own.polygons(); }},
                                         {"indices", [&](std::uint32_t) { own.indices(); }}};
  std::vector<call_times> times;
  const auto add = [&](std::vector<call_times> more) { std::ranges::move(more, std::back_inserter(times)); };
  add(measure_calls(of, own, {to_ranges}, order, repeat));
  add(measure_calls(of, own, {to_indices, copy}, order, repeat));
  add(measure_calls(of, own, alone, order, repeat));
  add(measure_peers(of, peers, order, repeat));
  return times;
}

call_times measure_cold(const corpus& of, const std::vector<std::uint32_t>& shuffled, const timing_settings& how) {
  ours own(of);
  call_record moves("move", of.runs.size());
  std::vector<char> buffer(how.walk_bytes, 1);
  const std::size_t count = std::min(shuffled.size(), std::max<std::size_t>(how.cold_cells, 2));
  for (unsigned pass = 0; pass < how.repeat; ++pass) {
    own.move(shuffled[count - 1]);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t line = 0; line < buffer.size(); line += 64) {
        volatile char& touched = buffer[line];
        touched = static_cast<char>(touched + 1);
      }
      const auto start = clock::now();
      const bool moved = own.move(shuffled[i]);
      moves.add(shuffled[i], ns_since(start));
      if (!moved) throw std::runtime_error("cell " + std::to_string(shuffled[i]) + ": was not entered");
    }
  }
  return moves.sum_up(of, true);
}

double clock_cost() {
  std::vector<std::uint32_t> costs(10001);
  for (std::uint32_t& ns : costs) {
    const auto start = clock::now();
    ns = ns_since(start);
  }
  return median(costs);
}

}  // namespace

all_times measure(const corpus& of, const peer_rows& peers, const timing_settings& how) {
  if (of.runs.size() < 2) throw std::runtime_error("a file of one cell cannot be moved in");
  std::vector<std::uint32_t> order(of.runs.size());
  std::iota(order.begin(), order.end(), 0u);
  std::vector<std::uint32_t> shuffled = order;
  std::mt19937_64 random(how.seed);
  for (std::size_t i = shuffled.size() - 1; i > 0; --i) std::swap(shuffled[i], shuffled[random() % (i + 1)]);
  all_times times;
  times.clock_ns = clock_cost();
  times.shuffled = measure_order(of, peers, shuffled, how.repeat);
  times.file_order = measure_order(of, peers, order, how.repeat);
  times.cold.push_back(measure_cold(of, shuffled, how));
  return times;
}

}  // namespace sightcell::bench
