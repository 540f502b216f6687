#include "misses/reported_misses.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <tuple>
#include <utility>

#include "sightcell/base/json_text.h"

namespace sightcell::bake {
namespace {

constexpr const char* member = "misses";

// The test of the runtime: without rounding, half-open.
bool holds(double min, double max, double margin, float place) {
  return static_cast<double>(place) >= min - margin && static_cast<double>(place) < max + margin;
}

using hashes_of_blocks = std::map<std::uint32_t, std::string_view>;

// Parses the text of key_of(): "3; 0:12ab 7:34cd".
hashes_of_blocks blocks_in(std::string_view text) {
  hashes_of_blocks found;
  text.remove_prefix(std::min(text.find(';'), text.size()));
  for (;;) {
    text.remove_prefix(std::min(text.find_first_not_of("; "), text.size()));
    if (text.empty()) return found;
    const std::string_view entry = text.substr(0, text.find(' '));
    text.remove_prefix(entry.size());
    const std::size_t colon = std::min(entry.find(':'), entry.size());
    std::uint32_t block = 0;
    std::from_chars(entry.data(), entry.data() + colon, block);
    found[block] = entry.substr(colon);
  }
}

// A key, which is plain words followed by the settings as a JSON object, with the misses taken out of that.
struct key_parts {
  std::string words;
  nlohmann::json settings;
  std::string misses;
};

std::optional<key_parts> parts_of(const std::string& key) {
  const std::size_t begin = std::min(key.find('{'), key.size());
  key_parts parts{key.substr(0, begin), scene::parse_json(std::string_view(key).substr(begin), false), {}};
  if (!parts.settings.is_object()) return std::nullopt;
  if (const auto found = parts.settings.find(member); found != parts.settings.end()) {
    if (!found->is_string()) return std::nullopt;
    parts.misses = found->get<std::string>();
    parts.settings.erase(found);
  }
  return parts;
}

}  // namespace

reported_misses::reported_misses(std::vector<reported_miss> misses) : all_(std::move(misses)) {
  std::sort(all_.begin(), all_.end(), [](const reported_miss& a, const reported_miss& b) {
    return std::tie(a.eye.x, a.eye.y, a.eye.z, a.polygon) < std::tie(b.eye.x, b.eye.y, b.eye.z, b.polygon);
  });
  all_.erase(std::unique(all_.begin(), all_.end()), all_.end());
}

std::vector<std::uint32_t> reported_misses::in(const glm::vec3& min, const glm::vec3& max, float margin) const {
  const auto grow = static_cast<double>(margin);
  const auto before = [&](const reported_miss& miss, double x) { return static_cast<double>(miss.eye.x) < x; };
  std::vector<std::uint32_t> found;
  for (auto miss = std::lower_bound(all_.begin(), all_.end(), static_cast<double>(min.x) - grow, before);
       miss != all_.end() && holds(static_cast<double>(min.x), static_cast<double>(max.x), grow, miss->eye.x); ++miss) {
    bool inside = true;
    for (const glm::length_t axis : {1, 2})
      inside = inside && holds(static_cast<double>(min[axis]), static_cast<double>(max[axis]), grow, miss->eye[axis]);
    if (inside) found.push_back(static_cast<std::uint32_t>(miss - all_.begin()));
  }
  return found;
}

std::string reported_misses::key_of(const cell_blocks& blocks, std::span<const view_cell> cells, float margin) const {
  std::string text = fmt::format("{};", all_.size());
  if (all_.empty()) return text;
  for (std::uint32_t block = 0; block < blocks.count(); ++block) {
    std::vector<std::uint32_t> own;
    for (const std::uint32_t cell : blocks.cells_of(block)) {
      const std::vector<std::uint32_t> of_cell = in(cells[cell].min, cells[cell].max, margin);
      own.insert(own.end(), of_cell.begin(), of_cell.end());
    }
    if (own.empty()) continue;
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    XXH3_state_t* state = XXH3_createState();
    XXH3_64bits_reset(state);
    for (const std::uint32_t place : own) {
      const reported_miss& miss = all_[place];
      const float eye[3] = {miss.eye.x, miss.eye.y, miss.eye.z};
      XXH3_64bits_update(state, eye, sizeof eye);
      XXH3_64bits_update(state, &miss.polygon, sizeof miss.polygon);
    }
    text += fmt::format(" {}:{:016x}", block, XXH3_64bits_digest(state));
    XXH3_freeState(state);
  }
  return text;
}

std::string with_misses(const std::string& settings, const reported_misses& known, const std::string& value) {
  if (known.empty()) return settings;
  auto text = scene::parse_ordered_json(settings);
  text[member] = scene::parse_ordered_json(value);
  return text.dump();
}

std::optional<std::vector<std::uint32_t>> blocks_with_other_misses(const std::string& key, const std::string& other) {
  const std::optional<key_parts> a = parts_of(key), b = parts_of(other);
  if (!a || !b || a->words != b->words || a->settings != b->settings) return std::nullopt;
  const hashes_of_blocks of_a = blocks_in(a->misses), of_b = blocks_in(b->misses);
  std::vector<std::uint32_t> changed;
  const auto add_those_of = [&](const hashes_of_blocks& from, const hashes_of_blocks& to) {
    for (const auto& [block, hash] : from)
      if (const auto same = to.find(block); same == to.end() || same->second != hash) changed.push_back(block);
  };
  add_those_of(of_a, of_b);
  add_those_of(of_b, of_a);
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  return changed;
}

std::function<bool(std::uint32_t, cell_stage)> stale_records(const std::vector<std::uint32_t>& changed,
                                                             const cell_blocks& blocks) {
  std::vector<bool> is_changed(blocks.count());
  for (const std::uint32_t block : changed)
    if (block < is_changed.size()) is_changed[block] = true;
  return [&blocks, is_changed = std::move(is_changed)](std::uint32_t cell, cell_stage stage) {
    if (cell >= blocks.cell_count() || is_changed[blocks.block_of(cell)]) return true;
    if (stage != cell_stage::finished) return false;
    const auto around = blocks.neighbors_of(cell);
    return std::any_of(around.begin(), around.end(),
                       [&](std::uint32_t other) { return is_changed[blocks.block_of(other)]; });
  };
}

}  // namespace sightcell::bake
