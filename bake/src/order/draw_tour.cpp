#include "order/draw_tour.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "sightcell/base/in_blocks.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t kept_neighbors = 32;
constexpr std::uint32_t few_draws = 6000;      // up to here all pairs of ends are compared
constexpr std::uint32_t few_ends = 2000;       // up to here all pairs of fragment ends are compared
constexpr std::uint32_t places_ahead = 8;      // ends of a sort that are proposed to each other
constexpr std::uint32_t fitting_ends = 3;      // ends of other fragments that are tried for each end of a sort,
constexpr std::uint32_t furthest_place = 32;   // up to this distance in the sort
constexpr std::uint64_t neighbor_seed = 3001;  // seed of the sorts that propose neighbors
constexpr std::uint64_t joining_seed = 4001;   // seed of the sorts that join fragments
constexpr int longest_search = 6;              // maximum number of Or-opt passes over all draws

neighbor_lists neighbors_of_ends(const bit_matrix& ends, std::uint32_t sorts) {
  const std::uint32_t count = ends.rows() - 1;
  std::vector<std::uint32_t> all(count);
  std::iota(all.begin(), all.end(), 0u);
  // Sorts propose first even if all pairs are compared afterwards. Many ends may be equal. To those, sorts propose
  // different neighbors, while the nearest by number would be the same for all.
  neighbor_lists near(ends.rows(), kept_neighbors);
  near.add_in_order(ends, all, places_ahead);
  for (std::uint64_t seed = neighbor_seed; seed < neighbor_seed + sorts; ++seed)
    near.add_in_order(ends, sorted_by_permuted_bits(ends, all, seed), places_ahead);
  if (count > 2 * few_draws) return near;
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, 64), [&](const auto& range) {
    for (std::uint32_t a = range.begin(); a < range.end(); ++a)
      for (std::uint32_t b = 0; b < count; ++b)
        if (draw_of(a) != draw_of(b)) near.add(a, b, ends.distance(a, b));
  });
  return near;
}

// Joins draws to fragments, and fragments to one path, shortest edges first.
class greedy_draws {
 public:
  greedy_draws(const bit_matrix& ends, std::span<const std::uint8_t> flippable)
      : ends_(ends), mates_(ends.rows() - 1, no_row), far_(mates_.size()), roles_(mates_.size(), role::either) {
    for (std::uint32_t end = 0; end < far_.size(); ++end) {
      far_[end] = other_end(end);
      if (flippable[draw_of(end)] == 0) roles_[end] = end % 2 == 0 ? role::head : role::tail;
    }
  }

  void take_neighbors(const neighbor_lists& near);
  // Joins fragments until one is left.
  void join_fragments(std::uint32_t sorts);
  std::vector<std::uint32_t> entries() const;

 private:
  // What an end of a fragment must be if the fragment has a draw that cannot be flipped.
  enum class role : std::uint8_t { either, head, tail };
  struct edge {
    std::int32_t distance;
    std::uint32_t a, b;
  };
  bool fit(std::uint32_t a, std::uint32_t b) const {
    return a != b && far_[a] != b && (roles_[a] == role::either || roles_[a] != roles_[b]);
  }
  void join(std::uint32_t a, std::uint32_t b);
  void take_shortest(std::vector<edge>& edges);
  std::vector<std::uint32_t> open_ends() const;
  void propose(std::uint32_t a, std::uint32_t b, std::vector<edge>& edges) const {
    edges.push_back({ends_.distance(a, b), std::min(a, b), std::max(a, b)});
  }
  void propose_all(std::span<const std::uint32_t> open, std::vector<edge>& edges) const;
  void propose_near(std::span<const std::uint32_t> sorted, std::vector<edge>& edges) const;
  void propose_nearest(std::span<const std::uint32_t> open, std::vector<edge>& edges) const;

  const bit_matrix& ends_;
  std::vector<std::uint32_t> mates_;  // the end of another draw that each end is joined to
  std::vector<std::uint32_t> far_;    // of each open end: the other end of its fragment
  std::vector<role> roles_;           // of each open end
};

void greedy_draws::join(std::uint32_t a, std::uint32_t b) {
  const std::uint32_t far_a = far_[a], far_b = far_[b];
  mates_[a] = b;
  mates_[b] = a;
  far_[far_a] = far_b;
  far_[far_b] = far_a;
  // If one fragment could be flipped until now, it takes its orientation from the other.
  if (roles_[b] == role::either) roles_[far_b] = roles_[a];
  if (roles_[a] == role::either) roles_[far_a] = roles_[b];
}

void greedy_draws::take_shortest(std::vector<edge>& edges) {
  // Equal edges may occur twice. Their order does not matter.
  sort_without_ties(edges, [](const edge& x, const edge& y) {
    return std::tie(x.distance, x.a, x.b) < std::tie(y.distance, y.a, y.b);
  });
  for (const edge& e : edges)
    if (mates_[e.a] == no_row && mates_[e.b] == no_row && fit(e.a, e.b)) join(e.a, e.b);
}

void greedy_draws::take_neighbors(const neighbor_lists& near) {
  std::vector<edge> edges;
  for (std::uint32_t a = 0; a < mates_.size(); ++a)
    for (const auto& [b, distance] : near.of(a))
      if (b != no_row && fit(a, b)) edges.push_back({distance, std::min(a, b), std::max(a, b)});
  take_shortest(edges);
}

std::vector<std::uint32_t> greedy_draws::open_ends() const {
  std::vector<std::uint32_t> open;
  for (std::uint32_t end = 0; end < mates_.size(); ++end)
    if (mates_[end] == no_row) open.push_back(end);
  return open;
}

void greedy_draws::propose_all(std::span<const std::uint32_t> open, std::vector<edge>& edges) const {
  for (std::size_t i = 0; i < open.size(); ++i)
    for (std::size_t k = i + 1; k < open.size(); ++k)
      if (fit(open[i], open[k])) propose(open[i], open[k], edges);
}

void greedy_draws::propose_near(std::span<const std::uint32_t> sorted, std::vector<edge>& edges) const {
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    std::uint32_t found = 0;
    for (std::size_t k = i + 1; k < sorted.size() && k <= i + furthest_place && found < fitting_ends; ++k)
      if (fit(sorted[i], sorted[k])) {
        propose(sorted[i], sorted[k], edges);
        ++found;
      }
  }
}

// Proposes to each end the nearest one; of equally near ones the next by number, so that equal ends do not all choose
// the same one.
void greedy_draws::propose_nearest(std::span<const std::uint32_t> open, std::vector<edge>& edges) const {
  std::vector<edge> nearest(open.size());
  in_blocks(open.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      nearest[i] = {std::numeric_limits<std::int32_t>::max(), 0, 0};
      for (std::size_t k = 1; k < open.size(); ++k) {
        const std::uint32_t a = open[i], b = open[(i + k) % open.size()];
        if (!fit(a, b)) continue;
        const std::int32_t distance = ends_.distance(a, b);
        if (distance < nearest[i].distance) nearest[i] = {distance, std::min(a, b), std::max(a, b)};
      }
    }
  });
  edges.insert(edges.end(), nearest.begin(), nearest.end());
}

// Comparing all pairs joins the rest to one fragment: pairs that do not fit never fit later, and a pair that still
// fitted at the end would have been joined.
void greedy_draws::join_fragments(std::uint32_t sorts) {
  std::uint64_t seed = joining_seed;
  std::vector<edge> edges;
  for (std::vector<std::uint32_t> open = open_ends(); open.size() > 2;) {
    edges.clear();
    if (open.size() <= few_ends) {
      propose_all(open, edges);
    } else {
      for (std::uint32_t i = 0; i < sorts; ++i) propose_near(sorted_by_permuted_bits(ends_, open, seed++), edges);
    }
    take_shortest(edges);
    std::vector<std::uint32_t> left = open_ends();
    // If heads and tails are far apart, sorts find few edges.
    if (left.size() > open.size() - open.size() / 8) {
      edges.clear();
      propose_nearest(left, edges);
      take_shortest(edges);
      left = open_ends();
    }
    open = std::move(left);
  }
}

std::vector<std::uint32_t> greedy_draws::entries() const {
  std::vector<std::uint32_t> found;
  const std::vector<std::uint32_t> open = open_ends();
  if (open.empty()) return found;
  std::uint32_t entry = roles_[open[0]] == role::tail ? open[1] : open[0];
  for (;;) {
    found.push_back(entry);
    const std::uint32_t exit = other_end(entry);
    if (mates_[exit] == no_row) return found;
    entry = mates_[exit];
  }
}

// Or-opt: moves single draws, flipped or not.
class draw_moves {
 public:
  draw_moves(const bit_matrix& ends, const neighbor_lists& near, std::span<const std::uint8_t> flippable,
             std::span<const std::uint32_t> entries)
      : ends_(ends), near_(near), flippable_(flippable), links_(entries.size()), first_(draw_of(entries[0])) {
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const std::uint32_t before = i == 0 ? no_row : draw_of(entries[i - 1]);
      const std::uint32_t after = i + 1 == entries.size() ? no_row : draw_of(entries[i + 1]);
      links_[draw_of(entries[i])] = {.before = before, .after = after, .entry = entries[i]};
    }
  }

  // Moves each draw to its best position. Returns whether a draw moved.
  bool pass() {
    bool moved = false;
    for (std::uint32_t draw = 0; draw < links_.size(); ++draw)
      for (std::uint32_t flip = 0; flip <= flippable_[draw]; ++flip) {
        const place best = best_place(draw, links_[draw].entry ^ flip);
        if (best.gain <= 0) continue;
        move(draw, links_[draw].entry ^ flip, best);
        moved = true;
      }
    return moved;
  }
  std::vector<std::uint32_t> entries() const {
    std::vector<std::uint32_t> found;
    for (std::uint32_t draw = first_; draw != no_row; draw = links_[draw].after) found.push_back(links_[draw].entry);
    return found;
  }

 private:
  struct links {
    std::uint32_t before, after, entry;
  };
  // A position for the moved draw, between two draws that are adjacent without it.
  struct place {
    std::int32_t gain = 0;
    std::uint32_t before = no_row, after = no_row;
  };
  std::uint32_t nothing() const { return ends_.rows() - 1; }
  std::uint32_t entry_of(std::uint32_t draw) const { return draw == no_row ? nothing() : links_[draw].entry; }
  std::uint32_t exit_of(std::uint32_t draw) const { return draw == no_row ? nothing() : other_end(links_[draw].entry); }
  std::int32_t between(std::uint32_t before, std::uint32_t after) const {
    return ends_.distance(exit_of(before), entry_of(after));
  }
  place best_place(std::uint32_t draw, std::uint32_t entry) const;
  void move(std::uint32_t draw, std::uint32_t entry, const place& to);

  const bit_matrix& ends_;
  const neighbor_lists& near_;
  std::span<const std::uint8_t> flippable_;
  std::vector<links> links_;
  std::uint32_t first_;
};

// Finds the position with the largest gain among those where an end of the draw is adjacent to an end in its neighbor
// list.
draw_moves::place draw_moves::best_place(std::uint32_t draw, std::uint32_t entry) const {
  const auto [before, after, old_entry] = links_[draw];
  const std::int32_t freed = between(before, draw) + between(draw, after) - between(before, after);
  place best;
  for (const bool by_entry : {true, false})
    for (const near_row& near : near_.of(by_entry ? entry : other_end(entry))) {
      if (near.row == no_row) break;
      const std::uint32_t other = draw_of(near.row);
      if (other == draw || (by_entry ? exit_of(other) : entry_of(other)) != near.row) continue;
      place at{.before = other, .after = other};
      if (by_entry)
        at.after = links_[other].after == draw ? after : links_[other].after;
      else
        at.before = links_[other].before == draw ? before : links_[other].before;
      at.gain = freed + between(at.before, at.after) - ends_.distance(exit_of(at.before), entry) -
                ends_.distance(other_end(entry), entry_of(at.after));
      if (at.gain > best.gain) best = at;
    }
  return best;
}

void draw_moves::move(std::uint32_t draw, std::uint32_t entry, const place& to) {
  const auto join = [&](std::uint32_t before, std::uint32_t after) {
    (before == no_row ? first_ : links_[before].after) = after;
    if (after != no_row) links_[after].before = before;
  };
  join(links_[draw].before, links_[draw].after);
  links_[draw].entry = entry;
  join(to.before, draw);
  join(draw, to.after);
}

}  // namespace

draw_tour::draw_tour(const bit_matrix& ends, std::span<const std::uint8_t> flippable, std::uint32_t sorts)
    : flippable_(flippable.begin(), flippable.end()), near_(neighbors_of_ends(ends, sorts)) {
  greedy_draws greedy(ends, flippable_);
  greedy.take_neighbors(near_);
  greedy.join_fragments(sorts);
  entries_ = greedy.entries();
  improve(ends);
}

void draw_tour::improve(const bit_matrix& ends) {
  if (entries_.size() < 2) return;
  draw_moves moves(ends, near_, flippable_, entries_);
  for (int pass = 0; pass < longest_search && moves.pass(); ++pass) {
  }
  entries_ = moves.entries();
}

}  // namespace sightcell::bake
