#pragma once
// CRC-32C (Castagnoli): reflected polynomial 0x82F63B78, start and final xor 0xFFFFFFFF.
#include <cstddef>
#include <cstdint>
#include <span>

namespace sightcell::format {

// crc32c of "123456789" is 0xE3069283. Allocates nothing; any thread.
std::uint32_t crc32c(std::span<const std::byte> bytes) noexcept;

}  // namespace sightcell::format
