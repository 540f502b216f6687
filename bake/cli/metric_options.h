#pragma once
// --metric and its options, for every verb that bounds an error.
#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sightcell/bake/settings.h"

namespace sightcell::cli {

struct metric_options {
  std::string metric = std::string(bake::metric_names.front());
  bake::metric_settings settings;  // what is not here as text or list
  std::vector<std::uint32_t> resolution{settings.view_width, settings.view_height};
  std::vector<double> pitch{settings.view_pitch.begin(), settings.view_pitch.end()};
};

// Adds the options to a group of a verb. Those of view are rejected with another metric.
// options: must outlive the verb.
void add_metric_options(CLI::App& verb, metric_options& options, const std::string& group);

// Returns what was asked for.
// Fails with settings.out-of-range; the line names the option.
bake::metric_settings metric_of(const metric_options& options);

// "pixel error"
std::string error_name(std::string_view metric);
std::string error_name(const bake::metric_settings& how);

}  // namespace sightcell::cli
