#pragma once
// Sets of source ids -> runs in the order that a file stores, first of polygons, then of atoms (polygon_orders.h): all
// sets are marked, which finds the atoms, and then every set can be given as runs of these.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "polygon_orders_writer.h"
#include "sightcell/format/records.h"

namespace sightcell::format {

class stored_sets {
 public:
  // draws: in stored order, gapless by first_stored, and their source ids are all below polygon_count, each once.
  // order_of_draw: as many; which of the orders a draw has. orders: permutations, each as long as the draws that have
  // it.
  stored_sets(std::span<const draw_record> draws, std::span<const std::uint32_t> order_of_draw,
              std::span<const std::vector<std::uint32_t>> orders);

  // Stored polygons of a set of source ids, each once, in any order. runs is replaced. Not for two threads at once.
  void polygon_runs(std::span<const std::uint32_t> source_ids, std::vector<run>& runs);

  // Runs of stored polygons: of every set, before find_atoms.
  void mark(std::span<const run> polygons);
  // Where no marked run begins or ends in any of the draws of an order, two polygons are of one atom. Inside atoms
  // the orders are sorted, which changes no run of a set that was marked.
  void find_atoms();

  // The same runs, counted in atoms. Runs must begin and end where atoms do, as those that were marked.
  void to_atoms(std::vector<run>& polygons) const;

  [[nodiscard]] std::uint32_t atom_count() const { return first_atom_.back(); }
  // Number of a draw's first atom; draw may be the number of draws.
  [[nodiscard]] std::uint32_t first_atom(std::size_t draw) const { return first_atom_[draw]; }
  [[nodiscard]] std::span<const polygon_order> orders() const { return orders_; }

 private:
  // A stored polygon as its draw and its place in it. Borders come ascending: draw is where the last one was.
  struct place {
    std::size_t draw = 0;
    std::uint32_t local = 0;
  };
  void find_place(std::uint32_t polygon, place& at) const;

  std::vector<draw_record> draws_;
  std::vector<std::uint32_t> order_of_draw_;
  std::vector<polygon_order> orders_;
  std::vector<std::uint32_t> stored_of_source_;
  std::vector<std::uint64_t> members_;                    // a bit for each stored polygon; empty between calls
  std::vector<std::vector<std::uint32_t>> atoms_before_;  // of each order: how many begin before a polygon
  std::vector<std::uint32_t> first_atom_;                 // of each draw, and the end
};

}  // namespace sightcell::format
