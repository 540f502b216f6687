#pragma once
// Matches the draws of a host with those of a file by the geometry hashes in the file.
#include <cstdint>
#include <span>
#include <string_view>

#include "db.h"
#include "sightcell/format/identity_table.h"
#include "sightcell/identity.h"

namespace sightcell::runtime {

// names: of the nodes of the draws; null: none. draw_of_host: as many elements as hashes. out: without struct_size.
// Returns OK, OTHER_SCENE, MEMORY, or CORRUPT for bytes that have changed.
sightcell_status match_draws(const sightcell_db& db, const format::identity_table& table,
                             std::span<const std::uint64_t> hashes, const char* const* names,
                             std::span<std::uint32_t> draw_of_host, sightcell_draw_match& out) noexcept;

// The number of draws with polygons before this one in source order.
[[nodiscard]] sightcell_status place_in_source(const sightcell_db& db, const format::draw_record& draw,
                                               std::uint32_t& out) noexcept;

}  // namespace sightcell::runtime
