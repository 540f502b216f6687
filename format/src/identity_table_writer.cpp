#include "identity_table_writer.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "byte_sink.h"
#include "packed_columns_writer.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

using column = std::vector<std::uint32_t>;

// The begin of a name that is too long, without part of a UTF-8 character.
std::string_view short_name(std::string_view name) {
  if (name.size() <= layout::max_draw_name) return name;
  std::size_t size = layout::max_draw_name;
  while (size > 0 && (static_cast<unsigned char>(name[size]) & 0xC0u) == 0x80u) --size;
  return name.substr(0, size);
}

// The names that draws use, by the numbers of their nodes or meshes.
std::vector<std::string_view> used_names(std::span<const draw_record> draws, std::uint32_t draw_record::*number,
                                         std::span<const std::string> names) {
  std::vector<std::string_view> used;
  for (const draw_record& d : draws) {
    if (d.*number >= names.size() || names[d.*number].empty()) continue;
    if (d.*number >= used.size()) used.resize(std::size_t{d.*number} + 1);
    used[d.*number] = short_name(names[d.*number]);
  }
  return used;
}

// 0 for no name, else one more than the number of the name.
column numbers_of(const std::vector<std::string_view>& names, const std::vector<std::string_view>& sorted) {
  column numbers;
  for (const std::string_view name : names) {
    const auto found = std::lower_bound(sorted.begin(), sorted.end(), name) - sorted.begin();
    numbers.push_back(name.empty() ? 0 : static_cast<std::uint32_t>(found) + 1);
  }
  return numbers;
}

void put_names(const std::vector<std::string_view>& sorted, std::vector<column>& sizes, std::string& texts) {
  std::string_view before;
  for (const std::string_view name : sorted) {
    const auto shared = static_cast<std::size_t>(
        std::mismatch(name.begin(), name.end(), before.begin(), before.end()).first - name.begin());
    sizes[0].push_back(static_cast<std::uint32_t>(shared));
    sizes[1].push_back(static_cast<std::uint32_t>(name.size() - shared));
    texts += name.substr(shared);
    before = name;
  }
}

}  // namespace

status put_identity(const file_contents& contents, std::vector<std::byte>& out) {
  const auto drawn = std::count_if(contents.draws.begin(), contents.draws.end(),
                                   [](const draw_record& d) { return d.polygon_count > 0; });
  if (contents.geometry_hashes.empty()) return status::ok;
  if (contents.geometry_hashes.size() != static_cast<std::size_t>(drawn)) return status::argument;

  std::vector<column> of_draw(1);
  std::vector<column> halves(2);
  std::map<std::uint64_t, std::uint32_t> numbers;
  for (const std::uint64_t hash : contents.geometry_hashes) {
    const auto [number, added] = numbers.try_emplace(hash, static_cast<std::uint32_t>(numbers.size()));
    of_draw[0].push_back(number->second);
    if (!added) continue;
    halves[0].push_back(static_cast<std::uint32_t>(hash));
    halves[1].push_back(static_cast<std::uint32_t>(hash >> 32));
  }
  const auto nodes = used_names(contents.draws, &draw_record::node, contents.node_names);
  const auto meshes = used_names(contents.draws, &draw_record::mesh, contents.mesh_names);
  std::vector<std::string_view> sorted;
  for (const auto* names : {&nodes, &meshes})
    std::copy_if(names->begin(), names->end(), std::back_inserter(sorted),
                 [](std::string_view n) { return !n.empty(); });
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  for (const std::string_view name : sorted) {
    if (name.find('\0') != std::string_view::npos) return status::argument;
  }
  std::vector<column> sizes(2);
  std::string texts;
  put_names(sorted, sizes, texts);
  std::vector<column> of_node{numbers_of(nodes, sorted)};
  std::vector<column> of_mesh{numbers_of(meshes, sorted)};

  byte_sink bytes(out);
  bytes.put_u32(static_cast<std::uint32_t>(halves[0].size()));
  bytes.put_u32(static_cast<std::uint32_t>(sorted.size()));
  bytes.put_u32(static_cast<std::uint32_t>(nodes.size()));
  bytes.put_u32(static_cast<std::uint32_t>(meshes.size()));
  for (std::vector<column>* const table : {&of_draw, &halves, &of_node, &of_mesh, &sizes}) put_columns(*table, out);
  bytes.put_bytes(std::as_bytes(std::span(texts)));
  return status::ok;
}

}  // namespace sightcell::format
