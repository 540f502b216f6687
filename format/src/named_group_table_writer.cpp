#include "named_group_table_writer.h"

#include <algorithm>
#include <cstdint>

#include "byte_sink.h"
#include "packed_columns_writer.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {

status put_named_groups(std::span<const std::string> names, std::span<const draw_record> draws,
                        std::vector<std::byte>& out) {
  std::string text;
  std::vector<std::uint32_t> ends;
  for (const std::string& name : names) {
    if (name.empty()) return status::argument;
    if (name.size() > layout::max_names_size - text.size()) return status::limit;
    text += name;
    ends.push_back(static_cast<std::uint32_t>(text.size()));
  }
  std::vector<std::string> sorted(names.begin(), names.end());
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return status::argument;
  std::vector<std::uint32_t> groups;
  for (const draw_record& d : draws) {
    if (d.named_group != no_named_group && d.named_group >= names.size()) return status::argument;
    groups.push_back(d.named_group + 1);  // 0: none
  }
  byte_sink bytes(out);
  bytes.put_u32(static_cast<std::uint32_t>(names.size()));
  bytes.put_u32(static_cast<std::uint32_t>(text.size()));
  bytes.put_bytes(std::as_bytes(std::span(text)));
  put_columns(std::span(&ends, 1), out);
  put_columns(std::span(&groups, 1), out);
  return status::ok;
}

}  // namespace sightcell::format
