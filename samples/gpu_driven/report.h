#pragma once
// The table and the JSON object of a run.
#include <cstdint>
#include <string>

#include "host_scene.h"
#include "measurement.h"
#include "sightcell/sightcell.hpp"

namespace gpu_driven {

struct run_facts {
  std::string scene, device;
  bool is_software = false;
  std::uint64_t seed = 0;
  std::uint32_t jumps = 0;  // of the walk
};

void print_json(const run_facts& facts, const host_scene& host, const sightcell::db& db, const renderer& draws,
                const sections& all);
void print_table(const run_facts& facts, const host_scene& host, const sightcell::db& db, const renderer& draws,
                 const sections& all);

}  // namespace gpu_driven
