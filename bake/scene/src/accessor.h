#pragma once
// Reads numbers from a buffer as a glTF accessor describes them. The caller has checked that all bytes exist; nothing
// here can read outside the spans.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::scene {

// Returns the bytes of a glTF component type, given by its number in the file; 0 for any other number.
std::size_t component_size(int component_type);

// An accessor whose bytes were checked.
struct accessor_view {
  std::span<const std::uint8_t> bytes;  // from the first element on; empty: all zero
  std::size_t count = 0;
  std::size_t stride = 0;  // bytes from one element to the next
  std::size_t width = 1;   // components per element
  int component_type = 0;
  bool normalized = false;
  // Sparse accessors: the elements at these indices are replaced by these tightly packed values.
  std::size_t sparse_count = 0;
  std::span<const std::uint8_t> sparse_indices;
  int sparse_index_type = 0;
  std::span<const std::uint8_t> sparse_values;
};

// Reads count * width numbers. Normalized integers become max(value / largest, -1), others their value. Returns false
// if a sparse index is not below count.
bool read_numbers(const accessor_view& view, std::vector<float>& out);
bool read_numbers(const accessor_view& view, std::vector<double>& out);

// Reads scalars of an unsigned type. Returns false for another type or a sparse index that is not below count.
bool read_indices(const accessor_view& view, std::vector<std::uint32_t>& out);

// Copies the elements unconverted, each to a multiple of `stride` bytes; bytes between them are 0. Returns false if a
// sparse index is not below count.
// stride: width components or more.
bool read_bytes(const accessor_view& view, std::size_t stride, std::vector<std::uint8_t>& out);

}  // namespace sightcell::scene
