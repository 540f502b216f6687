#include "sightcell/scene/opacity_maps.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "sightcell/scene/alpha_mask.h"
#include "sightcell/scene/scene.h"

namespace sightcell::scene {
namespace {

constexpr std::size_t most_parts = std::size_t{1} << 25;
constexpr std::uint32_t widest_side = 32;
constexpr double texels_per_piece = 2.0;  // of an edge
constexpr float rounding = 1e-4f;         // of alpha times factor
constexpr float largest_factor = 16.0f;
// Texels that are counted: of one mask, so that the table fits into 128 MB, and of all, because each vertex alpha needs
// a table of its own. Nothing is known of the rest.
constexpr std::size_t most_texels = std::size_t{1} << 24, most_counted = std::size_t{1} << 28;

using uv_triangle = std::array<glm::dvec2, 3>;

// The texels from first to last on one axis of a mask, modulo its size; both included.
struct texel_range {
  std::int64_t first = 0, last = 0;
};

// Counts the texels of a rectangle that pass or fail the test (summed-area table: Crow 1984).
class texel_counts {
 public:
  // factor: alpha of the vertex colors.
  texel_counts(const alpha_mask& mask, float factor)
      : mask_(mask), sums_((std::size_t{mask.width} + 1) * (mask.height + 1)) {
    const std::size_t stride = std::size_t{mask.width} + 1;
    for (std::uint32_t y = 0; y < mask.height; ++y) {
      counts row;
      for (std::uint32_t x = 0; x < mask.width; ++x) {
        const float alpha = static_cast<float>(mask.texels[std::size_t{y} * mask.width + x]) / 255.0f * factor;
        row.passing += alpha >= mask.cutoff + rounding ? 1 : 0;
        row.failing += alpha < mask.cutoff - rounding ? 1 : 0;
        const counts& above = sums_[y * stride + x + 1];
        sums_[(y + 1) * stride + x + 1] = {above.passing + row.passing, above.failing + row.failing};
      }
    }
  }

  // Returns what all bilinear lookups in the bounding box of a triangle of texture coordinates have in common.
  opacity in_box(const uv_triangle& t) const {
    const glm::dvec2 low = glm::min(glm::min(t[0], t[1]), t[2]), high = glm::max(glm::max(t[0], t[1]), t[2]);
    const texel_range x = texels_of(low.x, high.x, mask_.width, mask_.wrap_u),
                      y = texels_of(low.y, high.y, mask_.height, mask_.wrap_v);
    std::uint64_t passing = 0, failing = 0;
    for (const auto& [x0, x1] : pieces_of(x, mask_.width))
      for (const auto& [y0, y1] : pieces_of(y, mask_.height)) {
        const counts found = in_rectangle(x0, y0, x1, y1);
        passing += found.passing, failing += found.failing;
      }
    const auto all = static_cast<std::uint64_t>((x.last - x.first + 1) * (y.last - y.first + 1));
    return passing == all ? opacity::passes : failing == all ? opacity::fails : opacity::unknown;
  }

 private:
  struct counts {
    std::uint32_t passing = 0, failing = 0;
  };
  using piece = std::pair<std::uint32_t, std::uint32_t>;  // from the first to before the second

  // Returns the texels that lookups between two coordinates read on one axis.
  static texel_range texels_of(double low, double high, std::uint32_t texels, wrap mode) {
    const auto size = static_cast<double>(texels);
    // Single precision in the lookup.
    const double margin = 0.01 + (std::abs(low) + std::abs(high)) * size * 1e-6;
    if (mode == wrap::mirror) std::tie(low, high) = unmirrored(low, high);
    if (mode != wrap::repeat) low = std::clamp(low, 0.0, 1.0), high = std::clamp(high, 0.0, 1.0);
    const double first = std::floor(low * size - 0.5 - margin), last = std::floor(high * size - 0.5 + margin) + 1.0;
    const auto most = static_cast<std::int64_t>(texels) - 1;
    if (!(last - first < size)) return {0, most};
    const texel_range range{static_cast<std::int64_t>(first), static_cast<std::int64_t>(last)};
    if (mode == wrap::repeat) return range;
    return {std::clamp<std::int64_t>(range.first, 0, most), std::clamp<std::int64_t>(range.last, 0, most)};
  }

  // Folds an interval of mirrored coordinates into 0 .. 1. May return more than its image.
  static std::pair<double, double> unmirrored(double low, double high) {
    const double turn = std::floor(high);
    if (low >= turn) {
      const bool reversed = std::fmod(turn, 2.0) != 0.0;
      return reversed ? std::pair(turn + 1.0 - high, turn + 1.0 - low) : std::pair(low - turn, high - turn);
    }
    const double fold = std::fmod(turn, 2.0) == 0.0 ? 0.0 : 1.0, reach = std::max(turn - low, high - turn);
    return {fold - reach, fold + reach};
  }

  // Returns the one or two pieces of the mask that a range covers.
  static std::vector<piece> pieces_of(const texel_range& range, std::uint32_t texels) {
    const auto size = static_cast<std::int64_t>(texels);
    const auto first = static_cast<std::uint32_t>((range.first % size + size) % size);
    const auto count = static_cast<std::uint32_t>(range.last - range.first + 1);
    if (first + count <= texels) return {{first, first + count}};
    return {{first, texels}, {0, first + count - texels}};
  }

  counts in_rectangle(std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) const {
    const auto upto = [&](std::uint32_t x, std::uint32_t y) -> const counts& {
      return sums_[std::size_t{y} * (mask_.width + 1) + x];
    };
    const counts &a = upto(x0, y0), &b = upto(x1, y0), &c = upto(x0, y1), &d = upto(x1, y1);
    return {d.passing - b.passing - c.passing + a.passing, d.failing - b.failing - c.failing + a.failing};
  }

  const alpha_mask& mask_;
  std::vector<counts> sums_;
};

// Whether the counts of one factor hold for the whole polygon.
bool has_one_factor(const masked_polygon& p) {
  return p.alphas[0] == p.alphas[1] && p.alphas[1] == p.alphas[2] && p.alphas[0] >= 0.0f &&
         p.alphas[0] <= largest_factor;
}

uv_triangle uvs_of(const masked_polygon& p) {
  return {glm::dvec2(p.uvs[0]), glm::dvec2(p.uvs[1]), glm::dvec2(p.uvs[2])};
}

// Returns the side of a map whose parts are a few texels wide.
std::uint32_t side_for(const masked_polygon& p, const alpha_mask& mask, std::uint32_t most) {
  const glm::dvec2 size(mask.width, mask.height);
  const uv_triangle t = uvs_of(p);
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec2 edge = (t[(k + 1) % 3] - t[k]) * size;
    longest = std::max({longest, std::abs(edge.x), std::abs(edge.y)});
  }
  const double pieces = std::min(longest / texels_per_piece, static_cast<double>(most));
  return std::min(std::bit_ceil(static_cast<std::uint32_t>(pieces) + 1), most);
}

auto key_of(const masked_polygon& p) {
  const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
  return std::array{p.mask,           bits(p.alphas[0]), bits(p.alphas[1]), bits(p.alphas[2]), bits(p.uvs[0].x),
                    bits(p.uvs[0].y), bits(p.uvs[1].x),  bits(p.uvs[1].y),  bits(p.uvs[2].x),  bits(p.uvs[2].y)};
}

// Fills the parts of a map. Returns what all of them have in common.
opacity fill(const texel_counts& counts, const uv_triangle& t, std::uint32_t side, std::span<opacity> parts) {
  const auto corner = [&](std::uint32_t u, std::uint32_t v) {
    return t[0] + (t[1] - t[0]) * (static_cast<double>(u) / side) + (t[2] - t[0]) * (static_cast<double>(v) / side);
  };
  std::optional<opacity> common;
  const auto note = [&](opacity part, std::size_t at) {
    parts[at] = part;
    common = !common || *common == part ? part : opacity::unknown;
  };
  for (std::uint32_t v = 0; v < side; ++v)
    for (std::uint32_t u = 0; u + v < side; ++u) {
      const std::size_t at = 2 * (std::size_t{v} * side + u);
      note(counts.in_box({corner(u, v), corner(u + 1, v), corner(u, v + 1)}), at);
      if (u + v + 1 < side) note(counts.in_box({corner(u + 1, v + 1), corner(u + 1, v), corner(u, v + 1)}), at + 1);
    }
  return common.value_or(opacity::unknown);
}

// Classifies a polygon, and its parts where it has to be divided.
void add_parts(const texel_counts& counts, const uv_triangle& t, std::size_t side, opacity_map& map,
               std::vector<opacity>& parts) {
  map.whole = counts.in_box(t);
  if (map.whole != opacity::unknown || side < 2 || parts.size() + 2 * side * side > most_parts) return;
  map.first = static_cast<std::uint32_t>(parts.size());
  parts.resize(parts.size() + 2 * side * side);
  map.whole = fill(counts, t, static_cast<std::uint32_t>(side), std::span(parts).subspan(map.first));
  if (map.whole == opacity::unknown)
    map.side = static_cast<std::uint32_t>(side);
  else
    parts.resize(map.first);
}

}  // namespace

opacity opacity_maps::at(std::size_t masked, float u, float v) const {
  if (map_of.empty() || !(u >= 0.0f && v >= 0.0f && u + v <= 1.0f)) return opacity::unknown;
  const opacity_map& map = maps[map_of[masked]];
  if (map.side == 0) return map.whole;
  const float across = u * static_cast<float>(map.side), up = v * static_cast<float>(map.side);
  const auto column = std::min(static_cast<std::uint32_t>(across), map.side - 1),
             row = std::min(static_cast<std::uint32_t>(up), map.side - 1);
  const bool beyond = (across - static_cast<float>(column)) + (up - static_cast<float>(row)) > 1.0f;
  return parts[map.first + 2 * (row * map.side + column) + (beyond ? 1 : 0)];
}

std::size_t opacity_maps::bytes() const {
  return map_of.size() * sizeof(std::uint32_t) + maps.size() * sizeof(opacity_map) + parts.size();
}

opacity_maps make_opacity_maps(std::span<const masked_polygon> polygons, std::span<const alpha_mask> masks) {
  // Polygons with one key become neighbors, and those of one mask and factor too, so that one table of counts exists at
  // a time.
  std::vector<std::uint32_t> order(polygons.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return key_of(polygons[a]) < key_of(polygons[b]); });
  opacity_maps made;
  made.map_of.resize(polygons.size());
  std::vector<std::uint32_t> example;  // by map: one of its polygons
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || key_of(polygons[order[i]]) != key_of(polygons[order[i - 1]])) example.push_back(order[i]);
    made.map_of[order[i]] = static_cast<std::uint32_t>(example.size() - 1);
  }
  const auto side_of = [&](std::uint32_t i, std::uint32_t most) -> std::size_t {
    return side_for(polygons[i], masks[polygons[i].mask], most);
  };
  std::uint32_t most = widest_side;
  const auto all_parts = [&] {
    std::size_t parts = 0;
    for (const std::uint32_t i : example) parts += 2 * side_of(i, most) * side_of(i, most);
    return parts;
  };
  while (most > 1 && all_parts() > most_parts) most /= 2;

  std::optional<texel_counts> counts;
  std::size_t counted = 0;
  const masked_polygon* before = nullptr;  // for which the texels were counted
  for (const std::uint32_t i : example) {
    const masked_polygon& p = polygons[i];
    const std::size_t texels = masks[p.mask].texels.size();
    opacity_map& map = made.maps.emplace_back();
    if (!has_one_factor(p) || texels > most_texels) continue;
    if (before == nullptr || before->mask != p.mask || before->alphas != p.alphas) {
      counts.reset();
      before = nullptr;
      if (counted + texels > most_counted) continue;
      counts.emplace(masks[p.mask], p.alphas[0]);
      counted += texels;
      before = &p;
    }
    add_parts(*counts, uvs_of(p), side_of(i, most), map, made.parts);
  }
  return made;
}

}  // namespace sightcell::scene
