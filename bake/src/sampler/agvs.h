#pragma once
// The sampler agvs: casts rays for all cells of the bake together (Bittner, Mattausch, Wonka, Havran, Wimmer 2009).
// docs/method/samplers.md states how the paper was read.
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "sampler/cell_sampler.h"
#include "sampler/free_memory.h"
#include "sampler/global_rays.h"
#include "sampler/ray_feed.h"
#include "sampler/seen_pairs.h"
#include "sampler/segment_cells.h"

namespace sightcell::bake {

class agvs final : public cell_sampler {
 public:
  // how and the references in world must outlive the sampler.
  agvs(const settings& how, const sampler_world& world);

  void prepare(const std::function<bool(double share)>& go_on) override;
  // Adds what the rays of prepare() found for the cell at this place, and with settings::filter also what they found
  // for cells near it.
  sampling_effort sample(const sampled_cell& cell, cell_set& set) const override;

  struct kind_result {
    std::uint64_t rays = 0, pairs = 0;  // pairs: new pairs (cell, polygon)
  };
  // Returns rays and finds per kind of ray, in the order of ray_kind.
  const std::array<kind_result, ray_kinds>& results() const { return results_; }
  std::uint64_t pairs() const;  // returns the number of pairs (cell, polygon) of all cells

 private:
  // The rays of one round, which all use one state of the sets.
  struct round_plan {
    std::array<std::uint64_t, ray_kinds> counts{};
    std::vector<std::uint32_t> candidates;  // for mutations first, then for silhouettes
  };
  static ray_kind kind_of(const round_plan& plan, std::uint64_t& i);
  round_plan plan_round(std::uint64_t rays);
  global_ray ray_of(const round_plan& plan, std::uint64_t i, random_stream& numbers) const;
  feed_finds cast(const round_plan& plan) const;
  std::uint64_t merge(const round_plan& plan, feed_finds& finds);
  void make_candidates(std::vector<found_pair>& joined);

  const settings& how_;
  const sampler_world world_;
  std::vector<std::uint64_t> places_;  // of the cells, ascending; the members below are in this order
  std::vector<box> cells_;             // without the margin
  segment_cells grown_;
  global_rays rays_;
  std::vector<seen_pairs> known_;
  free_memory memory_;

  adaptive_shares shares_;
  std::vector<mutation_candidate> pool_;
  std::vector<blocked_ray> blocked_;  // of the last round
  std::uint64_t round_ = 0, spent_ = 0, made_ = 0;
  std::array<kind_result, ray_kinds> results_{};
};

}  // namespace sightcell::bake
