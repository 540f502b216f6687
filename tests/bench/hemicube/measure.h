#pragma once
// What is measured, each in a process of its own.
#include <vector>

#include "bench/hemicube/cache.h"

namespace sightcell::bench {

// Job "time": scene, sources, culling, resolution, rounds, pace, parts: [{label (for progress), poses (a list), facts,
// result}]. What is measured of a part is written to the file result, with facts, as soon as it is done. CPU time of
// one core: one thread of oneTBB, all threads of the process counted. All sources render each pose before the next one,
// in turns as to which comes first; the first round warms up and does not count. The floor is a source of its own:
// plain loops that write every pixel and read the corners of the seen polygons once.
json measure_time(const json& job);

// Job "probe": source. The answer says whether it is there ("ok"), and on which device or why not ("what").
json probe(const json& job);

// Job "memory": scene, poses, source, culling, resolution. The answer: the process's memory before and with the source,
// and its CPU time per sample.
json measure_memory(const json& job);

// Job "threads": scene, poses, resolution, rounds: the cpu source with one and with two threads, all poses in one call.
// What the calling thread computes more than the other one is not parallel: parallel_percent. Roughly so where others
// use the machine, as they take from one thread more than from the other.
json measure_threads(const json& job);

double median(std::vector<double> values);

}  // namespace sightcell::bench
