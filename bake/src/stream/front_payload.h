#pragma once
// The front of a streamed scene (docs/streaming.md, "Front").
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightcell/format/records.h"
#include "sightcell/scene/stream_pages.h"
#include "stream/page_plan.h"
#include "stream/payload.h"

namespace sightcell::bake {

// A file that the front lists.
struct listed_file {
  std::uint32_t bytes = 0;
  content_name name{};
};

struct listed_chunk {
  listed_file file;
  std::uint32_t cells = 0;
  format::box box;
};

// A version of an image.
struct listed_image {
  listed_file file;
  std::uint32_t width = 0, height = 0;  // pixels; 0: unknown
  scene::image_type type = scene::image_type::unknown;
};

struct front_content {
  const scene::gltf_pager& pager;
  const page_plan& plan;
  std::vector<listed_file> pages;
  std::vector<std::vector<listed_image>> images;  // by image of pager.images(): ascending
  std::vector<listed_chunk> chunks;
};

// Returns the file.
std::vector<std::byte> front_file(const front_content& content);

}  // namespace sightcell::bake
