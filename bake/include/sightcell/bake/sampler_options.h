#pragma once
// The samplers and the settings that only some of them have: names, units, ranges and meanings, once. The command line
// with its help, validate(), describe() and `sightcell samplers` (whose output is bake/SAMPLERS.md) are made from these
// tables; defaults are those of bake::settings.
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "sightcell/bake/settings.h"

namespace sightcell::bake {

struct sampler_info {
  const char* name;     // as --sampler has it
  const char* meaning;  // one line
  const char* origin;   // who published it
};

// All samplers, in the order in which they are listed for people. Static storage.
std::span<const sampler_info> samplers();

struct sampler_option {
  const char* name;  // "--samples"
  const char* unit;  // what the value is counted in, for help: "N", "S"
  const char* meaning;
  std::variant<std::uint32_t settings::*, std::uint64_t settings::*, double settings::*, bool settings::*> value;
  double low, high;                            // both are in the range; of a flag 0 and 1
  std::span<const std::string_view> samplers;  // who has it
  bool of(std::string_view sampler) const;
};

// Static storage.
std::span<const sampler_option> sampler_options();

// Of samplers that look with rays alone --samples, --jitter, --resolution and --source say nothing. A name that is none
// takes none.
bool takes_hemicubes(std::string_view sampler);

// The value that s has for an option, as shortest text that reads back as the same value; a flag is "true" or "false".
std::string value_text(const sampler_option& option, const settings& s);

}  // namespace sightcell::bake
