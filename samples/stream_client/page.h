#pragma once
// The polygons of a page (docs/streaming.md, "Pages").
#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

namespace stream_client {

// Polygons of one geometry in a part.
struct page_piece {
  std::uint32_t geometry = 0;
  std::uint32_t first_index = 0, indices = 0;
};

// The polygons of one set of attributes.
struct page_part {
  std::vector<float> positions;         // 3 per vertex, local space of the geometry
  std::vector<std::vector<float>> uvs;  // by number of TEXCOORD; each empty, or 2 per vertex
  std::vector<std::uint16_t> colors;    // COLOR_0: empty, or 4 per vertex, 65535 is 1
  std::vector<std::uint32_t> indices;   // three per polygon
  std::vector<page_piece> pieces;
};

struct page {
  std::vector<page_part> parts;

  // Returns the bytes of its arrays.
  std::uint64_t bytes() const;
};

// What is wrong with the contents of a page.
struct page_error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Decodes a page. Normals, tangents and further colors are left out: this client draws without them.
// geometry_count: of the scene.
// Fails with page_error for bytes that are no page: whatever they are, all indices of the result are in range.
page read_page(std::span<const std::uint8_t> glb, std::uint32_t geometry_count);

}  // namespace stream_client
