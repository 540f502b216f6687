#include "sightcell/format/importance_writer.h"

#include <array>
#include <bit>
#include <new>
#include <optional>
#include <stdexcept>

#include "bit_reader.h"
#include "bit_sink.h"
#include "byte_sink.h"
#include "checksum.h"
#include "code_lengths.h"
#include "code_table_writer.h"
#include "last_section.h"
#include "prefix_code.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"

namespace sightcell::format {
namespace {

// One code.
struct symbol_coder {
  symbol_counts counts{};
  symbol_lengths lengths{};
  std::array<std::uint32_t, symbol_count> codes{};

  void make_codes() {
    lengths = best_lengths(counts, importance_classes::longest_code);
    prefix_code code;
    if (!code.assign(lengths)) return;
    code.for_each([&](std::uint32_t symbol, std::uint32_t bits, unsigned) { codes[symbol] = bits; });
  }
  void put(const number_symbol& n, bit_sink& bits) const {
    bits.put(codes[n.symbol], lengths[n.symbol]);
    bits.put(n.raw, n.raw_bits);
  }
};

// The codes of the classes, by the class before, and of the lengths of runs of the last class: half of all polygons are
// in it, in long runs, of which each polygon would take a bit.
struct class_coder {
  std::array<symbol_coder, importance_class_count> by_class;
  symbol_coder runs;

  // Calls use(code, number) for everything that is encoded.
  template <class Coder, class Use>
  static void for_each_number(Coder& coder, std::span<const std::uint8_t> classes, const Use& use) {
    std::uint8_t before = least_important;
    for (std::size_t i = 0; i < classes.size();) {
      const std::uint8_t one = classes[i++];
      use(coder.by_class[before], number_symbol{one, 0, 0});
      before = one;
      if (one != least_important) continue;
      const std::size_t first = i;
      while (i < classes.size() && classes[i] == least_important) ++i;
      use(coder.runs, symbol_of(static_cast<std::uint32_t>(i - first)));
    }
  }

  void count(std::span<const std::uint8_t> classes) {
    for_each_number(*this, classes, [](symbol_coder& code, const number_symbol& n) { ++code.counts[n.symbol]; });
  }

  // Everything that will be encoded must have been counted.
  void make_codes() {
    for (symbol_coder& code : by_class) code.make_codes();
    runs.make_codes();
  }

  void encode(std::span<const std::uint8_t> classes, std::vector<std::byte>& out) const {
    bit_sink bits(out);
    for_each_number(*this, classes, [&](const symbol_coder& code, const number_symbol& n) { code.put(n, bits); });
    bits.align();
  }
};

// Gets the classes of each cell and checks that there is one per polygon of the set.
class checked_classes {
 public:
  explicit checked_classes(const importance_source& source) : source_(source) {}

  status count_polygons(set_reader& sets) {
    polygons_.resize(sets.file().cell_count());
    for (std::uint32_t cell = 0; cell < polygons_.size(); ++cell) {
      std::span<const run> runs;
      if (const status s = sets.runs(cell, runs); s != status::ok) return s;
      for (const run& r : runs) polygons_[cell] += r.count;
    }
    return status::ok;
  }

  [[nodiscard]] std::uint32_t cells() const { return static_cast<std::uint32_t>(polygons_.size()); }

  status get(std::uint32_t cell) {
    classes_.clear();
    if (const status s = source_.get(cell, classes_); s != status::ok) return s;
    if (classes_.size() != polygons_[cell]) return status::argument;
    for (const std::uint8_t one : classes_) {
      if (one >= importance_class_count) return status::argument;
    }
    return status::ok;
  }
  [[nodiscard]] std::span<const std::uint8_t> classes() const { return classes_; }

 private:
  const importance_source& source_;
  std::vector<std::uint32_t> polygons_;
  std::vector<std::uint8_t> classes_;
};

// Writes where the classes of each cell begin, in as few bits as possible, then the classes.
void put_chunk(std::span<const std::uint32_t> begins, std::span<const std::byte> classes, std::vector<std::byte>& out) {
  const auto width = static_cast<unsigned>(std::bit_width(begins.back()));
  bit_sink bits(out);
  bits.put(width, 8);
  for (const std::uint32_t begin : begins) bits.put(begin, width);
  bits.align();
  out.insert(out.end(), classes.begin(), classes.end());
  out.insert(out.end(), bit_reader::padding, std::byte{0});
}

status encode_chunks(const chunk_borders& borders, checked_classes& classes, const class_coder& coder,
                     std::vector<std::byte>& directory, std::vector<std::byte>& chunks) {
  byte_sink records(directory);
  std::vector<std::byte> chunk;
  std::vector<std::uint32_t> begins;
  for (std::uint32_t first = 0; first < borders.cells();) {
    const std::uint32_t end = borders.chunk_of(first).end();
    chunk.clear();
    begins.clear();
    for (std::uint32_t cell = first; cell < end; ++cell) {
      begins.push_back(static_cast<std::uint32_t>(chunk.size()));
      if (const status s = classes.get(cell); s != status::ok) return s;
      coder.encode(classes.classes(), chunk);
      if (chunk.size() > layout::max_chunk_size / 2) return status::limit;
    }
    const std::size_t begin = chunks.size();
    put_chunk(begins, chunk, chunks);
    records.put_u64(begin);
    records.put_u32(static_cast<std::uint32_t>(chunks.size() - begin));
    records.put_u32(crc32c(std::span(chunks).subspan(begin)));
    first = end;
  }
  return status::ok;
}

status encode_section(const reader& file, const importance_source& source, std::vector<std::byte>& section) {
  set_reader sets;
  if (const status s = sets.open(file); s != status::ok) return s;
  checked_classes classes(source);
  if (const status s = classes.count_polygons(sets); s != status::ok) return s;
  class_coder coder;
  for (std::uint32_t cell = 0; cell < classes.cells(); ++cell) {
    if (const status s = classes.get(cell); s != status::ok) return s;
    coder.count(classes.classes());
  }
  coder.make_codes();
  std::vector<std::byte> front;
  std::vector<std::byte> chunks;
  if (const status s = encode_chunks(file.chunks(), classes, coder, front, chunks); s != status::ok) return s;
  for (const symbol_coder& code : coder.by_class) put_code_lengths(code.lengths, front);
  put_code_lengths(coder.runs.lengths, front);
  section.reserve(section.size() + 4 + front.size() + chunks.size());
  byte_sink out(section);
  out.put_u32(crc32c(front));
  out.put_bytes(front);
  out.put_bytes(chunks);
  return status::ok;
}

status put_section(std::span<const std::byte> bytes, const importance_source* source, std::vector<std::byte>& out) {
  reader file;
  if (const status s = reader::open(bytes, file); s != status::ok) return s;
  if (source == nullptr) return with_last_section(file, bytes, layout::section_importance, std::nullopt, out);
  if (file.format_version() != layout::version) return status::version;
  std::vector<std::byte> section;
  if (const status s = encode_section(file, *source, section); s != status::ok) return s;
  return with_last_section(file, bytes, layout::section_importance, std::span<const std::byte>(section), out);
}

status put_or_say(std::span<const std::byte> bytes, const importance_source* source, std::vector<std::byte>& out) {
#if defined(__cpp_exceptions)
  try {
    return put_section(bytes, source, out);
  } catch (const std::bad_alloc&) {
    return status::memory;
  } catch (const std::length_error&) {  // thrown by a vector above its largest size
    return status::memory;
  }
#else
  return put_section(bytes, source, out);
#endif
}

}  // namespace

status put_importance(std::span<const std::byte> file, const importance_source& classes, std::vector<std::byte>& out) {
  return put_or_say(file, &classes, out);
}

status remove_importance(std::span<const std::byte> file, std::vector<std::byte>& out) {
  return put_or_say(file, nullptr, out);
}

}  // namespace sightcell::format
