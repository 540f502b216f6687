#pragma once
// The draw identity of a file (SPEC.md, "Draw identity"): hashes of the geometry of draws, and names of nodes and
// meshes, by which a host finds its objects. reader::open skips them. The counterpart for writing is
// identity_table_writer.h.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "sightcell/format/layout.h"
#include "sightcell/format/packed_columns.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// The names of a table one after the other. Names can be read in this way only, since each begins with bytes of the one
// before it.
class name_walk {
 public:
  // texts: the bytes of all names.
  name_walk(const packed_column& shared, const packed_column& further, std::span<const std::byte> texts,
            std::uint32_t names) noexcept
      : shared_(shared), further_(further), texts_(texts), names_(names) {}

  // False after the last name, and where the bytes are no names.
  [[nodiscard]] bool next() noexcept;
  // Of the name that next() came to; valid until the next call.
  [[nodiscard]] std::string_view name() const noexcept { return {text_.data(), size_}; }

 private:
  packed_column shared_, further_;
  std::span<const std::byte> texts_;  // that are left
  std::uint32_t names_;
  std::uint32_t done_ = 0;
  std::uint32_t size_ = 0;
  std::array<char, layout::max_draw_name> text_{};
};

// A view of the section: cheap to copy, valid as long as the bytes are. Default-constructed: no draws.
class identity_table {
 public:
  // Opens the section of a file and checks all of it. out: set only on ok. absent: the file has none; checksum;
  // corrupt. O(draws + bytes of the section).
  [[nodiscard]] static status open(const reader& file, identity_table& out) noexcept;

  // Number of draws with polygons.
  [[nodiscard]] std::uint32_t draw_count() const noexcept { return draws_; }
  [[nodiscard]] std::uint32_t hash_count() const noexcept { return hash_count_; }
  [[nodiscard]] std::uint32_t name_count() const noexcept { return name_count_; }

  // The hash of a draw. place: its place among the draws with polygons, in source order. 0 for one that does not exist.
  [[nodiscard]] std::uint64_t hash(std::uint32_t place) const noexcept;

  // The name of a glTF node or mesh: 0 for none, else one more than its number in names().
  [[nodiscard]] std::uint32_t name_of_node(std::uint32_t node) const noexcept { return name_of(node_names_, node); }
  [[nodiscard]] std::uint32_t name_of_mesh(std::uint32_t mesh) const noexcept { return name_of(mesh_names_, mesh); }

  // All names, each once, ascending.
  [[nodiscard]] name_walk names() const noexcept { return {shared_, further_, texts_, name_count_}; }

 private:
  [[nodiscard]] std::uint32_t name_of(const packed_column& names, std::uint32_t number) const noexcept {
    const std::uint32_t name = names[number];
    return name > name_count_ ? 0 : name;
  }

  packed_column hash_of_draw_, low_, high_, node_names_, mesh_names_, shared_, further_;
  std::span<const std::byte> texts_;
  std::uint32_t draws_ = 0, hash_count_ = 0, name_count_ = 0;
};

}  // namespace sightcell::format
