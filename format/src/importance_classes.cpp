#include "sightcell/format/importance_classes.h"

#include <algorithm>
#include <limits>

#include "bit_reader.h"
#include "checked_reader.h"
#include "checksum.h"
#include "code_table.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

constexpr std::size_t checksum_size = 4;  // at the begin of the section

}  // namespace

// Accepts short codes only, so that one lookup in a small table decodes each.
bool importance_classes::read_code(std::span<const std::byte>& bytes, std::uint32_t symbols,
                                   code_entries& entries) noexcept {
  symbol_lengths lengths{};
  prefix_code code;
  if (!read_code_lengths(bytes, lengths)) return false;
  for (std::uint32_t symbol = 0; symbol < symbol_count; ++symbol) {
    if (lengths[symbol] > (symbol < symbols ? longest_code : 0)) return false;
  }
  if (!code.assign(lengths)) return false;
  code.for_each([&](std::uint32_t symbol, std::uint32_t bits, unsigned length) {
    for (std::size_t at = bits; at < entries.size(); at += std::size_t{1} << length) {
      entries[at] = static_cast<std::uint16_t>(length << 8 | symbol);
    }
  });
  return true;
}

bool importance_classes::read_codes(std::span<const std::byte>& bytes) noexcept {
  for (code_entries& entries : codes_) {
    if (!read_code(bytes, importance_class_count, entries)) return false;
  }
  return read_code(bytes, symbol_count, runs_);
}

status importance_classes::open(std::span<const std::byte> bytes, const chunk_borders& chunks,
                                importance_classes& out) noexcept {
  const std::size_t directory = chunks.chunks() * std::size_t{layout::chunk_record_size};
  if (bytes.size() < checksum_size || directory > bytes.size() - checksum_size) return status::corrupt;
  importance_classes made;
  made.borders_ = chunks;
  made.directory_ = bytes.subspan(checksum_size, directory);
  made.chunks_ = bytes.subspan(checksum_size + directory);
  if (!made.read_codes(made.chunks_)) return status::corrupt;
  std::uint32_t stored = 0;
  const std::size_t front = bytes.size() - made.chunks_.size();
  if (!checked_reader(bytes).read_u32(0, stored)) return status::corrupt;
  if (crc32c(bytes.first(front).subspan(checksum_size)) != stored) return status::checksum;
  // Chunks follow each other and fill the section.
  std::uint64_t next = 0;
  for (std::uint32_t chunk = 0; chunk < chunks.chunks(); ++chunk) {
    std::span<const std::byte> where;
    std::uint32_t unused = 0;
    std::uint64_t offset = 0;
    if (!made.bytes_of(chunk, where, unused)) return status::corrupt;
    if (!checked_reader(made.directory_).read_u64(chunk * layout::chunk_record_size, offset)) return status::corrupt;
    if (offset != next) return status::corrupt;
    next += where.size();
  }
  if (next != made.chunks_.size()) return status::corrupt;
  out = made;
  return status::ok;
}

bool importance_classes::bytes_of(std::uint32_t chunk, std::span<const std::byte>& out,
                                  std::uint32_t& checksum) const noexcept {
  const checked_reader in(directory_);
  const std::uint64_t at = chunk * layout::chunk_record_size;
  std::uint64_t offset = 0;
  std::uint32_t size = 0;
  if (!in.read_u64(at, offset) || !in.read_u32(at + 8, size) || !in.read_u32(at + 12, checksum)) return false;
  if (offset > chunks_.size() || size > chunks_.size() - offset) return false;
  out = chunks_.subspan(static_cast<std::size_t>(offset), size);
  return true;
}

status importance_classes::check_chunk(std::uint32_t chunk) const noexcept {
  if (chunk >= borders_.chunks()) return status::argument;
  std::span<const std::byte> bytes;
  std::uint32_t stored = 0;
  if (!bytes_of(chunk, bytes, stored)) return status::corrupt;
  return crc32c(bytes) == stored ? status::ok : status::checksum;
}

status importance_classes::decode(std::uint32_t cell, std::span<std::uint8_t> out) const noexcept {
  if (out.size() > std::numeric_limits<std::uint32_t>::max()) return status::corrupt;
  std::uint8_t* next = out.data();
  const class_sink write = [](void* user, std::uint8_t one, std::uint32_t count) noexcept {
    auto& at = *static_cast<std::uint8_t**>(user);
    at = std::fill_n(at, count, one);
  };
  return decode(cell, static_cast<std::uint32_t>(out.size()), write, &next);
}

// Where the classes of the cells before end need not be tested: each cell's classes end where the next one's begin.
status importance_classes::decode(std::uint32_t cell, std::uint32_t polygons, class_sink sink,
                                  void* user) const noexcept {
  if (cell >= borders_.cells()) return status::argument;
  const cell_chunk chunk = borders_.chunk_of(cell);
  const std::uint32_t place = cell - chunk.first_cell;
  std::span<const std::byte> bytes;
  std::uint32_t unused = 0;
  if (!bytes_of(chunk.number, bytes, unused) || bytes.size() < bit_reader::padding) return status::corrupt;
  bit_reader table(bytes);
  const std::uint32_t width = table.take(8);
  const std::uint64_t table_size = 1 + (std::uint64_t{width} * chunk.cells + 7) / 8;
  if (width > 32 || table_size > bytes.size() - bit_reader::padding) return status::corrupt;
  const std::span<const std::byte> classes = bytes.subspan(static_cast<std::size_t>(table_size));
  table.seek(8 + std::uint64_t{place} * width);
  const std::uint64_t begin = table.take(width);
  const std::uint64_t end = place + 1 < chunk.cells ? table.take(width) : classes.size() - bit_reader::padding;
  if (begin > end || end > classes.size() - bit_reader::padding || (place == 0 && begin != 0)) return status::corrupt;

  bit_reader in(classes);
  in.seek(8 * begin);
  const auto symbol_by = [&in](const code_entries& code, std::uint32_t& symbol) noexcept {
    const std::uint16_t entry = code[static_cast<std::size_t>(in.peek() & (code.size() - 1))];
    in.skip(entry >> 8);
    symbol = entry & 0xFFu;
    return entry != 0;
  };
  std::uint32_t before = least_important;
  for (std::uint32_t i = 0; i < polygons;) {
    std::uint32_t one = 0;
    std::uint64_t count = 1;
    if (!symbol_by(codes_[before], one)) return status::corrupt;
    if (one == least_important) {
      std::uint32_t symbol = 0;
      if ((before == one && i > 0) || !symbol_by(runs_, symbol)) return status::corrupt;
      count += base_of(symbol) + in.take(raw_bits_of(symbol));
    }
    if (count > polygons - i) return status::corrupt;
    sink(user, static_cast<std::uint8_t>(one), static_cast<std::uint32_t>(count));
    i += static_cast<std::uint32_t>(count);
    before = one;
  }
  return (in.place() + 7) / 8 == end ? status::ok : status::corrupt;
}

}  // namespace sightcell::format
