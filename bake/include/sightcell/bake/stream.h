#pragma once
// Divides a scene into small files for a static web server, with the pages that each view cell needs:
// `sightcell pack --stream`. docs/streaming.md has the format, bake.h the conventions.
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sightcell::bake {

// Compressed copies beside pages and tiles, which static servers send in their place with Content-Encoding.
enum class stream_copies { none, gzip, gzip_and_brotli };
inline constexpr std::array<std::string_view, 3> stream_copies_names = {"none", "gzip", "brotli"};

struct stream_settings {
  double grid = 1.0 / 4096;           // meters: positions are rounded to steps of at most this
  std::uint32_t page_bytes = 16'384;  // of a page, in the mean of many
  bool textures = true;               // false: without images
  bool tileset = false;               // true: 3D Tiles over the pages, for other viewers
  stream_copies copies = stream_copies::gzip;
  bool all_attributes = false;  // true: also texture coordinates and tangents that no texture needs
};

enum class stream_phase { reading_sets, grouping_polygons, writing_pages, writing_images, writing_cells };

// Receives the parts of a phase that are done, of all. On the calling thread.
using stream_progress = std::function<void(stream_phase phase, std::uint64_t done, std::uint64_t total)>;

// Bytes of files as they are sent to clients that accept gzip, and to those that accept both. Without a copy: of the
// files.
struct sent_bytes {
  std::uint64_t gzip = 0, brotli = 0;

  void add(const sent_bytes& other) { gzip += other.gzip, brotli += other.brotli; }
};

struct stream_result {
  std::uint32_t polygons = 0, draws = 0, geometries = 0, cells = 0;
  std::uint32_t pages = 0, chunks = 0, images = 0;
  std::uint64_t front_bytes = 0, page_bytes = 0, chunk_bytes = 0, image_bytes = 0;
  std::uint64_t first_image_bytes = 0;  // of the smallest version of each image
  std::uint32_t polygons_left_out = 0;  // their corners coincide after rounding, or are not finite
  std::uint32_t tiles = 0;              // files of tiles; 0 without a tileset
  std::uint64_t tile_bytes = 0, tileset_bytes = 0;
  sent_bytes sent_pages, sent_tiles;
  std::uint32_t files_written = 0, files_kept = 0;
  double mean_cell_bytes = 0.0;       // of the pages that a cell needs, over all cells
  double mean_cell_gzip_bytes = 0.0;  // of them, as sent to clients that accept gzip
  std::vector<std::string> warnings;  // one line each
};

// Writes the files into a folder, the front last, and then tileset.json.
// scene_path, scene_index: the scene that was baked; -1 for the default scene of the file.
// file: the bytes of the .pvs file, which must have importance.
// name: of the file, for messages.
// output: a folder, created if there is none. Files in it that have the right contents are kept. Compressed copies of
//   older versions of scene.front and tileset.json are removed.
// on_progress: may be empty.
// Fails with pack.no-importance, pack.not-written, pvs.broken, pvs.other-scene, scene.*; then an older front is
//   unchanged.
// Cost: memory for the scene, its vertices once more, and 136 bytes per polygon. The bytes do not depend on the number
// of
//   threads.
stream_result pack_stream(const std::filesystem::path& scene_path, int scene_index, std::span<const std::byte> file,
                          const std::string& name, const std::filesystem::path& output, const stream_settings& how,
                          const stream_progress& on_progress);

}  // namespace sightcell::bake
