#include "accessor.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

namespace sightcell::scene {
namespace {

// Calls f with a value of the C++ type of the component type, so that the inner loops are typed.
template <typename F>
void with_type(int component_type, F f) {
  switch (component_type) {
    case 5120:
      f(std::int8_t{});
      break;
    case 5121:
      f(std::uint8_t{});
      break;
    case 5122:
      f(std::int16_t{});
      break;
    case 5123:
      f(std::uint16_t{});
      break;
    case 5125:
      f(std::uint32_t{});
      break;
    case 5126:
      f(float{});
      break;
    default:
      break;
  }
}

template <typename Stored, typename Out>
Out converted(Stored value, bool normalized) {
  if constexpr (std::is_integral_v<Stored> && std::is_floating_point_v<Out>) {
    if (normalized) {
      return static_cast<Out>(
          std::max(static_cast<double>(value) / static_cast<double>(std::numeric_limits<Stored>::max()), -1.0));
    }
  }
  return static_cast<Out>(value);
}

template <typename Stored, typename Out>
void read_element(const std::uint8_t* from, std::size_t width, bool normalized, Out* to) {
  for (std::size_t i = 0; i < width; ++i) {
    Stored value;
    std::memcpy(&value, from + i * sizeof(Stored), sizeof(Stored));  // files need not be aligned
    to[i] = converted<Stored, Out>(value, normalized);
  }
}

template <typename Out>
bool read_all(const accessor_view& view, std::vector<Out>& out) {
  out.assign(view.count * view.width, Out{});
  bool fine = true;
  with_type(view.component_type, [&](auto sample) {
    using stored = decltype(sample);
    if (!view.bytes.empty()) {
      for (std::size_t i = 0; i < view.count; ++i) {
        read_element<stored>(view.bytes.data() + i * view.stride, view.width, view.normalized, &out[i * view.width]);
      }
    }
    with_type(view.sparse_index_type, [&](auto index_sample) {
      using index_type = decltype(index_sample);
      if constexpr (std::is_unsigned_v<index_type>) {
        const std::size_t packed = sizeof(stored) * view.width;
        for (std::size_t i = 0; i < view.sparse_count; ++i) {
          index_type at;
          std::memcpy(&at, view.sparse_indices.data() + i * sizeof(at), sizeof(at));
          if (at >= view.count) {
            fine = false;
            return;
          }
          read_element<stored>(view.sparse_values.data() + i * packed, view.width, view.normalized,
                               &out[std::size_t{at} * view.width]);
        }
      }
    });
  });
  return fine;
}

}  // namespace

std::size_t component_size(int component_type) {
  std::size_t size = 0;
  with_type(component_type, [&](auto sample) { size = sizeof(sample); });
  return size;
}

bool read_numbers(const accessor_view& view, std::vector<float>& out) {
  return read_all(view, out);
}

bool read_numbers(const accessor_view& view, std::vector<double>& out) {
  return read_all(view, out);
}

bool read_indices(const accessor_view& view, std::vector<std::uint32_t>& out) {
  // Signed and floating indices were rejected before. Converting a float here could be undefined behavior.
  if (view.component_type != 5121 && view.component_type != 5123 && view.component_type != 5125) return false;
  out.assign(view.count, 0);
  std::vector<double> wide;
  if (view.sparse_count != 0) {  // rare; doubles can represent every 32-bit index
    if (!read_all(view, wide)) return false;
    std::transform(wide.begin(), wide.end(), out.begin(), [](double v) { return static_cast<std::uint32_t>(v); });
    return true;
  }
  if (view.bytes.empty()) return true;
  with_type(view.component_type, [&](auto sample) {
    using stored = decltype(sample);
    if constexpr (std::is_unsigned_v<stored>) {
      for (std::size_t i = 0; i < view.count; ++i) {
        read_element<stored>(view.bytes.data() + i * view.stride, 1, false, &out[i]);
      }
    }
  });
  return true;
}

bool read_bytes(const accessor_view& view, std::size_t stride, std::vector<std::uint8_t>& out) {
  const std::size_t element = view.width * component_size(view.component_type);
  out.assign(view.count * stride, 0);
  if (!view.bytes.empty())
    for (std::size_t i = 0; i < view.count; ++i) std::memcpy(&out[i * stride], &view.bytes[i * view.stride], element);
  if (view.sparse_count == 0) return true;
  std::vector<std::uint32_t> places;
  if (!read_indices({.bytes = view.sparse_indices,
                     .count = view.sparse_count,
                     .stride = component_size(view.sparse_index_type),
                     .component_type = view.sparse_index_type,
                     .sparse_indices = {},
                     .sparse_values = {}},
                    places))
    return false;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] >= view.count) return false;
    std::memcpy(&out[places[i] * stride], &view.sparse_values[i * element], element);
  }
  return true;
}

}  // namespace sightcell::scene
