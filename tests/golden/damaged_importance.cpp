// Faults of the importance section. Opening a file leaves it out, so checking the whole file finds them.
#include <array>
#include <functional>

#include "byte_sink.h"
#include "checksum.h"
#include "code_table_writer.h"
#include "damaged_file.h"
#include "sightcell/format/layout.h"

namespace sightcell::test {
namespace layout = format::layout;
namespace {

using bytes = std::vector<std::byte>;
using format::status;

bytes from(std::initializer_list<int> values) {
  bytes out;
  for (const int value : values) out.push_back(static_cast<std::byte>(value));
  return out;
}

// The section of whole_contents(), whose cells see four polygons and one, from its parts. Codes are of two bits behind
// class 15 and of one behind class 0, and runs are of 0, 6 or 7 more: the classes are 15, 0, 0, 1 and 1.
struct importance_parts {
  std::uint64_t offset = 0;
  int more_size = 0, more_sum = 0, more_front_sum = 0;
  std::array<format::symbol_lengths, 16> codes{};
  format::symbol_lengths runs{};
  bytes chunk = from({1, 0b10, 0b1000011, 0b10, 0, 0, 0, 0, 0, 0, 0, 0});
  bytes behind;

  importance_parts() {
    codes[15][0] = codes[15][1] = codes[15][2] = codes[15][15] = 2;
    codes[0][0] = codes[0][1] = 1;
    runs[0] = runs[5] = 1;
  }

  [[nodiscard]] bytes section() const {
    bytes front;
    format::byte_sink sink(front);
    sink.put_u64(offset);
    sink.put_u32(static_cast<std::uint32_t>(static_cast<int>(chunk.size()) + more_size));
    sink.put_u32(format::crc32c(chunk) + static_cast<std::uint32_t>(more_sum));
    for (const format::symbol_lengths& lengths : codes) format::put_code_lengths(lengths, front);
    format::put_code_lengths(runs, front);
    bytes out;
    format::byte_sink all(out);
    all.put_u32(format::crc32c(front) + static_cast<std::uint32_t>(more_front_sum));
    all.put_bytes(front);
    all.put_bytes(chunk);
    all.put_bytes(behind);
    return out;
  }
};

// The file with the section behind all others.
bytes with_last_section(const bytes& file, const bytes& section) {
  const std::size_t count = get_u32(file, layout::header_section_count);
  const std::size_t table_end = layout::header_size + count * layout::section_record_size;
  bytes out(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(table_end));
  format::byte_sink record(out);
  record.put_u32(layout::section_importance);
  record.put_u32(0);
  record.put_u64(file.size() + layout::section_record_size);
  record.put_u64(section.size());
  record.put_u64(0);
  out.insert(out.end(), file.begin() + static_cast<std::ptrdiff_t>(table_end), file.end());
  out.insert(out.end(), section.begin(), section.end());
  set_u32(out, layout::header_section_count, static_cast<std::uint32_t>(count + 1));
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t offset = layout::header_size + i * layout::section_record_size + 8;
    set_u64(out, offset, get_u64(out, offset) + layout::section_record_size);
  }
  set_u64(out, layout::header_total_size, out.size());
  reseal(out);
  return out;
}

}  // namespace

damaged_list damaged_importance() {
  const bytes whole = whole_contents().encode();
  damaged_list list;
  const auto add = [&](const char* name, status expected, const std::function<void(importance_parts&)>& damage) {
    importance_parts parts;
    damage(parts);
    list.push_back({name, expected, with_last_section(whole, parts.section()), expected != status::ok});
  };
  add("undamaged_importance", status::ok, [](auto&) {});
  add("importance_front_checksum", status::checksum, [](auto& p) { p.more_front_sum = 1; });
  add("importance_chunk_checksum", status::checksum, [](auto& p) { p.more_sum = 1; });
  add("importance_chunk_begins_above_0", status::corrupt, [](auto& p) {
    p.offset = 1;
    p.more_size = -1;
  });
  add("importance_chunk_leaves_section", status::corrupt, [](auto& p) { p.more_size = 1; });
  add("importance_behind_chunks", status::corrupt, [](auto& p) { p.behind = bytes(1); });
  add("importance_code_of_9_bits", status::corrupt, [](auto& p) {
    for (std::size_t i = 0; i < 9; ++i) p.codes[3][i] = static_cast<std::uint8_t>(i + 1);
    p.codes[3][9] = 9;
  });
  add("importance_code_of_class_16", status::corrupt, [](auto& p) { p.codes[3][16] = 1; });
  add("importance_codes_incomplete", status::corrupt, [](auto& p) { p.codes[3][0] = p.codes[3][1] = 2; });
  add("importance_runs_incomplete", status::corrupt, [](auto& p) { p.runs[0] = p.runs[5] = 2; });
  add("importance_run_leaves_cell", status::corrupt, [](auto& p) { p.chunk[2] = std::byte{0b0111}; });
  add("importance_run_behind_run", status::corrupt, [](auto& p) {
    p.chunk = from({2, 0b1000, 0b11011, 0, 0b10, 0, 0, 0, 0, 0, 0, 0, 0});
  });
  add("importance_begins_of_33_bits", status::corrupt,
      [](auto& p) { p.chunk = from({33, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0b1000011, 0b10, 0, 0, 0, 0, 0, 0, 0, 0}); });
  add("importance_begins_above_0", status::corrupt, [](auto& p) { p.chunk[1] = std::byte{0b11}; });
  add("importance_begins_behind_chunk", status::corrupt, [](auto& p) {
    p.chunk = from({2, 0b1100, 0b1000011, 0b10, 0, 0, 0, 0, 0, 0, 0, 0});
  });
  add("importance_chunk_cut", status::corrupt, [](auto& p) { p.chunk.resize(9); });
  // Behind class 1 no class has a code.
  add("importance_is_no_code", status::corrupt, [](auto& p) { p.chunk[2] = std::byte{0b10}; });
  add("importance_byte_left", status::corrupt, [](auto& p) {
    p.chunk = from({2, 0b1000, 0b1000011, 0, 0b10, 0, 0, 0, 0, 0, 0, 0, 0});
  });
  add("importance_of_a_cell_missing", status::corrupt, [](auto& p) { p.chunk[1] = std::byte{0}; });
  // Any bytes are settings, and none an importance.
  bytes none = whole;
  set_u32(none, section_place(none, layout::section_settings), layout::section_importance);
  reseal(none);
  list.push_back({"importance_cut", status::corrupt, none, true});
  bytes twice = with_last_section(whole, importance_parts().section());
  set_u32(twice, section_place(twice, layout::section_settings), layout::section_importance);
  reseal(twice);
  list.push_back({"importance_twice", status::corrupt, twice});
  return list;
}

}  // namespace sightcell::test
