#pragma once
// The name that a user most likely meant, for messages about unknown options, verbs and values.
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sightcell::bake {

// Returns the edit distance of two texts: the least number of characters to insert, remove, replace or swap with their
// neighbor (optimal string alignment).
// Cost: O(a.size() * b.size()).
std::size_t edit_distance(std::string_view a, std::string_view b);

// Returns the name that is nearest to a text, nothing if none is similar. Similar is a name with an edit distance of at
// most a third of the length of the text, or one that the text abbreviates by three characters or more.
// names: the first of equally near ones is returned.
std::optional<std::string_view> nearest_name(std::string_view text, std::span<const std::string_view> names);

// Returns "; did you mean NAME?" with the nearest name, or an empty text.
std::string did_you_mean(std::string_view text, std::span<const std::string_view> names);

}  // namespace sightcell::bake
