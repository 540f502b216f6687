#include "inflated.h"

#include <sha2.h>
#include <zlib.h>

#include <algorithm>
#include <limits>

namespace sightcell::streaming {
namespace {

// zlib releases blocks without their size, so each block begins with it.
constexpr std::uint64_t head = std::max<std::uint64_t>(runtime::block_alignment, sizeof(std::uint64_t));

void* zlib_alloc(void* user, unsigned count, unsigned size) {
  const std::uint64_t bytes = head + std::uint64_t{count} * size;
  void* const block = runtime::allocate(*static_cast<const sightcell_allocator*>(user), bytes);
  if (block == nullptr) return nullptr;
  *static_cast<std::uint64_t*>(block) = bytes;
  return static_cast<std::byte*>(block) + head;
}

void zlib_release(void* user, void* address) {
  void* const block = static_cast<std::byte*>(address) - head;
  runtime::release(*static_cast<const sightcell_allocator*>(user), block, *static_cast<std::uint64_t*>(block));
}

}  // namespace

content_hash hash_of(std::span<const std::uint8_t> file) noexcept {
  SHA2_CTX context;
  SHA256Init(&context);
  SHA256Update(&context, file.data(), file.size());
  std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest;
  SHA256Final(digest.data(), &context);
  content_hash out;
  std::copy_n(digest.begin(), out.size(), out.begin());
  return out;
}

sightcell_status inflated::read(std::span<const std::uint8_t> stream, std::uint32_t size) noexcept {
  constexpr std::uint64_t most_expansion = 1032;  // of deflate: a larger claim is a lie, and would cost memory
  if (size == 0 || size > most_expansion * stream.size() || stream.size() > std::numeric_limits<unsigned>::max())
    return SIGHTCELL_ERR_CORRUPT;
  block_ = runtime::allocate(mem_, size);
  if (block_ == nullptr) return SIGHTCELL_ERR_MEMORY;
  size_ = size;
  sightcell_allocator mem = mem_;
  z_stream z{};
  z.zalloc = zlib_alloc, z.zfree = zlib_release, z.opaque = &mem;
  z.next_in = const_cast<std::uint8_t*>(stream.data());  // zlib does not write to it
  z.avail_in = static_cast<unsigned>(stream.size());
  z.next_out = static_cast<std::uint8_t*>(block_);
  z.avail_out = size;
  if (inflateInit(&z) != Z_OK) return SIGHTCELL_ERR_MEMORY;
  const int result = inflate(&z, Z_FINISH);
  inflateEnd(&z);
  if (result == Z_MEM_ERROR) return SIGHTCELL_ERR_MEMORY;
  return result == Z_STREAM_END && z.avail_in == 0 && z.avail_out == 0 ? SIGHTCELL_OK : SIGHTCELL_ERR_CORRUPT;
}

}  // namespace sightcell::streaming
