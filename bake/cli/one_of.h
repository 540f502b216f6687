#pragma once
// Options whose value is one of a few names.
#include <CLI/CLI.hpp>
#include <span>
#include <string_view>

namespace sightcell::cli {

// Accepts these names only. The message for another value lists them, and the nearest one if the value is similar.
// names: static storage.
CLI::Validator one_of(std::span<const std::string_view> names);

}  // namespace sightcell::cli
