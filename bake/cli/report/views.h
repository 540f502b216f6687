#pragma once
// The worst views of a file, as pictures.
#include <cstdint>
#include <span>
#include <vector>

#include "pvs_file.h"
#include "report/report_data.h"
#include "sightcell/bake/cell_views.h"
#include "sightcell/scene/scene.h"

namespace sightcell::cli {

inline constexpr std::size_t most_views = 10;

// Draws views with all polygons and with the set of their cell, and keeps those with the most differing pixels: views
// of missing polygons first, then views from the cells with the largest bounds. data: its verify and cells decide which
// views are tried; views, views_tried and views_note are set. from_cells: valid viewpoints. world: the scene as the
// bake flattened it. Where there is no OpenGL, views_note has the reason.
void draw_views(const scene::scene& s, const scene::world_geometry& world, const pvs_file& file,
                std::span<const bake::cell_view> from_cells, report_data& data);

}  // namespace sightcell::cli
