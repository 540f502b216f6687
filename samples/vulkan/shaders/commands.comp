#version 450
// One thread per command of sightcell_view_commands. The runtime counts indices from the beginning of a primitive's
// index buffer; here all primitives share one, so their places are added. Then the frustum, and the bin of the draw.
#extension GL_GOOGLE_include_directive : require
#include "cull.glsl"

layout(local_size_x = 64) in;
layout(std430, set = 1, binding = 1) readonly buffer raw_block { draw_command raw_commands[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= count) return;
  draw_command command = raw_commands[i];
  draw_record own = draws[command.first_instance];
  command.first_index += own.first_index;
  command.vertex_offset = own.vertex_offset;
  bool is_visible = own.bin != no_bin && in_frustum(own.sphere);
  for (uint bin = 0u; bin < bin_count; ++bin) {
    if (bin == own.bin || bins[bin].compact_slots == 0u) put(command, bin, i, is_visible && bin == own.bin);
  }
}
