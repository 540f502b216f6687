#pragma once
// Numbers as people read them.
#include <array>
#include <cstdint>
#include <string>

namespace sightcell::cli {

std::string grouped(std::uint64_t number);  // 1,234,567
std::string hex(const std::array<std::uint8_t, 16>& bytes);
std::string size_text(double bytes);        // 130 KB, 1.4 MB
std::string duration_text(double seconds);  // 42 s, 3 min 05 s, 2 h 10 min

}  // namespace sightcell::cli
