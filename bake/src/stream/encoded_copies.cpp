#include "stream/encoded_copies.h"

#include <brotli/encode.h>
#include <zlib.h>

#include <algorithm>
#include <new>

namespace sightcell::bake {
namespace {

constexpr int gzip_format = 16;      // added to the window bits of zlib
constexpr int unknown_system = 255;  // so that no copy depends on where it was made
constexpr int brotli_window = 22;    // bits; browsers accept up to 24

std::vector<std::byte> gzip(std::span<const std::byte> file) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, MAX_WBITS + gzip_format, MAX_MEM_LEVEL,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  gz_header header{};  // without a name and a time
  header.os = unknown_system;
  deflateSetHeader(&stream, &header);
  std::vector<std::byte> out(deflateBound(&stream, file.size()));
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(file.data()));
  stream.avail_in = static_cast<uInt>(file.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const bool done = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  out.resize(done ? stream.total_out : 0);
  deflateEnd(&stream);
  return out;
}

std::vector<std::byte> brotli(std::span<const std::byte> file) {
  std::size_t size = BrotliEncoderMaxCompressedSize(file.size());
  std::vector<std::byte> out(size);
  const bool done = BrotliEncoderCompress(BROTLI_MAX_QUALITY, brotli_window, BROTLI_MODE_GENERIC, file.size(),
                                          reinterpret_cast<const std::uint8_t*>(file.data()), &size,
                                          reinterpret_cast<std::uint8_t*>(out.data())) == BROTLI_TRUE;
  out.resize(done ? size : 0);
  return out;
}

// The header fields of an encoded answer take 50 bytes, and the client has to decode it.
bool is_smaller_enough(std::size_t copy, std::size_t file) {
  return copy + 64 + file / 16 < file;
}

}  // namespace

std::vector<encoded_copy> encoded_copies(std::span<const std::byte> file, stream_copies which) {
  std::vector<encoded_copy> out;
  if (which == stream_copies::none) return out;
  out.push_back({copy_extensions[0], gzip(file)});
  if (which == stream_copies::gzip_and_brotli) out.push_back({copy_extensions[1], brotli(file)});
  for (encoded_copy& copy : out)
    if (!is_smaller_enough(copy.bytes.size(), file.size())) copy.bytes.clear();
  return out;
}

sent_bytes sent_with(const std::vector<encoded_copy>& copies, std::size_t file_bytes) {
  sent_bytes out{file_bytes, file_bytes};
  if (!copies.empty() && !copies[0].bytes.empty()) out.gzip = copies[0].bytes.size();
  out.brotli = out.gzip;
  if (copies.size() > 1 && !copies[1].bytes.empty())
    out.brotli = std::min<std::uint64_t>(out.gzip, copies[1].bytes.size());
  return out;
}

}  // namespace sightcell::bake
