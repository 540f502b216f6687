#pragma once
// Counts every allocation of the program that links allocation_counter.cpp.
#include <cstddef>

namespace sightcell::test {

// Calls of operator new and, where the C library lets us see them, of malloc, calloc and realloc so far.
std::size_t allocation_count();
// Sanitizers bring their own allocators, which must not be replaced: nothing is counted then.
bool counts_new();
bool counts_malloc();

}  // namespace sightcell::test
