#include "stream/payload.h"

#include <sha2.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <new>

namespace sightcell::bake {

void payload::put_bytes(std::span<const std::uint8_t> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

void payload::put_u32(std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes_.push_back(static_cast<std::uint8_t>(value >> shift));
}

void payload::put_varint(std::uint32_t value) {
  for (; value > 0x7F; value >>= 7) bytes_.push_back(static_cast<std::uint8_t>(value | 0x80u));
  bytes_.push_back(static_cast<std::uint8_t>(value));
}

void payload::put_varints(std::span<const std::uint32_t> values) {
  for (const std::uint32_t value : values) put_varint(value);
}

void payload::put_deltas(std::span<const std::uint32_t> values) {
  std::int64_t before = 0;
  for (const std::uint32_t value : values) {
    const std::int64_t difference = std::int64_t{value} - before;
    put_varint(static_cast<std::uint32_t>(difference >= 0 ? 2 * difference : -2 * difference - 1));
    before = value;
  }
}

void payload::put_gaps(std::span<const std::uint32_t> values) {
  for (std::size_t i = 0; i < values.size(); ++i) put_varint(i == 0 ? values[0] : values[i] - values[i - 1] - 1);
}

void payload::put_floats(std::span<const float> values) {
  for (int shift = 0; shift < 32; shift += 8)
    for (const float value : values)
      bytes_.push_back(static_cast<std::uint8_t>(std::bit_cast<std::uint32_t>(value) >> shift));
}

std::vector<std::uint8_t> deflated(std::span<const std::uint8_t> bytes) {
  uLongf size = compressBound(bytes.size());
  std::vector<std::uint8_t> out(size);
  if (compress2(out.data(), &size, bytes.data(), bytes.size(), Z_BEST_COMPRESSION) != Z_OK) throw std::bad_alloc();
  out.resize(size);
  return out;
}

content_name name_of(std::span<const std::byte> file) {
  SHA2_CTX context;
  SHA256Init(&context);
  SHA256Update(&context, reinterpret_cast<const std::uint8_t*>(file.data()), file.size());
  std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest;
  SHA256Final(digest.data(), &context);
  content_name out;
  std::copy_n(digest.begin(), out.size(), out.begin());
  return out;
}

}  // namespace sightcell::bake
