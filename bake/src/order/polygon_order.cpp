#include "order/polygon_order.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "order/draw_tour.h"
#include "order/signatures.h"
#include "order/tour.h"
#include "sightcell/base/in_blocks.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t most_sketch_bits = 65536;  // limit of the ranks in sorts by permuted bits

class orderer {
 public:
  orderer(const order_input& in, const order_settings& how)
      : in_(in),
        tour_{.sorts = how.sorts, .neighbors = std::max(1u, how.neighbors)},
        sketch_bits_(std::clamp(how.sketch_bits, 1u, most_sketch_bits)),
        units_(read_signatures(in, sketch_bits_)),
        paths_(units_.size()) {
    for (std::uint32_t d = 0; d < in.draws.size(); ++d)
      if (in.draws[d].count != 0) draws_.push_back(d);
    draws_of_unit_.resize(in.unit_count);
    for (const ordered_draw& draw : in.draws) ++draws_of_unit_[draw.unit];
  }

  polygon_order run(std::uint32_t rounds);

 private:
  bool shared(std::uint32_t draw) const { return draws_of_unit_[in_.draws[draw].unit] > 1; }
  // Calls work(unit) for each unit that has atoms to order.
  template <class Work>
  void for_each_unit(const Work& work) const;
  std::uint32_t polygon_at(std::uint32_t end) const;
  bit_matrix ends() const;
  std::vector<surroundings> surroundings_of(const draw_tour& tour) const;
  polygon_order result(const draw_tour& tour) const;

  const order_input& in_;
  tour_settings tour_;
  std::uint32_t sketch_bits_;
  std::vector<unit_signatures> units_;
  std::vector<std::vector<std::uint32_t>> paths_;  // of each unit: its atoms in order
  std::vector<std::uint32_t> draws_;  // draws with polygons; the draw tour numbers them by their index here
  std::vector<std::uint32_t> draws_of_unit_;
};

// Large units are processed one at a time, each with all threads, and the others in parallel, so that memory is
// bounded.
template <class Work>
void orderer::for_each_unit(const Work& work) const {
  std::vector<std::uint32_t> small;
  for (std::uint32_t u = 0; u < units_.size(); ++u)
    if (units_[u].rows.rows() > long_loop)
      work(u);
    else
      small.push_back(u);
  tbb::parallel_for(std::size_t{0}, small.size(), [&](std::size_t i) { work(small[i]); });
}

// Returns the polygon at an end of the draw tour, numbered as in the draws of the input.
std::uint32_t orderer::polygon_at(std::uint32_t end) const {
  const ordered_draw& draw = in_.draws[draws_[draw_of(end)]];
  const unit_signatures& unit = units_[draw.unit];
  const std::vector<std::uint32_t>& path = paths_[draw.unit];
  const std::uint32_t member =
      end == head_of(draw_of(end)) ? unit.begins[path.front()] : unit.begins[path.back() + 1] - 1;
  return draw.first + unit.members[member];
}

bit_matrix orderer::ends() const {
  std::vector<std::uint32_t> polygons;
  for (std::uint32_t end = 0; end < 2 * draws_.size(); ++end) polygons.push_back(polygon_at(end));
  polygons.push_back(no_row);
  return cells_that_see(in_, polygons, sketch_bits_);
}

std::vector<surroundings> orderer::surroundings_of(const draw_tour& tour) const {
  std::vector<surroundings> found(in_.draws.size());
  const std::vector<std::uint32_t>& entries = tour.entries();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    surroundings& at = found[draws_[draw_of(entries[i])]];
    if (i > 0) at.before = polygon_at(other_end(entries[i - 1]));
    if (i + 1 < entries.size()) at.after = polygon_at(entries[i + 1]);
    if (entries[i] == tail_of(draw_of(entries[i]))) std::swap(at.before, at.after);
  }
  return found;
}

polygon_order orderer::run(std::uint32_t rounds) {
  for_each_unit([&](std::uint32_t u) { paths_[u] = shortest_path(units_[u].rows, tour_); });
  std::vector<std::uint8_t> flippable;
  // A draw of one polygon is the same when flipped.
  for (const std::uint32_t d : draws_) flippable.push_back(!shared(d) || in_.draws[d].count == 1 ? 1 : 0);
  draw_tour tour(ends(), flippable, tour_.sorts);
  for (std::uint32_t round = 0; round < rounds; ++round) {
    set_surroundings(in_, surroundings_of(tour), units_);
    for_each_unit([&](std::uint32_t u) { paths_[u] = improved_path(units_[u].rows, paths_[u], tour_); });
    tour.improve(ends());
  }
  return result(tour);
}

polygon_order orderer::result(const draw_tour& tour) const {
  polygon_order order;
  for (std::size_t u = 0; u < units_.size(); ++u) order.units.push_back(units_[u].polygons_of(paths_[u]));
  for (const std::uint32_t entry : tour.entries()) {
    const std::uint32_t draw = draws_[draw_of(entry)];
    order.draws.push_back(draw);
    if (entry == tail_of(draw_of(entry)) && !shared(draw)) std::ranges::reverse(order.units[in_.draws[draw].unit]);
  }
  for (std::uint32_t d = 0; d < in_.draws.size(); ++d)
    if (in_.draws[d].count == 0) order.draws.push_back(d);
  return order;
}

}  // namespace

polygon_order order_polygons(const order_input& in, const order_settings& how) {
  return orderer(in, how).run(how.rounds);
}

}  // namespace sightcell::bake
