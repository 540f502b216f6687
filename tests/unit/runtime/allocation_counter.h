#pragma once
// Counts every allocation of the program that links allocation_counter.cpp.
#include <cstddef>

namespace sightcell::test {

// Calls of operator new and, where the C library allows it, of malloc, calloc and realloc so far.
std::size_t allocation_count();
// Sanitizers have their own allocators, which must not be replaced: then nothing is counted.
bool counts_new();
bool counts_malloc();

}  // namespace sightcell::test
