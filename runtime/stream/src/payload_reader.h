#pragma once
// Reads the columns of a front or cell chunk (docs/streaming.md, "Numbers and columns"). After the first violation of
// the format all reads return 0, and ok() false.
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sightcell::streaming {

class payload_reader {
 public:
  explicit payload_reader(std::span<const std::uint8_t> bytes) noexcept : bytes_(bytes) {}

  [[nodiscard]] bool ok() const noexcept { return ok_; }
  // True if all was read, and nothing more.
  [[nodiscard]] bool is_finished() const noexcept { return ok_ && at_ == bytes_.size(); }

  // Fails if fewer than count elements of `least` bytes each can follow.
  // Returns count, or 0.
  std::uint32_t count_of(std::uint32_t count, std::uint32_t least) noexcept {
    if (std::uint64_t{count} * least > bytes_.size() - at_) fail();
    return ok_ ? count : 0;
  }
  void require(bool condition) noexcept {
    if (!condition) fail();
  }

  std::span<const std::uint8_t> bytes(std::uint64_t count) noexcept {
    if (count > bytes_.size() - at_) fail();
    if (!ok_) return {};
    const std::span<const std::uint8_t> out = bytes_.subspan(at_, static_cast<std::size_t>(count));
    at_ += out.size();
    return out;
  }
  std::uint8_t byte() noexcept {
    const std::span<const std::uint8_t> one = bytes(1);
    return one.empty() ? std::uint8_t{0} : one[0];
  }
  std::uint32_t varint() noexcept;
  std::uint32_t varint_below(std::uint32_t limit) noexcept {
    const std::uint32_t value = varint();
    require(value < limit);
    return ok_ ? value : 0;
  }

  // use(index, value), once per value.
  template <class Use>
  void varints(std::uint32_t count, const Use& use) noexcept {
    for (std::uint32_t i = 0; i < count && ok_; ++i) use(i, varint());
  }
  template <class Use>
  void deltas(std::uint32_t count, std::uint64_t limit, const Use& use) noexcept {
    std::int64_t value = 0;
    for (std::uint32_t i = 0; i < count && ok_; ++i) {
      const std::uint32_t code = varint();
      value += (code & 1u) != 0 ? -(std::int64_t{code} / 2 + 1) : std::int64_t{code / 2};
      require(value >= 0 && static_cast<std::uint64_t>(value) < limit);
      if (ok_) use(i, static_cast<std::uint32_t>(value));
    }
  }
  template <class Use>
  void gaps(std::uint32_t count, std::uint64_t limit, const Use& use) noexcept {
    std::uint64_t next = 0;
    for (std::uint32_t i = 0; i < count && ok_; ++i) {
      const std::uint64_t value = next + varint();
      require(value < limit);
      if (ok_) use(i, static_cast<std::uint32_t>(value));
      next = value + 1;
    }
  }
  template <class Use>
  void floats(std::uint32_t count, const Use& use) noexcept {
    const std::span<const std::uint8_t> planes = bytes(std::uint64_t{4} * count);
    if (!ok_) return;
    for (std::size_t i = 0; i < count; ++i) {
      std::uint32_t bits = 0;
      for (std::size_t plane = 4; plane-- > 0;) bits = bits << 8 | planes[plane * count + i];
      require((bits >> 23 & 0xFFu) != 0xFFu);  // finite
      use(static_cast<std::uint32_t>(i), ok_ ? std::bit_cast<float>(bits) : 0.0f);
    }
  }

 private:
  void fail() noexcept {
    ok_ = false;
    at_ = bytes_.size();
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

inline std::uint32_t payload_reader::varint() noexcept {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 35; shift += 7) {
    const std::uint8_t part = byte();
    value |= std::uint64_t{part & 0x7Fu} << shift;
    if (part < 0x80u) {
      require(value <= 0xFFFFFFFFu && (part != 0 || shift == 0));  // without needless bytes
      return ok_ ? static_cast<std::uint32_t>(value) : 0;
    }
  }
  fail();
  return 0;
}

}  // namespace sightcell::streaming
