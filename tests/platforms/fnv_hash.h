#pragma once
#include <cstdint>
#include <string_view>

namespace sightcell::test {

// FNV-1a of 64 bits, to compare the results of two platforms by one number.
class fnv_hash {
 public:
  void add(std::string_view text) noexcept {
    for (const char letter : text) add_byte(static_cast<unsigned char>(letter));
  }
  void add(std::uint32_t number) noexcept {
    for (unsigned shift = 0; shift < 32; shift += 8) add_byte(static_cast<unsigned char>(number >> shift & 0xFFu));
  }
  [[nodiscard]] std::uint64_t value() const noexcept { return value_; }

 private:
  void add_byte(unsigned char byte) noexcept { value_ = (value_ ^ byte) * 0x100000001B3u; }

  std::uint64_t value_ = 0xCBF29CE484222325u;
};

}  // namespace sightcell::test
