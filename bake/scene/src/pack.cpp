#include "sightcell/scene/pack.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "carried_materials.h"
#include "glb_bytes.h"
#include "opened_gltf.h"
#include "packed_document.h"
#include "packed_vertices.h"
#include "world_point.h"

namespace sightcell::scene {
namespace {

static_assert(std::endian::native == std::endian::little,
              "glTF is little-endian, and arrays are written as they are in memory");

using corner_list = std::array<std::uint32_t, 3>;

corner_list corners_of(const scene& s, std::uint32_t source_id, const std::vector<bool>& moves) {
  const std::uint32_t number = draw_of(s, source_id);
  const draw& d = s.draws[number];
  const std::uint32_t* const local = &s.geometries[d.geometry].indices[3 * std::size_t{source_id - d.first_source}];
  const bool swapped = !moves[number] && is_mirrored(d.to_world);
  return {d.base_vertex + local[0], d.base_vertex + local[swapped ? 2 : 1], d.base_vertex + local[swapped ? 1 : 2]};
}

// Writes the indices. A polygon with a corner that is not finite has a number and is never visible, so it must not be
// drawn with the corner's placeholder.
void write_indices(const scene& s, const packed_order& order, const std::vector<bool>& moves,
                   const std::vector<std::uint32_t>& broken, std::span<std::byte> into) {
  for (std::size_t i = 0; i < order.source_of_stored.size(); ++i) {
    corner_list corners = corners_of(s, order.source_of_stored[i], moves);
    const bool nowhere = !broken.empty() && std::any_of(corners.begin(), corners.end(), [&](std::uint32_t vertex) {
      return std::binary_search(broken.begin(), broken.end(), vertex);
    });
    if (nowhere) corners[1] = corners[2] = corners[0];
    std::memcpy(&into[12 * i], corners.data(), 12);
  }
}

}  // namespace

struct gltf_packer::state : opened_gltf {
  using opened_gltf::opened_gltf;

  // bytes: size of the whole file, as far as it is known.
  void check_size(std::uint64_t bytes) const {
    if (bytes > longest_glb)
      refuse(source.name, "pack.too-large",
             "would be a .glb of " + std::to_string(bytes) + " bytes, and lengths in one have 32 bits",
             "pack it in parts");
  }
};

gltf_packer::gltf_packer(const std::filesystem::path& path, int scene_index)
    : state_(std::make_unique<state>(path, scene_index)) {}

gltf_packer::~gltf_packer() = default;

const scene& gltf_packer::content() const {
  return state_->content;
}

std::vector<std::byte> gltf_packer::pack(const packed_order& order, std::vector<std::string>& warnings) {
  const scene& s = state_->content;
  std::vector<bool> moves(s.draws.size(), false);
  for (const packed_group& group : order.groups)
    for (const std::uint32_t number : group.draws) moves[number] = group.moves;
  const carried_materials materials =
      carry_materials(state_->document, *state_->root, state_->source, *state_->table, warnings);
  packed_vertices vertices(s, state_->poses, moves, *state_->attributes);
  const packed_places places = places_of(s, vertices, materials);
  state_->check_size(places.bytes);
  vertices.find_bounds();
  std::string json = packed_document(s, order, vertices, materials, places, state_->switches)
                         .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  state_->check_size(glb_size(json, places.bytes));
  std::vector<std::byte> out = glb_with_room(std::move(json), places.bytes);
  const std::span<std::byte> buffer = std::span(out).last(places.bytes);
  vertices.write(buffer);
  write_indices(s, order, moves, vertices.broken(), buffer.subspan(places.indices));
  for (std::size_t i = 0; i < materials.images.size(); ++i) {
    const std::vector<std::uint8_t>& bytes = materials.images[i].second;
    if (!bytes.empty()) std::memcpy(&buffer[places.images[i]], bytes.data(), bytes.size());
  }
  return out;
}

}  // namespace sightcell::scene
