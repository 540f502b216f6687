#pragma once
// EXT_meshopt_compression: the bytes of a buffer view out of its compressed ones.
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace sightcell::scene {

struct meshopt_stream {
  std::string mode;    // ATTRIBUTES, TRIANGLES or INDICES
  std::string filter;  // NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL
  std::uint64_t count = 0, stride = 0;
};

// count x stride bytes. Nothing, and why, when the stream is broken, is no such stream, or claims more elements than
// its bytes can hold; that is asked before anything is allocated.
std::optional<std::vector<std::uint8_t>> decode_meshopt(const meshopt_stream& stream,
                                                        std::span<const std::uint8_t> bytes, std::string& why_not);

}  // namespace sightcell::scene
