#include "stream/tileset.h"

#include <utility>

#include "stream/tile_wrapper.h"

namespace sightcell::bake {

tileset_writer::tileset_writer(const scene::gltf_pager& pager, std::size_t pages, site_folder& site,
                               std::vector<std::string> image_uris)
    : pager_(pager), site_(site), shown_(pager), materials_(pager.materials(), std::move(image_uris)), tiles_(pages) {
  site.create("tiles");
}

void tileset_writer::add(std::uint32_t number, std::span<const scene::page_part> parts, const listed_file& page,
                         std::span<const std::byte> bytes) {
  const std::string text =
      tile_wrapper(bytes, "../" + path_in_site("pages", page.name, "glb"), pager_, shown_, materials_);
  if (text.empty()) return;
  const auto [file, sent] = site_.add_with_copies("tiles", "gltf", std::as_bytes(std::span(text)));
  tiles_[number] = {
      {number, path_in_site("tiles", file.name, "gltf"), shape_of(pager_, shown_, parts)}, file.bytes, sent};
}

std::string tileset_writer::tileset() const {
  std::vector<listed_tile> tiles;
  for (const written_tile& written : tiles_)
    if (written.bytes > 0) tiles.push_back(written.tile);
  return tileset_json(tiles);
}

std::uint32_t tileset_writer::count() const {
  std::uint32_t out = 0;
  for (const written_tile& written : tiles_) out += written.bytes > 0;
  return out;
}

std::uint64_t tileset_writer::tile_bytes() const {
  std::uint64_t out = 0;
  for (const written_tile& written : tiles_) out += written.bytes;
  return out;
}

sent_bytes tileset_writer::sent() const {
  sent_bytes out;
  for (const written_tile& written : tiles_) out.add(written.sent);
  return out;
}

}  // namespace sightcell::bake
