#pragma once
// Compressed copies of a file, which a static server sends in its place with Content-Encoding.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/bake/stream.h"

namespace sightcell::bake {

constexpr std::array<const char*, 2> copy_extensions = {".gz", ".br"};  // after the name of the file

struct encoded_copy {
  const char* extension = "";    // one of these
  std::vector<std::byte> bytes;  // empty: the copy would not be smaller enough
};

// Returns the copies that the setting asks for, gzip first. Same bytes: same copies, with the same libraries.
std::vector<encoded_copy> encoded_copies(std::span<const std::byte> file, stream_copies which);

// Returns the bytes that a server sends to a client that accepts what these copies have.
sent_bytes sent_with(const std::vector<encoded_copy>& copies, std::size_t file_bytes);

}  // namespace sightcell::bake
