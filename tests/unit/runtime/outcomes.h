#pragma once
// The statuses that calls of the C API return, and what the headers of the runtime declare.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "sightcell/sightcell.h"

namespace sightcell::test {

using statuses = std::set<sightcell_status>;

// The results of calls.
struct outcomes {
  std::map<std::string, statuses> of_function;
  std::uint32_t frame_flags = 0;
  std::uint32_t debug_kinds = 0;
  std::map<std::uint32_t, std::uint32_t> polygons_outside;  // by policy
  std::set<std::uint32_t> kept_while_pending;               // policies with which the last set was kept

  void note(const std::string& call, sightcell_status expected, sightcell_status answer) {
    EXPECT_EQ(answer, expected) << call;
    of_function[call.substr(0, call.find('('))].insert(answer);
  }
};

// RETURNS(status without its SIGHTCELL_, a call of the C API)
#define RETURNS(status, ...) out.note(#__VA_ARGS__, SIGHTCELL_##status, __VA_ARGS__)

// Returns this number of blocks.
struct few_blocks {
  explicit few_blocks(int blocks) : left(blocks) {}
  int left;
  sightcell_allocator interface {
    [](void* user, std::size_t size, std::size_t) -> void* {
      return static_cast<few_blocks*>(user)->left-- > 0 ? std::malloc(size) : nullptr;
    },
        [](void*, void* block, std::size_t) { std::free(block); }, this
  };
};

struct header {
  std::set<std::string> functions;                   // that return a status
  std::map<std::string, std::uint32_t> enumerators;  // without SIGHTCELL_
};

// Reads the headers of the runtime library.
inline header read_headers() {
  header found;
  std::string all;
  for (const char* name :
       {"sightcell.h", "casters.h", "clusters.h", "viewpoints.h", "identity.h", "residency.h", "lights.h"}) {
    std::ifstream file(std::string(SIGHTCELL_TEST_HEADERS) + name);
    all.append(std::istreambuf_iterator<char>(file), {});
  }
  std::istringstream text(all);
  for (std::string line; std::getline(text, line);) {
    std::array<char, 64> name{};
    unsigned value = 0;
    if (std::sscanf(line.c_str(), "SIGHTCELL_API sightcell_status %63[a-z_](", name.data()) == 1) {
      found.functions.insert(name.data());
    } else if (std::sscanf(line.c_str(), " SIGHTCELL_%63[A-Z_] = %u", name.data(), &value) == 2) {
      found.enumerators[name.data()] = value;
    }
  }
  return found;
}

}  // namespace sightcell::test
