#pragma once
// The samplers, and the settings that only some of them use: names, units, ranges and meanings, once. The command line,
// its help, validate(), describe() and `sightcell samplers` are made from these tables. Defaults are those of
// bake::settings. All storage is static.
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "sightcell/bake/settings.h"

namespace sightcell::bake {

// ---- Samplers -------------------------------------------------------------------------------------------------------

struct sampler_info {
  const char* name;     // the value of --sampler
  const char* meaning;  // one line
  const char* origin;   // publication; may be empty
};

// Returns all samplers, in the order in which help texts list them.
std::span<const sampler_info> samplers();

// Returns whether a sampler makes hemicubes. Others use rays only: --samples, --jitter, --resolution and --source have
// no effect for them. False for an unknown name.
bool takes_hemicubes(std::string_view sampler);

// Returns whether a sampler uses the importance of hemicubes. False for an unknown name.
bool uses_importance(std::string_view sampler);

// ---- Their options --------------------------------------------------------------------------------------------------

struct sampler_option {
  const char* name;     // "--samples"
  const char* unit;     // of the value, for help: "N", "S"; empty for a flag
  const char* meaning;  // one line
  std::variant<std::uint32_t settings::*, std::uint64_t settings::*, double settings::*, bool settings::*> value;
  double low, high;                            // the range, inclusive; 0 and 1 for a flag
  std::span<const std::string_view> samplers;  // that use it

  // Returns whether a sampler uses the option.
  bool of(std::string_view sampler) const;
};

// Returns the options of all samplers, in the order in which help texts list them.
std::span<const sampler_option> sampler_options();

// Returns the value of an option: the shortest text that reads back as the same number; "true" or "false" for a flag.
std::string value_text(const sampler_option& option, const settings& s);

}  // namespace sightcell::bake
