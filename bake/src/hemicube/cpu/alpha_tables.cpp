#include "hemicube/cpu/alpha_tables.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <limits>
#include <map>
#include <utility>

namespace sightcell::bake::cpu {
namespace {

// Each alpha of vertex colors needs counts of its own, so polygons with many alphas would fill the memory.
constexpr std::size_t most_counted = std::size_t{1} << 28;  // texels

// Appends the texels of a mask with a border, which has what a lookup beside the mask reads.
void add_with_border(const scene::alpha_mask& mask, std::vector<std::uint8_t>& texels) {
  const auto inside = [](std::uint32_t at, std::uint32_t size, scene::wrap mode) {  // at: from the border on
    if (at == 0) return mode == scene::wrap::repeat ? size - 1 : 0;
    if (at > size) return mode == scene::wrap::repeat ? 0 : size - 1;
    return at - 1;
  };
  const auto row = [&](std::uint32_t y) {
    return mask.texels.data() + std::size_t{inside(y, mask.height, mask.wrap_v)} * mask.width;
  };
  for (std::uint32_t y = 0; y <= mask.height; ++y)
    for (std::uint32_t x = 0; x < mask.width + 2; ++x) {
      const std::uint32_t column = inside(x, mask.width, mask.wrap_u);
      texels.push_back(row(y)[column]);
      texels.push_back(row(y + 1)[column]);
    }
}

// Returns the smallest number in 0 .. 255 that passes, to the last bit. Numbers above 255 do not occur but for
// rounding.
float threshold_of(float cutoff, float alpha) {
  const auto passes = [&](float number) { return number / 255.0f * alpha >= cutoff; };
  if (passes(0.0f)) return 0.0f;
  float fails = 0.0f, first = 256.0f;
  if (!passes(first)) return std::numeric_limits<float>::infinity();
  // Floats that are not negative are ordered as their bits are.
  while (std::bit_cast<std::uint32_t>(first) - std::bit_cast<std::uint32_t>(fails) > 1) {
    const auto middle =
        std::bit_cast<float>((std::bit_cast<std::uint32_t>(first) + std::bit_cast<std::uint32_t>(fails)) / 2);
    (passes(middle) ? first : fails) = middle;
  }
  return first;
}

// Appends the block counts of a test.
void count_blocks(alpha_test& test, const std::vector<std::uint8_t>& texels, std::vector<block_counts>& counts) {
  constexpr float rounding = 0.01f;  // of a lookup, in 1/255
  const std::uint32_t quads_x = test.width + 1, quads_y = test.height + 1;
  const std::size_t across = (quads_x + quads_per_block - 1) / quads_per_block,
                    up = (quads_y + quads_per_block - 1) / quads_per_block, stride = across + 1;
  test.first_count = static_cast<std::uint32_t>(counts.size());
  test.blocks_across = static_cast<std::uint32_t>(across);
  counts.resize(counts.size() + stride * (up + 1));
  block_counts* table = counts.data() + test.first_count;
  for (std::size_t by = 0; by < up; ++by)
    for (std::size_t bx = 0; bx < across; ++bx) {
      std::uint8_t least = 255, most = 0;
      const std::size_t end_x = std::min<std::size_t>((bx + 1) * quads_per_block, quads_x) + 1,
                        end_y = std::min<std::size_t>((by + 1) * quads_per_block, quads_y);
      for (std::size_t y = by * quads_per_block; y < end_y; ++y) {
        const auto row = texels.begin() + static_cast<std::ptrdiff_t>(test.first + 2 * y * (test.width + 2));
        const auto [low, high] = std::minmax_element(row + static_cast<std::ptrdiff_t>(2 * bx * quads_per_block),
                                                     row + static_cast<std::ptrdiff_t>(2 * end_x));
        least = std::min(least, *low);
        most = std::max(most, *high);
      }
      const block_counts &left = table[(by + 1) * stride + bx], &below = table[by * stride + bx + 1],
                         &both = table[by * stride + bx];
      const std::uint32_t may_pass = static_cast<float>(most) + rounding >= test.threshold ? 1 : 0,
                          may_fail = static_cast<float>(least) - rounding < test.threshold ? 1 : 0;
      table[(by + 1) * stride + bx + 1] = {left.may_pass + below.may_pass - both.may_pass + may_pass,
                                           left.may_fail + below.may_fail - both.may_fail + may_fail};
    }
}

}  // namespace

alpha_tables::alpha_tables(const scene::world_geometry& world) {
  std::vector<std::size_t> first_of;  // by mask: its first byte
  for (const scene::alpha_mask& mask : world.masks) {
    first_of.push_back(texels.size());
    add_with_border(mask, texels);
  }
  std::size_t counted = 0;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> test_of;  // by mask and bits of alpha
  for (const scene::masked_polygon& p : world.masked) {
    masked_triangle made{};
    for (std::size_t k = 0; k < 3; ++k) {
      made.u[k] = p.uvs[k].x;
      made.v[k] = p.uvs[k].y;
      made.alpha[k] = p.alphas[k];
    }
    // Infinity times a weight of zero is no number, so such an alpha is interpolated like one that varies.
    const bool varies = !(p.alphas[0] == p.alphas[1] && p.alphas[1] == p.alphas[2] && p.alphas[0] >= 0.0f &&
                          p.alphas[0] <= std::numeric_limits<float>::max());
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(varies ? -1.0f : p.alphas[0]);
    const auto [known, is_new] = test_of.try_emplace({p.mask, bits}, static_cast<std::uint32_t>(tests.size()));
    made.test = known->second;
    triangles.push_back(made);
    if (!is_new) continue;
    const scene::alpha_mask& mask = world.masks[p.mask];
    alpha_test test{first_of[p.mask], mask.width, mask.height, mask.cutoff, 0.0f, varies, mask.wrap_u, mask.wrap_v};
    if (!varies) {
      test.threshold = threshold_of(mask.cutoff, p.alphas[0]);
      if (mask.texels.size() <= most_counted - counted) {
        counted += mask.texels.size();
        count_blocks(test, texels, counts);
      }
    }
    tests.push_back(test);
  }
}

}  // namespace sightcell::bake::cpu
