// Counts pixels of a polygon, and records the first pixel of the atlas that the polygon covers.
layout(std140, binding = hemicube_block_gather) uniform gather_block { hemicube_gather settings; };
layout(std430, binding = hemicube_buffer_counts) buffer counts_buffer { hemicube_count counts[]; };
layout(std430, binding = hemicube_buffer_found) buffer found_buffer {
  uint found_count;
  uint groups_done;
  uint found[];
};

// pixel: the first of the pixels.
void mark(uint id, ivec2 pixel, uint pixels) {
  uint at = uint(pixel.y) * 3u * settings.resolution + uint(pixel.x);
  atomicMax(counts[id].pixels_after, 9u * settings.resolution * settings.resolution - at);
  if (atomicAdd(counts[id].pixels, pixels) == 0u) found[atomicAdd(found_count, 1u)] = id;
}
