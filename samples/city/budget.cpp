// How many polygons a draft has, and what the ones that are left are spent on.
#include <algorithm>

#include "draft.h"

namespace sightcell::city {
namespace {

enum : std::uint64_t { stream_budget = 9 };

std::uint64_t prop_cost(const draft& d, const prop_place& place) {
  return d.prop_meshes[static_cast<std::size_t>(place.kind)].polygon_count();
}

// Something that can be added to a house.
struct house_option {
  building* house = nullptr;
  facade* wall = nullptr;
  std::size_t cell = 0;
};

class spender {
 public:
  spender(draft& d, std::uint64_t left, std::uint64_t seed) : draft_(d), left_(left), random_{seed, stream_budget} {
    for (block_draft& block : d.blocks) {
      for (building& house : block.houses) houses_.push_back({&house, nullptr, 0});
    }
    random_.shuffle(houses_);
    for (const house_option& option : houses_) {
      for (facade& wall : option.house->facades) {
        for (std::size_t cell = 0; cell < wall.cells.size(); ++cell) cells_.push_back({option.house, &wall, cell});
      }
    }
    scattered_cells_ = cells_;
    random_.shuffle(scattered_cells_);
  }

  std::uint64_t left() const { return left_; }

  bool pay(std::uint64_t cost) {
    if (cost > left_) return false;
    left_ -= cost;
    return true;
  }

  // Block by block in turn, so that no district is bare; at most `share` polygons.
  void add_props(std::uint64_t share) {
    const std::uint64_t stop = left_ - std::min(share, left_);
    for (bool any = true; any;) {
      any = false;
      for (block_draft& block : draft_.blocks) {
        if (block.props_used == block.props.size()) continue;
        const std::uint64_t cost = prop_cost(draft_, block.props[block.props_used]);
        if (left_ < stop + cost || !pay(cost)) continue;
        ++block.props_used;
        any = true;
      }
    }
  }

  void add_pickets(std::uint64_t share) {
    const std::uint64_t stop = left_ - std::min(share, left_);
    for (block_draft& block : draft_.blocks) {
      while (block.pickets_used < block.pickets.size() && left_ >= stop + 2 && pay(2)) ++block.pickets_used;
    }
  }

  void add_roof_things() {
    for (const house_option& option : houses_) {
      building& house = *option.house;
      if (!house.is_pitched() && random_.chance(0.5) && pay(building::box_cost)) house.has_penthouse = true;
      if (!house.has_penthouse && pay(building::box_cost)) house.has_chimney = true;
    }
  }

  void add_cornices() {
    for (const house_option& option : houses_) {
      building& house = *option.house;
      const std::uint32_t wanted = random_.below(house.floors());
      while (house.cornices < wanted && pay(building::box_cost)) ++house.cornices;
    }
  }

  void raise_windows(window_level level) {
    const auto before = static_cast<window_level>(static_cast<std::uint8_t>(level) - 1);
    // Where there are too few polygons single windows are walled up, but sills and bars a house has or has not.
    for (const house_option& option : level == window_level::recess ? scattered_cells_ : cells_) {
      window_level& current = option.wall->cells[option.cell];
      if (current == before && pay(building::window_cost(level))) current = level;
    }
  }

  // On upper floors of the street front, one window in six.
  void add_balconies() {
    for (const house_option& option : scattered_cells_) {
      const bool wanted = random_.chance(1.0 / 6.0) && option.wall->edge == 0 &&
                          option.cell >= option.house->columns(0) &&
                          option.wall->cells[option.cell] != window_level::none;
      if (wanted && pay(building::balcony_cost)) option.wall->balconies[option.cell] = true;
    }
  }

 private:
  draft& draft_;
  std::uint64_t left_;
  random_stream random_;
  std::vector<house_option> houses_;
  std::vector<house_option> cells_;            // house by house
  std::vector<house_option> scattered_cells_;  // in any order
};

}  // namespace

std::uint64_t base_polygons(const draft& d) {
  const std::uint64_t rows = d.layout.rows, columns = d.layout.columns;
  std::uint64_t total = 2 * (rows + 2) * (columns + 2);             // ground
  if (!d.plain) total += (12 + 20) * 2 * (rows + 2 + columns + 2);  // town wall and its towers
  for (const block_draft& block : d.blocks) {
    total += 12;  // pavement
    if (block.has_lawn) total += 12;
    for (const building& house : block.houses) total += house.base_cost();
    for (const prop_place& place : block.fixed_props) total += prop_cost(d, place);
  }
  return total;
}

std::uint64_t possible_polygons(const draft& d) {
  constexpr std::uint64_t window = 16 + 2 + 12 + 24;
  std::uint64_t total = base_polygons(d);
  for (const block_draft& block : d.blocks) {
    total += 2 * block.pickets.size();
    for (const prop_place& place : block.props) total += prop_cost(d, place);
    for (const building& house : block.houses) {
      total += building::box_cost;
      for (const facade& wall : house.facades) total += window * wall.cells.size();
    }
  }
  return total;
}

bool spend(draft& d, std::uint64_t polygons, std::uint64_t seed) {
  const std::uint64_t base = base_polygons(d);
  if (polygons < base) return false;
  spender s(d, polygons - base, seed);
  if (s.left() % 2 == 1) d.has_extra_polygon = s.pay(1);
  s.add_props(s.left() / 8);
  s.add_pickets(s.left() / 16);
  s.add_roof_things();
  s.raise_windows(window_level::recess);
  s.raise_windows(window_level::pane);
  s.add_cornices();
  s.raise_windows(window_level::sill);
  s.add_balconies();
  s.add_props(s.left());
  s.raise_windows(window_level::bars);
  s.add_pickets(s.left());
  return s.left() == 0;
}

}  // namespace sightcell::city
