#pragma once
// Runs programs, this one among them: what is measured gets a process of its own.
#include <filesystem>
#include <string>
#include <vector>

#include "bench/hemicube/cache.h"

namespace sightcell::bench {

// This program's own file.
std::filesystem::path own_program();

// Runs a program to its end, its messages going where ours go. Throws sightcell::error when it does not end well.
void run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments);

// Runs this program as a worker (jobs.h) and gives what it wrote. environment: name=value, set in the worker alone.
json run_job(json job, const std::vector<std::string>& environment = {});

}  // namespace sightcell::bench
