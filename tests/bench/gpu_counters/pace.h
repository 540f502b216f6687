#pragma once
// Hemicubes per second of the gpu source: each way of culling against a plain draw of everything.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hemicube/gpu/gpu_source.h"
#include "sightcell/picture/gl_context.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bench {

struct pace {
  std::string culling, gather;
  std::uint32_t at_once = 1;                      // poses per call of render()
  double samples_per_second = 0.0;                // best of three
  double cpu_ms_per_sample = 0.0;                 // of the process, all threads; least of three
  double triangles_per_sample = 0.0;              // given to the rasterizer
  double polygons_seen = 0.0;                     // per sample: the same for all
  std::vector<bake::gpu_timeline::stage> stages;  // seconds of the device per sample; with the gather "compute" alone
};

// Eight in a row in each of some cells of the file, looking the same way: as on a face of a cell in a bake.
std::vector<bake::pose> poses_in(const std::filesystem::path& cells, std::size_t count);

// gather: compute, read_back, or all. culling: none, frustum, occlusion, or all.
std::vector<pace> measure_paces(const picture::gl_context& context, const scene::world_geometry& world,
                                const std::vector<bake::pose>& poses, std::uint32_t resolution,
                                const std::string& gather, const std::string& culling);

}  // namespace sightcell::bench
