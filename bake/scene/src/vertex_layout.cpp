#include "vertex_layout.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gltf_numbers.h"

namespace sightcell::scene {
namespace {

bool fits_8_bits(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float v) {
    const float scaled = std::clamp(v, 0.0f, 1.0f) * 255.0f;
    return std::abs(scaled - std::round(scaled)) < 1e-3f;
  });
}

}  // namespace

vertex_layout layout_of(const attribute_values& values, std::size_t vertex_count) {
  vertex_stream numbers{stream_filter::exponential, 12, {{"POSITION", 3, 0, float_type, false}}};
  vertex_stream colors;
  std::vector<vertex_stream> directions;
  for (const auto& [name, list] : values) {
    const auto width = static_cast<std::uint32_t>(vertex_count == 0 ? 0 : list.size() / vertex_count);
    if (width == 0) continue;
    if (name == "NORMAL" || name == "TANGENT") {
      directions.push_back({stream_filter::octahedral, 4, {{name, width, 0, byte_type, true}}});
    } else if (name.starts_with("TEXCOORD_")) {
      numbers.attributes.push_back({name, width, numbers.stride, float_type, false});
      numbers.stride += 8;
    } else {
      const bool small = fits_8_bits(list);
      colors.attributes.push_back({name, 4, colors.stride, small ? unsigned_byte_type : unsigned_short_type, true});
      colors.stride += small ? 4 : 8;
    }
  }
  vertex_layout out{std::move(numbers)};
  out.insert(out.end(), directions.begin(), directions.end());
  if (colors.stride > 0) out.push_back(std::move(colors));
  return out;
}

}  // namespace sightcell::scene
