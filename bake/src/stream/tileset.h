#pragma once
// 3D Tiles over the pages of a streamed scene, for ordinary viewers (docs/streaming.md, "3D Tiles").
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "stream/front_payload.h"
#include "stream/shown_draws.h"
#include "stream/site_folder.h"
#include "stream/tile_materials.h"
#include "stream/tile_tree.h"

namespace sightcell::bake {

class tileset_writer {
 public:
  // pager: prepared. pages: their number. image_uris: by image; empty where there is no file. All arguments but the
  // last one must outlive the object. Throws sightcell::error: pack.not-written.
  tileset_writer(const scene::gltf_pager& pager, std::size_t pages, site_folder& site,
                 std::vector<std::string> image_uris);

  // Writes the file of the tile of a page, if any draw shows it. Several pages at once. Throws sightcell::error:
  // pack.not-written.
  // page: its file. bytes: of it.
  void add(std::uint32_t number, std::span<const scene::page_part> parts, const listed_file& page,
           std::span<const std::byte> bytes);

  // Returns tileset.json, once all pages are added.
  std::string tileset() const;

  std::uint32_t count() const;       // of tiles with a file
  std::uint64_t tile_bytes() const;  // of their files
  sent_bytes sent() const;           // of them

 private:
  struct written_tile {
    listed_tile tile;
    std::uint32_t bytes = 0;  // 0: no file
    sent_bytes sent;
  };

  const scene::gltf_pager& pager_;
  site_folder& site_;
  shown_draws shown_;
  tile_materials materials_;
  std::vector<written_tile> tiles_;  // by page
};

}  // namespace sightcell::bake
