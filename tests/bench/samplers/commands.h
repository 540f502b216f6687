#pragma once
// What bench_samplers can be told to do. All work on the calling thread's TBB arena and throw sightcell::error.
#include <cstdint>
#include <filesystem>
#include <string>

namespace sightcell::bench {

struct bench_options {
  std::filesystem::path scene, cells, jobs, out;
  std::filesystem::path cache;   // of measure and pictures
  std::string cell;              // of growth and pictures: its name
  std::uint32_t cell_limit = 0;  // 0: all
  std::string scene_hash;        // empty: of the file
  unsigned threads = 0;          // cells that are measured at once
};

// All jobs over all cells of a scene, against the truth of each cell: measure.h says what is written.
void run_measure(const bench_options& how);

// How the set of a cell grows while only one of its faces is sampled (figure 5.13 of the thesis): JSON with scene,
// cell, polygons and faces, all but the one that faces down: face, jobs: label, sizes after the first, second, ...
// hemicube on it. A job's samples are those of one face. Everything is as in a whole cell, but the source sees nothing
// from the other faces and cracks let light through.
void run_growth(const bench_options& how);

// PNGs of what each job's set shows (figures 5.5 to 5.12), and pictures.json with the numbers, which are printed too.
// From where in the cell the first job's set misses most, as truth has it: the whole scene, and for each job its set,
// the pixels that differ in red, and the same with each red pixel grown by two. From outside: the whole scene and what
// each job kept. Sets and truth are taken from the cache or made.
void run_pictures(const bench_options& how);

}  // namespace sightcell::bench
