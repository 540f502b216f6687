#include "slack_path.h"

#include <algorithm>
#include <array>
#include <bit>

namespace sightcell::format {
namespace {

// More than the cost of any path; the sum of three does not overflow.
constexpr std::uint64_t unreachable = ~std::uint64_t{0} / 4;

// Prices of a polygon, four steps for each doubling, from 1/4 bit on: a saving of less does not justify drawing it.
constexpr int price_steps = 4 * 9;
constexpr std::uint64_t polygon_price(int step) {
  constexpr std::array<std::uint64_t, 4> quarters{64, 76, 91, 108};
  return quarters[static_cast<std::size_t>(step % 4)] << (step / 4);
}

// Three bits for each state after a column: the state before it, and whether the column is drawn.
constexpr unsigned drawn_step = 4;
constexpr unsigned step_bits = 3;

}  // namespace

bool slack_path::was_drawn(const slack_column& column, unsigned state) {
  return column.in_reference ? (state & removing) == 0 : (state & adding) != 0;
}

// Viterbi's algorithm. A polygon that is added to the set may cost a run in an heir that does not contain it, but it
// may also be added to the heir, so this counts half.
std::uint64_t slack_path::find(std::span<const slack_column> columns, bool alone, std::uint64_t polygon_price,
                               std::vector<bool>& drawn) {
  steps_.resize(columns.size());
  std::uint64_t all_heirs = 0;
  for (const slack_column& c : columns) all_heirs |= c.heirs;
  const auto count = [](std::uint64_t mask) { return static_cast<std::uint64_t>(std::popcount(mask)); };
  const std::uint64_t added_price = alone ? prices_.own : prices_.added;
  std::array<std::uint64_t, states> cost{0, unreachable, unreachable, unreachable};
  slack_column before;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const slack_column& c = columns[i];
    const std::uint64_t lacking = all_heirs & ~c.heirs;
    const std::uint64_t drawing = (c.seen ? 0 : c.size * polygon_price) + std::uint64_t{c.borders} * prices_.range;
    // [is drawn][was drawn]: the cost that does not depend on the rest of the state.
    const std::uint64_t common[2][2] = {
        {count(c.heirs & ~before.heirs) * prices_.added + (c.seen ? unreachable : 0),
         count(c.heirs) * prices_.added + (c.seen ? unreachable : 0)},
        {count(lacking) * prices_.removed / 2 + drawing + prices_.range,
         count(lacking & before.heirs) * prices_.removed / 2 + drawing + (c.begins_draw ? prices_.range : 0)}};
    const unsigned run = c.in_reference ? removing : adding;
    const std::uint64_t run_price = c.in_reference ? prices_.removed : added_price;
    std::array<std::uint64_t, states> next;
    unsigned steps = 0;
    for (unsigned to = 0; to < states; ++to) {
      const bool in_run = (to & run) != 0;
      const unsigned is = in_run == c.in_reference ? 0 : 1;
      const unsigned sources = to & ~run;  // the states from which it can be reached
      const unsigned ongoing = to | run;
      const std::uint64_t from_fresh =
          cost[sources] + common[is][was_drawn(before, sources)] + (in_run ? run_price : 0);
      const std::uint64_t from_ongoing = cost[ongoing] + common[is][was_drawn(before, ongoing)];
      next[to] = std::min({from_fresh, from_ongoing, unreachable});
      steps |= ((from_ongoing < from_fresh ? ongoing : sources) | is * drawn_step) << (step_bits * to);
    }
    steps_[i] = static_cast<std::uint16_t>(steps);
    cost = next;
    before = c;
  }
  auto state = static_cast<unsigned>(std::min_element(cost.begin(), cost.end()) - cost.begin());
  drawn.assign(columns.size(), false);
  std::uint64_t gained = 0;
  for (std::size_t i = columns.size(); i-- > 0;) {
    const unsigned step = static_cast<unsigned>(steps_[i]) >> (step_bits * state);
    drawn[i] = (step & drawn_step) != 0;
    if (drawn[i] && !columns[i].seen) gained += columns[i].size;
    state = step % states;
  }
  return gained;
}

// Of the paths of two adjacent prices, one is within the budget and the other is not, because many runs save the same
// per polygon. Follows the latter as far as the budget allows, and leaves it where both have reached the same state.
void slack_path::join(std::span<const slack_column> columns, std::uint64_t budget, std::vector<bool>& drawn) const {
  std::uint64_t gained = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) gained += drawn[i] && !columns[i].seen ? columns[i].size : 0;
  std::size_t taken = 0;
  unsigned apart = 0;  // states in which they differ
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const unsigned run = columns[i].in_reference ? removing : adding;
    if (drawn[i] == more_[i]) {
      apart &= ~run;
      if (apart == 0 && gained <= budget) taken = i + 1;
    } else {
      apart |= run;
      gained = more_[i] ? gained + columns[i].size : gained - columns[i].size;
    }
  }
  std::copy(more_.begin(), more_.begin() + static_cast<std::ptrdiff_t>(taken), drawn.begin());
}

void slack_path::choose(std::span<const slack_column> columns, bool alone, std::uint64_t budget,
                        std::vector<bool>& drawn) {
  drawn.assign(columns.size(), false);
  for (std::size_t i = 0; i < columns.size(); ++i) drawn[i] = columns[i].seen;
  int too_low = -1;
  int high_enough = price_steps;
  // Cells of a chunk have similar prices: bisects from the last one.
  int step = last_step_;
  for (int stride = 1; high_enough - too_low > 1; stride *= 2) {
    const bool over = find(columns, alone, polygon_price(step), trial_) > budget;
    (over ? too_low : high_enough) = step;
    (over ? more_ : drawn).swap(trial_);
    const int middle = too_low + (high_enough - too_low) / 2;
    step = over ? std::min(middle, step + stride) : std::max(middle, step - stride);
  }
  last_step_ = std::min(high_enough, price_steps - 1);
  if (too_low >= 0) join(columns, budget, drawn);
}

}  // namespace sightcell::format
