#pragma once
// Which polygons one cell set should gain so that its row, and the rows that are differences to it, take fewer bits:
// the cheapest path through the polygons in stored order, from "drawn" to "not drawn" and back.
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::format {

// What things cost, in slack_price_unit-ths of a bit.
inline constexpr std::uint32_t slack_price_unit = 256;
struct slack_prices {
  std::uint32_t own = 0;      // a run of a row that stands alone
  std::uint32_t removed = 0;  // a run of a difference
  std::uint32_t added = 0;
  std::uint32_t range = 0;  // a (draw, first, count) range, which is no bits but a draw call
};

// A stretch of polygons that are alike for the cell and those that it is coded with.
struct slack_column {
  std::uint64_t heirs = 0;    // bit for each cell that is a difference to this one: it sees the polygons
  std::uint32_t size = 0;     // polygons
  std::uint32_t borders = 0;  // draws that begin inside the stretch, but not with it
  bool begins_draw = false;
  bool seen = false;          // by the cell: stays drawn
  bool in_reference = false;  // drawn by the cell that this one is a difference to
};

class slack_path {
 public:
  explicit slack_path(const slack_prices& prices) : prices_(prices) {}

  // Sets drawn[i] to whether columns[i] should be drawn: all that are seen, and others of at most budget polygons
  // together. columns: all polygons, those that nobody sees included. alone: the row is no difference. What was asked
  // before is remembered, to be faster. Allocates.
  void choose(std::span<const slack_column> columns, bool alone, std::uint64_t budget, std::vector<bool>& drawn);

 private:
  // The state behind a column: of those before it that are not in the reference, whether the last one is drawn (then a
  // run of what is added may go on); of those in the reference, whether the last one is not (a run of what is removed).
  static constexpr unsigned adding = 1;
  static constexpr unsigned removing = 2;
  static constexpr unsigned states = 4;

  // Whether the column that a state is behind is drawn.
  static bool was_drawn(const slack_column& column, unsigned state);

  // The cheapest path where an added polygon costs so much; answers how many it adds.
  std::uint64_t find(std::span<const slack_column> columns, bool alone, std::uint64_t polygon_price,
                     std::vector<bool>& drawn);
  // Replaces part of drawn by more_.
  void join(std::span<const slack_column> columns, std::uint64_t budget, std::vector<bool>& drawn) const;

  slack_prices prices_;
  std::vector<std::uint16_t> steps_;  // for each column how the cheapest path came to each state behind it
  std::vector<bool> more_;            // the path of the highest price known to be too low
  std::vector<bool> trial_;
  int last_step_ = 16;
};

}  // namespace sightcell::format
