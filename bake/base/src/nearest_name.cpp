#include "sightcell/base/nearest_name.h"

#include <algorithm>
#include <vector>

namespace sightcell::bake {
namespace {

constexpr std::size_t least_abbreviation = 3;  // characters

bool abbreviates(std::string_view text, std::string_view name) {
  return text.size() >= least_abbreviation && name.starts_with(text);
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  // Rows of the table of distances between beginnings: the one before the last, the last, and the current one.
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) now[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before.swap(last);
    last.swap(now);
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      now[j] = std::min({replaced, last[j] + 1, now[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) now[j] = std::min(now[j], before[j - 2] + 1);
    }
  }
  return now[b.size()];
}

std::optional<std::string_view> nearest_name(std::string_view text, std::span<const std::string_view> names) {
  std::optional<std::string_view> nearest;
  std::size_t least = text.size() / 3 + 1;
  for (const std::string_view name : names) {
    const std::size_t distance = abbreviates(text, name) ? 1 : edit_distance(text, name);
    if (distance >= least) continue;
    least = distance;
    nearest = name;
  }
  return nearest;
}

std::string did_you_mean(std::string_view text, std::span<const std::string_view> names) {
  const auto name = nearest_name(text, names);
  return name ? "; did you mean " + std::string(*name) + "?" : std::string();
}

}  // namespace sightcell::bake
