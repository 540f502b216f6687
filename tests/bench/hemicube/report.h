#pragma once
// Tables from what was measured.
#include <string>
#include <vector>

#include "bench/hemicube/cache.h"

namespace sightcell::bench {

struct measured {
  std::vector<json> results;  // one per scene and height (jobs "time"), in the order they were asked for
  json memory;                // scene -> source -> job "memory"
  json threads;               // job "threads", or null
};

// Markdown on standard output.
void print_tables(const measured& all);

}  // namespace sightcell::bench
