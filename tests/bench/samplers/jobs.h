#pragma once
// What is to be measured: JOBS.json.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/hemicube/cache.h"
#include "sightcell/bake/settings.h"

namespace sightcell::bench {

// Where an eye can be and what it sees there: truth depends on it, so it is the same for all jobs of a run.
struct seeing_rules {
  float margin = 0.25f, player_radius = 0.05f, smallest_gap = 0.002f;
  bool operator==(const seeing_rules&) const = default;
};

struct job {
  std::string label;
  std::string code;     // names the code that a result is of; opaque
  bake::settings how;   // max_pixel_error 0: the sampler alone; else rays to that bound follow
  json settings;        // all that its sampler looks at, with defaults
  bool of_all = false;  // what a cell gets depends on the other cells of the run
  // For explaining: false, hemicubes say nothing of importance, so that importance-depth goes where it is far from all
  // samples.
  bool importance = true;
  seeing_rules rules() const { return {how.margin, how.player_radius, how.smallest_gap}; }
};

struct truth_wish {
  double interval = 0.1;                                        // of the error pooled over the cells, as a share of it
  std::uint64_t first_rays = 1'000'000, max_rays = 40'000'000;  // per cell
};

struct job_list {
  std::vector<job> jobs;
  truth_wish truth;
};

// {"jobs":[{"label":"depth 80","code":"...","settings":{"sampler":"importance-depth","samples":80}}],
//  "truth":{"interval":0.1,"first_rays":1e6,"max_rays":4e7}}
// A setting is a sampler's option without its dashes (sampler_options.h), with _ or -, or one of sampler, resolution,
// seed, source, margin, player_radius, smallest_gap, max_pixel_error. "importance": false, "of_all": true besides label and code: see
// above; agvs always is of all. Throws sightcell::error where a setting is not known, not the sampler's or out of
// range, or rules differ.
job_list read_jobs(const std::filesystem::path& path);
job_list parse_jobs(const json& text, const std::string& subject);

}  // namespace sightcell::bench
