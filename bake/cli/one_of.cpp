#include "one_of.h"

#include <fmt/format.h>

#include <algorithm>

#include "sightcell/base/nearest_name.h"

namespace sightcell::cli {

CLI::Validator one_of(std::span<const std::string_view> names) {
  return {[names](std::string& value) {
            if (std::find(names.begin(), names.end(), value) != names.end()) return std::string();
            return fmt::format("is \"{}\"; give one of {}{}", value, fmt::join(names, ", "),
                               bake::did_you_mean(value, names));
          },
          ""};
}

}  // namespace sightcell::cli
