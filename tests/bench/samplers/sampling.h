#pragma once
// Runs the jobs over the cells, or takes what was kept.
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/samplers/ground.h"
#include "bench/samplers/jobs.h"
#include "bench/samplers/kept_files.h"
#include "hemicube/choice/choose_source.h"
#include "job/cell_bake.h"
#include "sampler/cell_sampler.h"
#include "search/near_polygons.h"

namespace sightcell::bench {

// What a job found in a cell, and what it took.
struct sampled_figures {
  std::string key;
  std::uint32_t samples = 0;
  std::uint64_t rays = 0;
  // Of sampling alone, on one thread; of a source with a device, of the process. With the cell's part of what the
  // sampler prepared for all cells. Where there is a bound, of all that a bake does for the cell.
  double cpu_seconds = 0.0;
  double upper_bound = 1.0;  // 1: none
  std::uint32_t set_size = 0;
  bool from_cache = false;
};

class sampling_bench {
 public:
  // References must outlive the object. threads: how many cells are measured at once, each on one thread.
  sampling_bench(const ground& g, const kept_files& kept, unsigned threads);
  ~sampling_bench();

  // One per cell. measured: told after each cell that was not kept.
  std::vector<sampled_figures> run(const job& what, const std::function<void(std::size_t cell)>& measured);
  // Of one cell alone.
  sampled_figures run_cell(const job& what, std::size_t cell);
  // How many cells run() would measure.
  std::size_t missing(const job& what) const;
  // Ascending. Throws sightcell::error where it is no longer kept.
  std::vector<std::uint32_t> set_of(const sampled_figures& figures) const;

 private:
  struct clocked_sampler;

  std::string key_of(const job& what, std::size_t cell) const;
  sampled_figures kept_figures(const job& what, std::size_t cell) const;  // the key alone where nothing is kept
  void measure(const job& what, const std::vector<std::size_t>& cells, std::vector<sampled_figures>& figures,
               const std::function<void(std::size_t cell)>& measured);
  bake::hemicube_source& source_of(const bake::settings& how);
  const bake::near_polygons* neighbors();

  const ground& ground_;
  const kept_files& kept_;
  const unsigned threads_;
  const bake::overrides none_;
  bake::settings how_;  // of the job that runs; the baker looks at it
  std::unique_ptr<clocked_sampler> sampler_;
  std::optional<bake::cell_baker> baker_;  // likewise
  std::optional<bake::near_polygons> neighbors_;
  bake::chosen_source eyes_;
  std::string eyes_for_;  // what settings they were made for
};

}  // namespace sightcell::bench
