#pragma once
// The builders of clutter.cpp's table that stand in files of their own.
#include "shapes.h"

namespace sightcell::city::parts {

// In streets and yards (street_clutter.cpp): the frame stands on the ground.
void wire(mesh& m, const frame& f, double size, random_stream& random);  // size: from wall to wall
void fruit_crate(mesh& m, const frame& f, double size, random_stream& random);
void litter(mesh& m, const frame& f, double size, random_stream& random);
void stones(mesh& m, const frame& f, double size, random_stream& random);
void fallen_leaves(mesh& m, const frame& f, double size, random_stream& random);
void leaf(mesh& m, const frame& f, double size, random_stream& random);
void pigeons(mesh& m, const frame& f, double size, random_stream& random);
void railing(mesh& m, const frame& f, double size, random_stream& random);  // size: its rise over its 2.9 m
void planks(mesh& m, const frame& f, double size, random_stream& random);
void bottles(mesh& m, const frame& f, double size, random_stream& random);
void drain(mesh& m, const frame& f, double size, random_stream& random);

// On towers (tower_clutter.cpp): size is the bay's width.
void bay_panels(mesh& m, const frame& f, double size, random_stream& random);
void bay_window(mesh& m, const frame& f, double size, random_stream& random);
void air_conditioner(mesh& m, const frame& f, double size, random_stream& random);
void balcony(mesh& m, const frame& f, double size, random_stream& random);
void laundry(mesh& m, const frame& f, double size, random_stream& random);
void pipe(mesh& m, const frame& f, double size, random_stream& random);
void stain(mesh& m, const frame& f, double size, random_stream& random);
void vent(mesh& m, const frame& f, double size, random_stream& random);
void cage(mesh& m, const frame& f, double size, random_stream& random);
void shop_sign(mesh& m, const frame& f, double size, random_stream& random);
void ledge(mesh& m, const frame& f, double size, random_stream& random);

}  // namespace sightcell::city::parts
