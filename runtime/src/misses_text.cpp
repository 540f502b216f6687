#include "misses_text.h"

#include <array>
#include <cmath>
#include <string_view>

namespace sightcell::runtime {
namespace {

constexpr double most_meters = 1e9;
constexpr std::uint64_t per_meter = 1'000'000'000;

// Text that counts on beyond its room without being written. printf would depend on the locale, and to_chars of a
// double takes more code than the rest of the runtime.
class text_sink {
 public:
  explicit text_sink(std::span<char> room) noexcept : room_(room) {}

  void add(char c) noexcept {
    if (size_ < room_.size()) room_[size_] = c;
    ++size_;
  }
  void add(std::string_view text) noexcept {
    for (const char c : text) add(c);
  }
  void add_number(std::uint64_t value, int least_digits = 1) noexcept {
    std::array<char, 20> digits{};
    int count = 0;
    for (; value != 0 || count < least_digits; value /= 10)
      digits[static_cast<std::size_t>(count++)] = "0123456789"[value % 10];
    while (count > 0) add(digits[static_cast<std::size_t>(--count)]);
  }
  void add_meters(double meters) noexcept {
    const auto steps = static_cast<std::uint64_t>(std::abs(meters) * static_cast<double>(per_meter) + 0.5);
    if (meters < 0.0 && steps != 0) add('-');
    add_number(steps / per_meter);
    add('.');
    add_number(steps % per_meter, 9);
  }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  std::span<char> room_;
  std::size_t size_ = 0;
};

}  // namespace

bool can_be_written(const sightcell_miss& miss, std::uint32_t polygon_count) noexcept {
  bool near = miss.polygon < polygon_count;
  for (const double e : miss.eye) near = near && std::abs(e) <= most_meters;  // false for NaN
  return near;
}

std::size_t write_misses(std::span<const std::uint8_t, 16> scene_fingerprint, std::span<const sightcell_miss> misses,
                         std::span<char> dst) noexcept {
  text_sink text(dst);
  text.add("{\"scene_fingerprint\": \"");
  for (const std::uint8_t byte : scene_fingerprint) {
    text.add("0123456789abcdef"[byte >> 4]);
    text.add("0123456789abcdef"[byte & 15]);
  }
  text.add("\", \"misses\": [");
  for (const sightcell_miss& miss : misses) {
    text.add(&miss == misses.data() ? "\n" : ",\n");
    text.add("  {\"eye\": [");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (axis > 0) text.add(", ");
      text.add_meters(miss.eye[axis]);
    }
    text.add("], \"polygon\": ");
    text.add_number(miss.polygon);
    text.add('}');
  }
  text.add("\n]}\n");
  return text.size();
}

}  // namespace sightcell::runtime
