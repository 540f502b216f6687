#pragma once
// Finds the polygons that one cell set should gain so that its row, and the rows that are differences to it, take fewer
// bits: the cheapest path through the polygons in stored order, alternating between "drawn" and "not drawn".
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::format {

// Costs, in slack_price_unit-ths of a bit.
inline constexpr std::uint32_t slack_price_unit = 256;
struct slack_prices {
  std::uint32_t own = 0;      // a run of an own row
  std::uint32_t removed = 0;  // a run of a difference
  std::uint32_t added = 0;
  std::uint32_t range = 0;  // a (draw, first, count) range, which costs no bits but a draw call
};

// Consecutive polygons that are equal for the cell and for the cells that it is coded with.
struct slack_column {
  std::uint64_t heirs = 0;    // a bit for each cell that is a difference to this one and contains the polygons
  std::uint32_t size = 0;     // polygons
  std::uint32_t borders = 0;  // draws that begin inside the column, but not at its begin
  bool begins_draw = false;
  bool seen = false;          // in the cell's set: stays drawn
  bool in_reference = false;  // drawn by the reference cell
};

class slack_path {
 public:
  explicit slack_path(const slack_prices& prices) : prices_(prices) {}

  // Sets drawn[i] to whether columns[i] should be drawn: all columns of the set, and others of up to budget polygons
  // together.
  // columns: all polygons, invisible ones included. alone: the row is not a difference. Remembers the last price, to be
  //   faster. Allocates.
  void choose(std::span<const slack_column> columns, bool alone, std::uint64_t budget, std::vector<bool>& drawn);

 private:
  // The state after a column. Of the columns before it that are not in the reference: whether the last one is drawn
  // (then a run of added polygons may continue). Of those in the reference: whether the last one is not drawn (a run of
  // removed polygons).
  static constexpr unsigned adding = 1;
  static constexpr unsigned removing = 2;
  static constexpr unsigned states = 4;

  // Whether the column before a state is drawn.
  static bool was_drawn(const slack_column& column, unsigned state);

  // Finds the cheapest path for a price per added polygon; returns the number of polygons that it adds.
  std::uint64_t find(std::span<const slack_column> columns, bool alone, std::uint64_t polygon_price,
                     std::vector<bool>& drawn);
  // Replaces a part of drawn by more_.
  void join(std::span<const slack_column> columns, std::uint64_t budget, std::vector<bool>& drawn) const;

  slack_prices prices_;
  std::vector<std::uint16_t> steps_;  // for each column, how the cheapest path reached each state after it
  std::vector<bool> more_;            // the path of the highest price known to be too low
  std::vector<bool> trial_;
  int last_step_ = 16;
};

}  // namespace sightcell::format
