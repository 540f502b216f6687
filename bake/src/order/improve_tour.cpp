#include "order/improve_tour.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "order/tour_links.h"

namespace sightcell::bake {
namespace {

constexpr int rounds = 3;                     // rounds of 2-opt and Or-opt after the first Or-opt
constexpr std::uint32_t longest_segment = 3;  // rows that Or-opt moves together
// Rows that 2-opt reverses: the cost grows with the length, the gain does not.
constexpr std::uint32_t longest_reversal = 50000;
constexpr std::uint32_t fewest_moves = 200;  // a round with at most one move per this number of rows is the last

// Queue of rows whose neighbors changed after they were processed; all rows at first.
class changed_rows {
 public:
  explicit changed_rows(std::uint32_t rows) : now_(rows), waits_(rows, 1) { std::iota(now_.begin(), now_.end(), 0u); }

  // Takes the next row in order of arrival. Returns false if the queue is empty.
  bool take(std::uint32_t& row) {
    if (at_ == now_.size()) {
      now_.swap(later_);
      later_.clear();
      at_ = 0;
    }
    if (now_.empty()) return false;
    row = now_[at_++];
    waits_[row] = 0;
    return true;
  }
  void add(std::uint32_t row) {
    if (waits_[row] != 0) return;
    waits_[row] = 1;
    later_.push_back(row);
  }

 private:
  std::vector<std::uint32_t> now_, later_;
  std::vector<std::uint8_t> waits_;
  std::size_t at_ = 0;
};

// Or-opt: moves segments of up to three rows to between two other rows, reversed if that is better.
class or_opt {
 public:
  or_opt(const bit_matrix& matrix, const neighbor_lists& near, tour_edge fixed, std::span<const std::uint32_t> tour)
      : matrix_(matrix), near_(near), fixed_(fixed), links_(tour), changed_(matrix.rows()) {}

  // Returns the number of moves.
  std::uint32_t run() {
    std::uint32_t moves = 0;
    for (std::uint32_t row = 0; changed_.take(row);)
      while (moves_from(row)) ++moves;
    return moves;
  }
  const tour_links& links() const { return links_; }

 private:
  // Consecutive rows of the tour: before - rows[0] .. rows[length - 1] - after.
  struct segment {
    std::array<std::uint32_t, longest_segment> rows{};
    std::uint32_t length = 0, before = 0, after = 0;
    std::int32_t freed = 0;  // length that the tour loses without it
    std::uint32_t head() const { return rows[0]; }
    std::uint32_t tail() const { return rows[length - 1]; }
    bool has(std::uint32_t row) const {
      return std::find(rows.begin(), rows.begin() + length, row) != rows.begin() + length;
    }
  };

  bool moves_from(std::uint32_t row) { return moves_from(row, 0) || moves_from(row, 1); }
  bool moves_from(std::uint32_t row, std::size_t side);
  bool moves(const segment& part);
  void move(const segment& part, std::uint32_t beside_head, std::uint32_t beside_tail);

  const bit_matrix& matrix_;
  const neighbor_lists& near_;
  tour_edge fixed_;
  tour_links links_;
  changed_rows changed_;
};

// Tries the segments with row as head that extend away from its neighbor on one side.
bool or_opt::moves_from(std::uint32_t row, std::size_t side) {
  segment part;
  part.before = links_.of(row)[side];
  if (fixed_.joins(part.before, row)) return false;
  const std::int32_t cut = matrix_.distance(part.before, row);
  std::uint32_t last = part.before, next = row;
  while (part.length < longest_segment) {
    part.rows[part.length++] = next;
    part.after = links_.beyond(next, last);
    if (part.after == part.before || fixed_.joins(next, part.after)) return false;
    part.freed = cut + matrix_.distance(next, part.after) - matrix_.distance(part.before, part.after);
    if (part.freed > 0 && moves(part)) return true;
    last = next;
    next = part.after;
  }
  return false;
}

// Tries positions at which the head is adjacent to a row in its neighbor list.
bool or_opt::moves(const segment& part) {
  for (const near_row& beside_head : near_.of(part.head())) {
    const std::int32_t left = part.freed - beside_head.distance;
    if (left <= 0) return false;
    const std::uint32_t at = beside_head.row;
    if (part.has(at)) continue;
    for (const std::uint32_t beside_tail : links_.of(at)) {
      if (part.has(beside_tail) || fixed_.joins(at, beside_tail)) continue;
      if (left + matrix_.distance(at, beside_tail) - matrix_.distance(part.tail(), beside_tail) <= 0) continue;
      move(part, at, beside_tail);
      return true;
    }
  }
  return false;
}

void or_opt::move(const segment& part, std::uint32_t beside_head, std::uint32_t beside_tail) {
  const std::uint32_t head = part.head(), tail = part.tail();
  links_.relink(part.before, head, part.after);
  links_.relink(part.after, tail, part.before);
  links_.relink(beside_head, beside_tail, head);
  links_.relink(beside_tail, beside_head, tail);
  links_.relink(head, part.before, beside_head);
  links_.relink(tail, part.after, beside_tail);
  for (const std::uint32_t row : {part.before, part.after, beside_head, beside_tail, head, tail}) changed_.add(row);
}

// 2-opt: replaces two edges by two others and reverses the rows between them.
class two_opt {
 public:
  two_opt(const bit_matrix& matrix, const neighbor_lists& near, tour_edge fixed, std::vector<std::uint32_t>& tour)
      : matrix_(matrix),
        near_(near),
        fixed_(fixed),
        tour_(tour),
        place_(tour.size()),
        size_(static_cast<std::uint32_t>(tour.size())),
        changed_(size_) {
    for (std::uint32_t i = 0; i < size_; ++i) place_[tour_[i]] = i;
  }

  // Returns the number of moves.
  std::uint32_t run() {
    std::uint32_t moves = 0;
    for (std::uint32_t row = 0; changed_.take(row);)
      while (moves_from(row, true) || moves_from(row, false)) ++moves;
    return moves;
  }

 private:
  std::uint32_t later(std::uint32_t place) const { return place + 1 == size_ ? 0 : place + 1; }
  std::uint32_t earlier(std::uint32_t place) const { return place == 0 ? size_ - 1 : place - 1; }
  std::uint32_t next_to(std::uint32_t row, bool forward) const {
    return tour_[forward ? later(place_[row]) : earlier(place_[row])];
  }
  bool moves_from(std::uint32_t a, bool forward);
  bool reverse(std::uint32_t first, std::uint32_t last);

  const bit_matrix& matrix_;
  const neighbor_lists& near_;
  tour_edge fixed_;
  std::vector<std::uint32_t>& tour_;
  std::vector<std::uint32_t> place_;
  std::uint32_t size_;
  changed_rows changed_;
};

// Replaces edges a-b and c-d, where b and d follow in the same direction, by a-c and b-d.
bool two_opt::moves_from(std::uint32_t a, bool forward) {
  const std::uint32_t b = next_to(a, forward);
  if (fixed_.joins(a, b)) return false;
  const std::int32_t cut = matrix_.distance(a, b);
  for (const near_row& near : near_.of(a)) {
    const std::int32_t left = cut - near.distance;
    if (left <= 0) return false;
    const std::uint32_t c = near.row, d = next_to(c, forward);
    if (c == b || d == a || fixed_.joins(c, d)) continue;
    if (left + matrix_.distance(c, d) - matrix_.distance(b, d) <= 0) continue;
    if (!(forward ? reverse(place_[b], place_[c]) : reverse(place_[a], place_[d]))) continue;
    for (const std::uint32_t row : {a, b, c, d}) changed_.add(row);
    return true;
  }
  return false;
}

// Reverses the rows at the positions first .. last, or the rest of the tour, which is equivalent: whichever is shorter.
// Returns false if both are too long.
bool two_opt::reverse(std::uint32_t first, std::uint32_t last) {
  std::uint32_t length = (last >= first ? last - first : last + size_ - first) + 1;
  if (length > size_ / 2) {
    std::swap(first, last);
    first = later(first);
    last = earlier(last);
    length = size_ - length;
  }
  if (length > longest_reversal) return false;
  for (std::uint32_t swaps = length / 2; swaps > 0; --swaps) {
    std::swap(tour_[first], tour_[last]);
    place_[tour_[first]] = first;
    place_[tour_[last]] = last;
    first = later(first);
    last = earlier(last);
  }
  return true;
}

std::uint32_t run_or_opt(const bit_matrix& matrix, const neighbor_lists& near, tour_edge fixed,
                         std::vector<std::uint32_t>& tour) {
  or_opt search(matrix, near, fixed, tour);
  const std::uint32_t moves = search.run();
  tour = search.links().tour_from(fixed.a, fixed.b);
  return moves;
}

}  // namespace

void improve_tour(const bit_matrix& matrix, const neighbor_lists& near, tour_edge fixed,
                  std::vector<std::uint32_t>& tour) {
  if (tour.size() < 4) return;  // all closed tours of so few rows have the same length
  run_or_opt(matrix, near, fixed, tour);
  for (int round = 0; round < rounds; ++round) {
    std::uint32_t moves = two_opt(matrix, near, fixed, tour).run();
    moves += run_or_opt(matrix, near, fixed, tour);
    if (moves <= tour.size() / fewest_moves) return;
  }
}

}  // namespace sightcell::bake
