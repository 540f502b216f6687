#include "order/tour.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "order/disjoint_sets.h"
#include "order/improve_tour.h"
#include "order/neighbor_lists.h"
#include "order/tour_links.h"
#include "sightcell/base/in_blocks.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t few_ends = 1500;      // up to here all pairs of fragment ends are compared
constexpr std::uint32_t other_ends = 3;       // ends of other fragments that are tried for each end of a sort,
constexpr std::uint32_t furthest_place = 8;   // up to this distance in the sort
constexpr std::uint64_t neighbor_seed = 1;    // seed of the sorts that propose neighbors of the first path
constexpr std::uint64_t improve_seed = 77;    // seed of the sorts for later paths: other neighbors
constexpr std::uint64_t joining_seed = 1001;  // seed of the sorts that join fragments

// Joins rows to fragments, and fragments to one tour, shortest edges first.
class greedy_tour {
 public:
  greedy_tour(const bit_matrix& matrix, tour_edge fixed)
      : matrix_(matrix), links_(matrix.rows()), fragments_(matrix.rows()), fragment_count_(matrix.rows()) {
    link(fixed.a, fixed.b);
  }

  void take_neighbors(const neighbor_lists& near);
  // Joins fragments until one is left, and closes it.
  void join_fragments(std::uint32_t sorts);
  const tour_links& links() const { return links_; }

 private:
  struct edge {
    std::int32_t distance;
    std::uint32_t a, b;
  };
  void link(std::uint32_t a, std::uint32_t b) {
    links_.link(a, b);
    fragments_.unite(a, b);
    --fragment_count_;
  }
  void take_shortest(std::vector<edge>& edges);
  std::vector<std::uint32_t> ends() const;
  void propose_all(std::span<const std::uint32_t> ends, std::vector<edge>& edges);
  void propose_near(std::span<const std::uint32_t> sorted, std::vector<edge>& edges);

  const bit_matrix& matrix_;
  tour_links links_;
  disjoint_sets fragments_;
  std::uint32_t fragment_count_;
};

void greedy_tour::take_shortest(std::vector<edge>& edges) {
  // Equal edges may occur twice. Their order does not matter.
  sort_without_ties(edges, [](const edge& x, const edge& y) {
    return std::tie(x.distance, x.a, x.b) < std::tie(y.distance, y.a, y.b);
  });
  for (const edge& e : edges)
    if (!links_.full(e.a) && !links_.full(e.b) && fragments_.find(e.a) != fragments_.find(e.b)) link(e.a, e.b);
}

void greedy_tour::take_neighbors(const neighbor_lists& near) {
  std::vector<edge> edges;
  edges.reserve(std::size_t{matrix_.rows()} * near.kept());  // memory that is not used is not touched
  for (std::uint32_t a = 0; a < matrix_.rows(); ++a)
    for (const auto& [b, distance] : near.of(a)) {
      if (b == no_row) break;
      // Each pair once: the row with the larger number proposes only if the other does not.
      if (a > b && std::ranges::any_of(near.of(b), [&](const near_row& r) { return r.row == a; })) continue;
      edges.push_back({distance, std::min(a, b), std::max(a, b)});
    }
  take_shortest(edges);
}

std::vector<std::uint32_t> greedy_tour::ends() const {
  std::vector<std::uint32_t> found;
  for (std::uint32_t row = 0; row < matrix_.rows(); ++row)
    if (!links_.full(row)) found.push_back(row);
  return found;
}

void greedy_tour::propose_all(std::span<const std::uint32_t> ends, std::vector<edge>& edges) {
  for (std::size_t i = 0; i < ends.size(); ++i)
    for (std::size_t k = i + 1; k < ends.size(); ++k)
      if (fragments_.find(ends[i]) != fragments_.find(ends[k]))
        edges.push_back({matrix_.distance(ends[i], ends[k]), ends[i], ends[k]});
}

// A fragment has two ends, so of the next two ends in the sort at least one belongs to another fragment: every call
// finds an edge to take.
void greedy_tour::propose_near(std::span<const std::uint32_t> sorted, std::vector<edge>& edges) {
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    std::uint32_t found = 0;
    for (std::size_t k = i + 1; k < sorted.size() && k <= i + furthest_place && found < other_ends; ++k) {
      const std::uint32_t a = std::min(sorted[i], sorted[k]), b = std::max(sorted[i], sorted[k]);
      if (fragments_.find(a) == fragments_.find(b)) continue;
      edges.push_back({matrix_.distance(a, b), a, b});
      ++found;
    }
  }
}

void greedy_tour::join_fragments(std::uint32_t sorts) {
  std::uint64_t seed = joining_seed;
  while (fragment_count_ > 1) {
    const std::vector<std::uint32_t> open = ends();
    std::vector<edge> edges;
    if (open.size() <= few_ends) {
      propose_all(open, edges);
    } else {
      for (std::uint32_t i = 0; i < std::max(1u, sorts); ++i)
        propose_near(sorted_by_permuted_bits(matrix_, open, seed++), edges);
    }
    take_shortest(edges);
  }
  const std::vector<std::uint32_t> open = ends();
  if (open.size() == 2) links_.link(open[0], open[1]);
}

// Returns the rows between fixed.a and fixed.b.
std::vector<std::uint32_t> without_ends(const std::vector<std::uint32_t>& tour) {
  return {tour.begin() + 1, tour.end() - 1};
}

tour_edge ends_of(const bit_matrix& matrix) {
  return {matrix.rows() - 2, matrix.rows() - 1};
}

}  // namespace

std::vector<std::uint32_t> shortest_path(const bit_matrix& matrix, const tour_settings& how) {
  if (matrix.rows() <= 2) return {};
  if (matrix.rows() == 3) return {0};
  const tour_edge fixed = ends_of(matrix);
  // The row of the end mostly equals that of the beginning, and would only occupy entries of neighbor lists twice.
  std::vector<std::uint32_t> rows(matrix.rows() - 1);
  std::iota(rows.begin(), rows.end(), 0u);
  const neighbor_lists near = neighbors_by_sorts(matrix, rows, how.neighbors, how.sorts, neighbor_seed);
  std::vector<std::uint32_t> tour;
  {
    greedy_tour greedy(matrix, fixed);
    greedy.take_neighbors(near);
    greedy.join_fragments(how.sorts);
    tour = greedy.links().tour_from(fixed.a, fixed.b);
  }
  improve_tour(matrix, near, fixed, tour);
  return without_ends(tour);
}

std::vector<std::uint32_t> improved_path(const bit_matrix& matrix, const std::vector<std::uint32_t>& path,
                                         const tour_settings& how) {
  if (path.size() < 2) return path;
  const tour_edge fixed = ends_of(matrix);
  std::vector<std::uint32_t> tour{fixed.a};
  tour.insert(tour.end(), path.begin(), path.end());
  tour.push_back(fixed.b);
  improve_tour(matrix, neighbors_by_sorts(matrix, tour, how.neighbors, how.sorts, improve_seed), fixed, tour);
  return without_ends(tour);
}

}  // namespace sightcell::bake
