#pragma once
// The order of an earlier file, for a later version of its scene: what an edit left stays where it was.
#include <cstdint>
#include <span>
#include <vector>

#include "order/draw_identity.h"
#include "order/stored_draws.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/records.h"

namespace sightcell::bake {

struct earlier_order {
  // Of the earlier file: draws, order_of_draw and orders, and its geometry hashes and node names if it has them.
  format::file_parts file;
  std::vector<std::uint32_t> new_of;  // by the source ids of the earlier file: the one of now; UINT32_MAX: gone
};

// Computes the stored order of draws and polygons, as store_draws() does from sets.
// Draws with one order keep it where one of them has as many polygons as before, all that were there in their places,
// and also where nothing of it was there but a draw had the same geometry: it moved. Otherwise, as in a draw group,
// polygons are sorted by where they were stored, and one that was not there follows the one before it in source order.
// Draws, or draw groups, are sorted by where their first polygon was stored, one of which nothing was there by where
// a draw with the same geometry and node name was. All others are last, in source order.
// draws, layout, kind: as for store_draws().
// identity: of the draws; empty: none is known.
// Cost: O(polygons * log(polygons)).
stored_draws keep_order(std::span<const format::draw_record> draws, format::host_layout layout, polygon_order_kind kind,
                        const draw_identity& identity, const earlier_order& before);

}  // namespace sightcell::bake
