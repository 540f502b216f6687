#pragma once
// The order of polygons in a file whose sets are of clusters: clusters that are visible from the same cells follow each
// other, and the polygons of each are in source order.
#include <cstdint>
#include <span>
#include <vector>

#include "order/file_order.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// The clusters of all draws, numbered draw by draw in source order: by source id. Each draw has clusters of its own.
using cluster_numbers = std::vector<std::uint32_t>;

// Returns the clusters of a scene: those of the host where it has given any (scene::geometry::clusters).
// Fails with scene.bad-field if one of these has more polygons than a file can store.
cluster_numbers clusters_of_scene(const scene::scene& s);

// Returns the clusters of a file that has some, with its own numbers replaced. A cluster that has polygons of several
// draws (merged layout) becomes several.
cluster_numbers clusters_of_file(const format::file_parts& parts);

// As order_polygons_of() (file_order.h), for sets of clusters. It replaces the clusters of parts too.
void order_clusters_of(format::file_parts& parts, polygon_order_kind kind, const cluster_numbers& clusters,
                       const set_source& set_of);

}  // namespace sightcell::bake
