#pragma once
// Writes polygons of a glTF scene into small files, for `sightcell pack --stream`. docs/streaming.md has their format,
// scene.h the conventions.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {

// ---- Geometries -----------------------------------------------------------------------------------------------------

// What draws with equal vertices, attributes and indices share, in local space. Polygons have the numbers that they
// have in the draw, from 0.
struct streamed_geometry {
  std::uint32_t polygon_count = 0;
  glm::vec3 min{0.0f}, max{0.0f};  // of its vertices
};

// Polygons of one geometry.
struct page_part {
  std::uint32_t geometry = 0;
  std::vector<std::uint32_t> polygons;  // ascending
};

// ---- Images ---------------------------------------------------------------------------------------------------------

// The numbers of front field 8.
enum class image_type : std::uint8_t { png = 0, jpg = 1, webp = 2, ktx2 = 3, unknown = 4 };

// How materials use the alpha of an image: not at all, as a number like the others, as coverage, or compared with a
// cutoff.
enum class alpha_use : std::uint8_t { none, number, blended, tested };

// What smaller versions of an image have to keep.
struct image_use {
  bool is_color = false;     // in sRGB
  bool has_normals = false;  // unit vectors
  alpha_use alpha = alpha_use::none;
  float cutoff = 0.5f;  // where alpha is tested; of alpha / 255
};

struct streamed_image {
  std::uint32_t number = 0;             // in the glTF file
  std::uint32_t width = 0, height = 0;  // pixels; 0: unknown
  image_type type = image_type::unknown;
  image_use use;
  std::vector<std::uint8_t> bytes;  // as in the file
};

// ---- Pages ----------------------------------------------------------------------------------------------------------

struct page_settings {
  double grid = 1.0 / 4096;  // meters: most distance of the steps that positions are rounded to
  bool textures = true;      // false: without images
  // false: without texture coordinates and tangents that no texture of the materials needs.
  bool all_attributes = false;
};

class gltf_pager {
 public:
  // Loads a scene, as load_gltf does, with all attributes and images.
  // path, scene_index: as for load_gltf.
  explicit gltf_pager(const std::filesystem::path& path, int scene_index = -1);
  ~gltf_pager();
  gltf_pager(const gltf_pager&) = delete;
  gltf_pager& operator=(const gltf_pager&) = delete;

  // Returns the scene. Valid as long as the pager.
  const scene& content() const;

  // Rounds all vertices and finds equal geometries. Before the functions below.
  // warnings: receives one line for each thing that pages cannot keep.
  // Fails with scene.bad-field and others for a file that contradicts itself.
  // Cost: memory for all vertices and indices once more.
  void prepare(const page_settings& how, std::vector<std::string>& warnings);

  const std::vector<streamed_geometry>& geometries() const;
  // By draw.
  const std::vector<std::uint32_t>& geometry_of_draw() const;
  // Returns whether pages have the polygon: not if its corners coincide after rounding, or are not finite.
  bool is_drawn(std::uint32_t geometry, std::uint32_t polygon) const;

  // Returns the place of a corner in local space, as pages have it. number: 3 * polygon + 0 to 2.
  glm::vec3 corner(std::uint32_t geometry, std::uint32_t number) const;

  // Returns an estimate of the bytes that a part adds to a page, without the page's JSON. Any number of threads at
  // once.
  std::uint32_t coded_size(const page_part& part) const;

  // Returns the .glb of a page. parts: one per geometry, ascending. Same parts: same bytes. Any number of threads at
  // once.
  std::vector<std::byte> page(std::span<const page_part> parts) const;

  // Returns front field 4: the materials as JSON text.
  const std::string& materials() const;
  // Returns the number of images of the file, used or not.
  std::uint32_t image_count() const;
  // Returns the images that materials use, ascending.
  const std::vector<streamed_image>& images() const;
  // Returns the numbers of the images that a material uses. material: no_index for the default one.
  const std::vector<std::uint32_t>& images_of(std::uint32_t material) const;

 private:
  struct state;
  std::unique_ptr<state> state_;
};

}  // namespace sightcell::scene
