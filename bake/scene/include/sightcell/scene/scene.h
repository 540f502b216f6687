#pragma once
// A scene as plain arrays. load_gltf fills them from a file; other code can fill them and call finish. flatten turns
// them into triangles in world space. The following conventions hold for all headers of sightcell/scene.
//
// COORDINATES AND UNITS. Axes are those of glTF: right-handed, +Y up. Lengths are in meters.
//
// POLYGONS. A polygon is one triangle of one instance of one primitive. Its source id is its number when all draws are
// walked in order: nodes depth-first, per node the primitives of its mesh, per primitive its instances
// (EXT_mesh_gpu_instancing), per instance its triangles in index order.
//
// NUMBERS OF GLTF. Nodes, meshes, materials and images keep their glTF indices. no_index means none.
//
// FAILURES. Functions throw sightcell::error (sightcell/base/error.h) with an id scene.*; bake/ERRORS.md lists them.
//
// THREADS. Functions may be called from any thread, several at once. Arrays belong to the caller.
#include <algorithm>
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
#include "sightcell/scene/opacity_maps.h"
#include "sightcell/scene/texture_uses.h"

namespace sightcell::scene {

inline constexpr std::uint32_t no_index = 0xFFFFFFFFu;

// ---- Materials ------------------------------------------------------------------------------------------------------

// What of a material decides visibility and the colors of pictures.
struct material {
  std::string name;
  alpha_mode alpha = alpha_mode::opaque;
  float alpha_cutoff = 0.5f;   // of alpha_mode::mask
  bool alpha_unknown = false;  // a mask whose image is missing: visible everywhere, non-occluder
  bool double_sided = false;

  glm::vec4 base_color{1.0f};                 // linear, multiplied with the texture
  std::uint32_t base_color_image = no_index;  // in scene::images
  wrap wrap_u = wrap::repeat;
  wrap wrap_v = wrap::repeat;

  std::uint32_t alpha_map = no_index;  // in scene::alpha_maps; replaces the alpha of the image
};

// Alpha that a host gave as bytes or as a function.
struct alpha_map {
  std::uint32_t width = 0, height = 0;  // texels
  std::vector<std::uint8_t> texels;     // width * height, rows from v = 0 on
};

// ---- Geometry -------------------------------------------------------------------------------------------------------

// The triangles of one primitive, shared by all its instances.
struct geometry {
  std::vector<glm::vec3> positions;    // local space
  std::vector<glm::vec2> uvs;          // of the base color, with its texture transform; empty, or one per position
  std::vector<std::uint32_t> indices;  // three per triangle; strips and fans are expanded
  std::vector<glm::u8vec4> colors{};   // linear, multiplied with the base color; empty, or one per position

  // The host's clusters (meshlets): for each triangle the number of its cluster, which has at most 256; or empty. Used
  // where the sets of a file are of clusters; not part of the fingerprint.
  std::vector<std::uint32_t> clusters{};
};

// ---- Draws ----------------------------------------------------------------------------------------------------------

// Marks of extras.sightcell (docs/method/visibility-rules.md, rule 6). A draw without any is visible and occludes.
struct draw_tags {
  bool occluder = true;            // false: non-occluder
  bool dynamic = false;            // left out: in no set, occludes nothing; the host decides when to draw it
  bool always = false;             // in every set; occludes as it would without this
  bool never = false;              // in no set, occludes nothing
  bool animated = false;           // moved by an animation or a skin, without a mark: animated_as decides
  std::uint32_t group = no_index;  // named group, in scene::groups: non-occluder, and the host can hide it by its name

  bool operator==(const draw_tags&) const = default;
};

// What a host issues as one draw: one instance of one primitive.
struct draw {
  std::uint32_t node = 0, mesh = 0;   // glTF indices
  std::uint32_t primitive = 0;        // number in its mesh
  std::uint32_t instance = 0;         // number in EXT_mesh_gpu_instancing of its node, else 0
  std::uint32_t material = no_index;  // in scene::materials; no_index for the default material of glTF
  std::uint32_t geometry = 0;         // in scene::geometries

  // Set by finish.
  std::uint32_t first_source = 0;  // source id of its first polygon
  std::uint32_t polygon_count = 0;
  std::uint32_t base_vertex = 0;  // number of vertices of all draws before it

  std::uint64_t host_tag = 0;  // any value of a host that fills the arrays itself
  glm::dmat4 to_world{1.0};
  draw_tags tags;
  bool moves = false;  // the host transforms it: marked dynamic, or animated and not marked static

  // Levels of detail (MSFT_lod): the draws of one object have the same lod_object. Level 0 is visible and occludes.
  // Coarser levels occlude nothing, and are in a set if any polygon of level 0 is.
  std::uint32_t lod_object = no_index;
  std::uint32_t lod_level = 0;
};

// ---- Scene ----------------------------------------------------------------------------------------------------------

// An entry of extensionsUsed of a glTF file.
struct extension_use {
  std::string name;
  bool required = false;
  bool is_read = false;  // false: it changes nothing that is visible, or scene::warnings names it
};

// Where a player begins: a node with extras.sightcell.start, or with a camera.
struct start_point {
  std::array<float, 3> position{};  // world space, meters
  bool is_camera = false;
};

// A view cell that the scene contains: the box of a node with extras.sightcell.cell.
struct marked_cell {
  std::string name;                   // of the node
  std::array<float, 3> min{}, max{};  // world space, meters
};

// A point or spot light (KHR_lights_punctual) of a node. Lights decide no visibility.
struct light {
  std::uint32_t node = 0;            // glTF index
  std::array<float, 3> position{};   // world space, meters
  std::array<float, 3> direction{};  // unit vector: -z of the node, where a spot light shines
  float range = 0.0f;                // meters, above 0; infinity: no limit
  float cone = 0.0f;                 // of a spot light: angle between axis and edge, radians, up to pi / 2; 0: point
  bool moves = false;                // marked dynamic, or animated and not marked static
};

struct scene {
  std::string name;  // file name, for messages
  std::vector<material> materials;
  std::vector<image> images;
  std::vector<alpha_map> alpha_maps;
  std::vector<geometry> geometries;
  std::vector<draw> draws;
  std::vector<std::string> groups;  // names of named groups
  std::vector<start_point> starts;  // where players begin; not part of the fingerprint
  std::vector<marked_cell> cells;   // view cells, in the order of the nodes; not part of the fingerprint
  std::vector<light> lights;        // in the order of the nodes; not part of the fingerprint
  texture_uses textures;            // of read_texture_uses, which load_gltf does not call; not part of the fingerprint

  std::uint32_t polygon_count = 0;             // of all draws; set by finish
  std::vector<std::string> node_names;         // by node, for messages and for hosts
  std::vector<std::string> mesh_names;         // by mesh, likewise
  std::vector<extension_use> extensions;       // of the file, by name
  std::vector<std::string> warnings;           // of the import, one line each
  std::vector<std::string> light_warnings;     // likewise, about lights: those that are left out, and wrong values
  std::array<std::uint8_t, 16> fingerprint{};  // of all that decides visibility; set by finish
};

// ---- Import ---------------------------------------------------------------------------------------------------------

// Loads a glTF 2.0 file and calls finish.
// path: .glb or .gltf. Files that it names must be at or below its folder.
// scene_index: number of the glTF scene, -1 for the default scene of the file.
// Fails with scene.*; the line names the file and the cause.
// Cost: memory for the file and for the arrays at once; images stay compressed.
scene load_gltf(const std::filesystem::path& path, int scene_index = -1);

// As above, for a file that is in memory.
// bytes: of a .glb or .gltf; read during the call.
// name: for messages.
// folder: of the files that it names. Empty: it may name none except data URIs.
scene load_gltf(std::span<const std::byte> bytes, const std::string& name, const std::filesystem::path& folder = {},
                int scene_index = -1);

// Completes a scene that other code has filled: numbers draws (first_source, polygon_count, base_vertex), counts
// polygons and computes the fingerprint.
// s: changed in place.
// Fails with scene.index-out-of-range, scene.bad-field, scene.too-large (2^32 - 1 polygons or more).
void finish(scene& s);

// ---- World space ----------------------------------------------------------------------------------------------------

// How one polygon is visible and what it occludes.
struct polygon_kind {
  alpha_mode alpha : 2 = alpha_mode::opaque;
  bool double_sided : 1 = false;

  // In no set, occludes nothing: no area, a corner that is not finite, a mask that cuts away all of it, tagged dynamic
  // or never, or a coarser level of detail. It keeps its source id.
  bool absent : 1 = false;

  bool alpha_tested : 1 = false;  // world_geometry::masked has its mask; other masked polygons are like opaque ones
  bool non_occluder : 1 = false;  // non-occluder by its tags; alpha_mode::blend is one too, without this
  bool always : 1 = false;        // in every set

  // Returns whether it is an occluder.
  bool occludes() const { return !absent && !non_occluder && alpha != alpha_mode::blend; }
};
static_assert(sizeof(polygon_kind) == 1);

// Source ids first .. first + count - 1.
struct polygon_range {
  std::uint32_t first = 0, count = 0;
};

// Levels of detail of one object: if any polygon of `finest` is in a set, all of `coarser` are.
struct lod_object {
  std::vector<polygon_range> finest, coarser;
};

// Numbers of absent polygons by reason.
struct absent_counts {
  std::uint32_t not_finite = 0, no_area = 0, cut_away = 0, tagged = 0, coarser_level = 0;
};

// A polygon that exists only where its mask passes.
struct masked_polygon {
  std::uint32_t id = 0;                           // source id
  std::uint32_t mask = 0;                         // in world_geometry::masks
  std::array<glm::vec2, 3> uvs;                   // of its corners, in the order of world_geometry::indices; finite
  std::array<float, 3> alphas{1.0f, 1.0f, 1.0f};  // of the vertex colors of its corners, multiplied with the mask
};

// A scene in world space. Vertices are numbered draw by draw (base_vertex + local index), polygons by source id. Front
// faces are counter-clockwise: mirrored draws have two corners swapped.
struct world_geometry {
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;  // three per polygon
  std::vector<polygon_kind> kinds;     // one per polygon
  std::vector<masked_polygon> masked;  // ascending ids
  std::vector<alpha_mask> masks;
  opacity_maps opacity;          // of `masked`
  std::vector<lod_object> lods;  // objects that have coarser levels
  std::vector<start_point> starts;
  std::vector<marked_cell> cells;
  absent_counts absent;
  std::vector<std::string> warnings;  // images that could not be used, one line each
  glm::vec3 min{0.0f}, max{0.0f};     // bounds of all polygons that are not absent
};

// Flattens a scene. Transforms in double precision and rounds once to float. Two single-sided masked polygons in the
// same place that face both ways (a leaf and its back) become double-sided. s: completed by load_gltf or finish.
// animated: what becomes of animated draws without a mark.
// closed: named groups that the host does not hide: their draws occlude, unless another mark makes them non-occluders.
//   Names that the scene does not have are ignored.
// Cost: memory for all vertices of all instances. Decodes the images of masks, and halves the largest ones until all
//   have 2^26 texels or less together; `warnings` lists these.
world_geometry flatten(const scene& s, animated_as animated = animated_as::always,
                       std::span<const std::string> closed = {});

// Returns the number of the draw that has a polygon.
// source_id: less than s.polygon_count.
// Cost: O(log draws).
std::uint32_t draw_of(const scene& s, std::uint32_t source_id);

// Returns the index in world_geometry::masked of a polygon with an alpha test.
// source_id: of such a polygon.
// Cost: O(log masked polygons).
inline std::uint32_t masked_index(const world_geometry& world, std::uint32_t source_id) {
  const auto found = std::lower_bound(world.masked.begin(), world.masked.end(), source_id,
                                      [](const masked_polygon& p, std::uint32_t key) { return p.id < key; });
  return static_cast<std::uint32_t>(found - world.masked.begin());
}

}  // namespace sightcell::scene
