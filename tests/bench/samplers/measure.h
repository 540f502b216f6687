#pragma once
// bench_samplers measure: all jobs over all cells of a scene, against the truth of each cell.
#include "bench/hemicube/cache.h"
#include "bench/samplers/ground.h"
#include "bench/samplers/jobs.h"
#include "bench/samplers/kept_files.h"

namespace sightcell::bench {

// Works on the calling thread's TBB arena. What it gives (means are over cells; what is pooled takes cells as equal):
//   scene, hash, polygons, left_out (names of cells without a free point)
//   cells: name, min, max, geometry_inside, valid_share, truth_rays, truth_polygons (how many truth saw)
//   jobs: label, settings, pooled, cells. Of a cell: samples, rays, cpu_seconds, set (its size), pixel_error with its
//     95 % interval low and high, misses (truth rays that are wrong), misses_effective (as if independent),
//     color_error, from_cache. pooled: pixel_error, low, high, misses_effective, interval_met, color_error, and means:
//     visible_percent, cpu_seconds, samples, rays
//   truth: interval, interval_met, rays (of the cell with the fewest), place_rays
//   truth_cpu_seconds, sampling_cpu_seconds: of all that is in the file, whenever it was measured
json measure_samplers(const ground& g, const job_list& list, const kept_files& kept, unsigned threads);

}  // namespace sightcell::bench
