#pragma once
// Numbers as text.
#include <cstdint>
#include <string>

namespace viewer {

// 1234567 as "1,234,567".
std::string with_commas(std::uint64_t number);

}  // namespace viewer
