#pragma once
// Polygons that are in no set of a .pvs file ("unseen polygons"): of no cell, no sun and no light. bake.h has the
// conventions.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sightcell::scene {
struct scene;  // sightcell/scene/scene.h
}

namespace sightcell::bake {

// A glTF node that has polygons.
struct unseen_object {
  std::uint32_t node = 0;
  std::string name;
  std::uint32_t polygons = 0;
  std::uint32_t unseen = 0;
};

// What the certificate of a file states about all unseen polygons together.
//
// An unseen polygon is missing in every set, so a ray that meets one is a miss in every cell. The bound of a cell on
// its miss probability is therefore a bound on the probability that a ray from a random valid viewpoint of the cell, in
// a random direction, meets any unseen polygon.
//
// Each of these bounds holds with `confidence` by itself. The rays of different cells are independent, so the number of
// bounds that are too low is binomial at worst: with the same confidence it is at most `cells_that_may_exceed`.
struct unseen_bound {
  std::string metric;                // of the bounds: "pixel", "view" or "color"
  std::uint32_t cells = 0;           // with a bound
  std::uint32_t without = 0;         // cells without one. With the metric "color" all of them: a difference of colors
                                     // from the set of a cell is none from the scene without unseen polygons
  double mean_upper_bound = 1.0;     // over the cells with a bound; 1 if there is none
  double largest_upper_bound = 1.0;  // likewise
  double confidence = 0.0;           // of each bound; 0 if there is none
  std::uint32_t cells_that_may_exceed = 0;
  double outside_share = 0.0;  // largest share of the valid viewpoints of a cell that its bound may leave out
};

struct unseen_polygons {
  std::uint32_t cells = 0;     // in the file
  std::uint32_t polygons = 0;  // of the scene
  std::uint32_t unseen = 0;
  // Polygons about which the sets state nothing, and which count as seen: of objects that move or that are marked
  // dynamic, always or never, and those that a cells file lists as always or never.
  std::uint32_t exempt = 0;
  // Polygons that are visible from no cell, but that cast a shadow on what is visible from a cell (files of bake --sun)
  // or that a light reaches (bake --lights). They count as seen: without them, shadows change.
  std::uint32_t only_in_shadows = 0;

  std::vector<bool> is_unseen;         // by source id
  std::vector<unseen_object> objects;  // all, those with the most unseen polygons first
  unseen_bound bound;
  std::vector<std::string> warnings;  // why polygons may be unseen that a whole bake shows; one line each
};

// Finds the polygons that are in no set.
// s: the scene of the bake; with two scenes, the one of the polygons.
// file: the bytes of the .pvs file.
// name: of the file, for messages.
// Fails with pvs.other-scene, pvs.broken.
// Cost: decodes each set of a cell, of a sun and of a light once.
unseen_polygons find_unseen(const scene::scene& s, std::span<const std::byte> file, const std::string& name);

}  // namespace sightcell::bake
