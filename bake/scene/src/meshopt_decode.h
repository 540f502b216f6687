#pragma once
// EXT_meshopt_compression: decodes the bytes of a buffer view.
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

// Returns count x stride bytes. Returns nothing, and the cause in why_not, if the stream is damaged, has another
// format, or claims more elements than its bytes can contain, which is checked before anything is allocated.
std::optional<std::vector<std::uint8_t>> decode_meshopt(const meshopt_stream& stream,
                                                        std::span<const std::uint8_t> bytes, std::string& why_not);

}  // namespace sightcell::scene
