#pragma once
// A scene as the bake sees it: plain arrays that load_gltf fills and that any engine could fill itself.
// Units: metres, glTF axes (right-handed, +Y up). A polygon is one triangle of one instance of one primitive; its
// source id is its position when all draws are walked in order (design: nodes depth-first in array order, per node its
// mesh's primitives in order, per primitive its instances in order, per instance its triangles in index order).
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/ext/vector_uint4_sized.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <string>
#include <vector>

#include "sightcell/scene/alpha_mask.h"
#include "sightcell/scene/alpha_mode.h"
#include "sightcell/scene/animated_as.h"
#include "sightcell/scene/image.h"

namespace sightcell::scene {

inline constexpr std::uint32_t no_index = 0xFFFFFFFFu;

struct material {
  std::string name;
  alpha_mode alpha = alpha_mode::opaque;
  float alpha_cutoff = 0.5f;  // of alpha_mode::mask
  // A mask whose image is not there: nobody knows where its holes are, so it is seen all over and never hides.
  bool alpha_unknown = false;
  bool double_sided = false;
  glm::vec4 base_color{1.0f};                 // linear, multiplied with the texture
  std::uint32_t base_color_image = no_index;  // into scene::images
  wrap wrap_u = wrap::repeat, wrap_v = wrap::repeat;
  std::uint32_t alpha_map = no_index;  // into scene::alpha_maps: takes the place of the image's alpha
};

// Alpha that a host gave as bytes or as a function instead of an image.
struct alpha_map {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> texels;  // width x height, rows from v = 0 on
};

// The triangles of one primitive of one mesh, shared by all its instances.
struct geometry {
  std::vector<glm::vec3> positions;    // local space
  std::vector<glm::vec2> uvs;          // of the material's base color, transformed; empty, or one per position
  std::vector<std::uint32_t> indices;  // three per triangle; strips and fans are expanded
  std::vector<glm::u8vec4> colors{};   // linear, multiplied with the base color; empty, or one per position
};

// What moves, and what the host knows better (design: rule 6 of seeing). Without any of these a draw is seen and hides.
struct draw_tags {
  bool occluder = true;            // false: seen, never hides
  bool dynamic = false;            // left out: in no set, hides nothing; the host draws it itself
  bool always = false;             // in every set; hides as it would otherwise
  bool never = false;              // in no set, hides nothing
  bool animated = false;           // moved by an animation or a skin and without a mark: animated_as decides
  std::uint32_t group = no_index;  // into scene::groups: seen, never hides, and the host may hide it by that name

  bool operator==(const draw_tags&) const = default;
};

// What a host issues as one draw: one instance of one primitive.
struct draw {
  std::uint32_t node = 0, mesh = 0, primitive = 0, instance = 0;  // glTF indices; primitive counts inside its mesh
  std::uint32_t material = no_index;                              // into scene::materials; no_index: glTF's default
  std::uint32_t geometry = 0;                                     // into scene::geometries
  std::uint32_t first_source = 0;                                 // source id of its first polygon
  std::uint32_t polygon_count = 0;
  std::uint32_t base_vertex = 0;  // vertices of all draws before this one
  std::uint64_t host_tag = 0;
  glm::dmat4 to_world{1.0};
  draw_tags tags;
  bool moves =
      false;  // the host transforms it: marked dynamic, or moved by an animation or a skin and not marked static
  // Levels of detail: draws of one object share its number. Level 0 is seen and hides; the others hide nothing and are
  // in a set when any polygon of level 0 is.
  std::uint32_t lod_object = no_index, lod_level = 0;
};

// An extension that a file says it uses.
struct extension_use {
  std::string name;
  bool required = false;
  bool is_read = false;  // else it is ignored: it changes nothing that is seen, or the warnings name it
};

struct scene {
  std::string name;  // file name, for messages
  std::vector<material> materials;
  std::vector<image> images;
  std::vector<alpha_map> alpha_maps;
  std::vector<geometry> geometries;
  std::vector<draw> draws;
  std::vector<std::string> groups;  // names that draw_tags::group counts in
  std::uint32_t polygon_count = 0;
  std::vector<std::string> node_names;         // by glTF node index; for messages
  std::vector<extension_use> extensions;       // of the file, by name
  std::vector<std::string> warnings;           // one line each, import's findings
  std::array<std::uint8_t, 16> fingerprint{};  // of all that decides visibility: geometry, transforms, materials' alpha
};

// How a polygon is seen and what it hides.
struct polygon_kind {
  alpha_mode alpha : 2 = alpha_mode::opaque;
  bool double_sided : 1 = false;
  // Counted, never seen, hides nothing: no area, a corner that is not finite, a MASK that is cut away everywhere;
  // tagged dynamic or never; a level of detail below the finest.
  bool absent : 1 = false;
  // MASK whose alpha decides: world_geometry::masked has it. Every other MASK is there all over, like opaque ones.
  bool alpha_tested : 1 = false;
  bool never_hides : 1 = false;  // by its tags; what BLEND never does is not said here
  bool always : 1 = false;       // in every set

  bool hides() const { return !absent && !never_hides && alpha != alpha_mode::blend; }
};
static_assert(sizeof(polygon_kind) == 1);

// Source ids first to first + count - 1.
struct polygon_range {
  std::uint32_t first = 0, count = 0;
};

// The levels of detail of one object: when any polygon of the finest is in a set, so are all of the coarser ones.
struct lod_object {
  std::vector<polygon_range> finest, coarser;
};

// Why polygons are absent.
struct absent_counts {
  std::uint32_t not_finite = 0, no_area = 0, cut_away = 0, tagged = 0, coarser_level = 0;
};

// A polygon that is there only where its mask passes.
struct masked_polygon {
  std::uint32_t id = 0;                           // source id
  std::uint32_t mask = 0;                         // into world_geometry::masks
  std::array<glm::vec2, 3> uvs;                   // of its corners, in the order of world_geometry::indices; finite
  std::array<float, 3> alphas{1.0f, 1.0f, 1.0f};  // of its corners' colors, multiplied with the mask's
};

// The scene flattened into world space: vertices are numbered by flattening (draws in source order, base_vertex + local
// index), polygons by source id. Front faces are counter-clockwise; mirrored draws have two corners swapped for that.
struct world_geometry {
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;  // three per polygon
  std::vector<polygon_kind> kinds;     // one per polygon
  std::vector<masked_polygon> masked;  // those whose alpha is tested, ascending ids
  std::vector<alpha_mask> masks;       // what they are tested with
  std::vector<lod_object> lods;        // objects that have coarser levels
  absent_counts absent;
  std::vector<std::string> warnings;  // one line each: images that could not be used
  glm::vec3 min{0.0f}, max{0.0f};     // bounds of all polygons that are not absent
};

// Reads .glb or .gltf. scene_index: the glTF scene, -1 for the file's default. Throws sightcell::error (bad_input) with
// one line that names file and cause.
scene load_gltf(const std::filesystem::path& path, int scene_index = -1);

// The same from memory. name: for messages. folder: where the files lie that it names; empty: those of data URIs and of
// the .glb are all there may be.
scene load_gltf(std::span<const std::byte> bytes, const std::string& name, const std::filesystem::path& folder = {},
                int scene_index = -1);

// Numbers draws (first_source, polygon_count, base_vertex), sums polygon_count and computes the fingerprint. load_gltf
// has done this; a host that fills a scene itself calls it once at the end. Throws sightcell::error (bad_input) when an
// index is out of range or there are 2^32 - 1 polygons or more.
void finish(scene& s);

// Transforms in double precision, rounds once to float. Decodes the images of MASK materials, and no others; where all
// masks together have more than 64 Mi texels the largest are halved, which is said in the warnings.
// Single-sided MASK polygons in exactly the same place that face both ways are double-sided: a leaf and its back.
world_geometry flatten(const scene& s, animated_as animated = animated_as::always);

// The draw a polygon belongs to: index into scene::draws. O(log draws).
std::uint32_t draw_of(const scene& s, std::uint32_t source_id);

}  // namespace sightcell::scene
