#version 450 core
// One thread per cluster: its bit of the PVS, its level of detail, frustum, normal cone, hierarchical depth. Writes an indirect command for
// each cluster to draw.
#include "records.glsl"
#include "view.glsl"

layout(local_size_x = 64) in;
layout(std140, binding = 0) uniform view_block { camera_record view; };
layout(std140, binding = 1) uniform depth_view_block { camera_record depth_view; };  // whose picture `depths` is of
layout(std430, binding = 0) readonly buffer cluster_block { cluster_record clusters[]; };
layout(std430, binding = 1) readonly buffer bit_block { uint bits[]; };
layout(std430, binding = 2) buffer history_block { uint visible_before[]; };  // in the last frame
layout(std430, binding = 3) buffer drawn_block { uint drawn[]; };             // in this frame
layout(std430, binding = 4) writeonly buffer command_block { draw_command commands[]; };
layout(std430, binding = 5) buffer count_block { uint counts[]; };  // commands of each bin
layout(std430, binding = 6) readonly buffer bin_block { uvec2 bins[]; };  // first slot; 1: slots are compacted

layout(std430, binding = 7) readonly buffer level_block { level_group_record level_groups[]; };

layout(binding = 0) uniform sampler2D depths;

const uint without_depth = 0u, last_depth = 1u, first_of_two = 2u, second_of_two = 3u, whole_cut = 4u;
layout(location = 0) uniform uint stage;
layout(location = 1) uniform uint uses_bits;
layout(location = 2) uniform uint cluster_count;
layout(location = 3) uniform uint bin_count;
layout(location = 4) uniform float most_pixels;  // error of the cut; below 0: leaves only

const uint none = 0xFFFFFFFFu;

// Whether what takes the place of the members of a level group is fine enough for the eye.
bool is_fine(uint group) {
  level_group_record own = level_groups[group];
  float nearest = max(0.0, distance(view.eye.xyz, own.sphere.xyz) - own.sphere.w);
  return own.error <= most_pixels * view.size.z * nearest;
}

// The cut: no cluster needs to know of any other. Errors and spheres grow from level to level, so of those that have
// the same piece of a surface one is in the cut.
bool in_cut(cluster_record own) {
  if (most_pixels < 0.0) return own.made_by == none;
  return (own.made_by == none || is_fine(own.made_by)) && (own.member_of == none || !is_fine(own.member_of));
}

bool in_frustum(vec4 sphere) {
  vec3 from_eye = sphere.xyz - view.eye.xyz;
  for (int i = 0; i < 5; ++i) {
    if (dot(view.planes[i].xyz, from_eye) < -sphere.w) return false;
  }
  return true;
}

// Whether all triangles face away. A triangle that is edge-on up to rounding still counts as facing the eye.
bool faces_away(cluster_record own) {
  vec3 from_eye = own.sphere.xyz - view.eye.xyz;
  return dot(from_eye, own.cone.xyz) > (own.cone.w + 0.001) * length(from_eye) + own.sphere.w;
}

// Factor by which a box is taken as nearer: rounding, here and in the rasterizer's interpolation.
const float depth_slack = 1.001;

// Whether all pixels that a box can cover show something nearer.
bool occluded(cluster_record own) {
  vec2 first = vec2(1e30), last = vec2(-1e30);
  float nearest = 1e30;
  for (int corner = 0; corner < 8; ++corner) {
    vec3 at = vec3((corner & 1) == 0 ? own.min_x : own.max_x, (corner & 2) == 0 ? own.min_y : own.max_y,
                   (corner & 4) == 0 ? own.min_z : own.max_z) - depth_view.eye.xyz;
    float w = dot(at, depth_view.clip_w.xyz);
    if (!(w > depth_view.eye.w)) return false;
    vec2 clip = vec2(dot(at, depth_view.clip_x.xyz), dot(at, depth_view.clip_y.xyz)) / w;
    first = min(first, clip);
    last = max(last, clip);
    nearest = min(nearest, w);
  }
  vec2 size = depth_view.size.xy;
  first = (0.5 * first + 0.5) * size - 1.0;
  last = (0.5 * last + 0.5) * size + 1.0;
  // The depths of another frame tell nothing about what was beside its picture.
  if (stage == last_depth && (any(lessThan(first, vec2(0.0))) || any(greaterThan(last, size)))) return false;
  ivec2 low = ivec2(clamp(first, vec2(0.0), size - 1.0)) >> 1, high = ivec2(clamp(last, vec2(0.0), size - 1.0)) >> 1;
  int level = 0, levels = textureQueryLevels(depths);
  for (; level < levels - 1 && any(greaterThanEqual(high - low, ivec2(4))); ++level) {
    low >>= 1;
    high >>= 1;
  }
  float depth = depth_slack * depth_view.eye.w / nearest;
  for (int y = low.y; y <= high.y; ++y) {
    for (int x = low.x; x <= high.x; ++x) {
      if (!(texelFetch(depths, ivec2(x, y), level).x > depth)) return false;
    }
  }
  return true;
}

// Bins whose draws keep their order are not compacted: each cluster has a slot of its own, with 0 instances or 1.
void put(uint c, cluster_record own, bool is_drawn) {
  uint region = stage == second_of_two ? 1u : 0u;
  uint first = region * cluster_count + bins[own.bin].x;
  draw_command command = draw_command(own.index_count, is_drawn ? 1u : 0u, own.first_index, own.base_vertex, c);
  if (bins[own.bin].y == 0u) {
    commands[region * cluster_count + c] = command;
  } else if (is_drawn) {
    commands[first + atomicAdd(counts[region * bin_count + own.bin], 1u)] = command;
  }
}

void main() {
  uint c = gl_GlobalInvocationID.x;
  if (c >= cluster_count) return;
  cluster_record own = clusters[c];
  bool wanted = uses_bits == 0u || (bits[c >> 5] >> (c & 31u) & 1u) != 0u;
  wanted = wanted && in_cut(own) && (stage == whole_cut || (in_frustum(own.sphere) && !faces_away(own)));
  bool is_drawn = wanted;
  if (stage == last_depth) {
    is_drawn = wanted && !occluded(own);
  } else if (stage == first_of_two || stage == second_of_two) {
    bool is_early = wanted && own.is_blended == 0u && visible_before[c] != 0u;
    is_drawn = is_early;
    if (stage == second_of_two) {
      bool is_visible = wanted && !occluded(own);
      is_drawn = is_visible && !is_early;
      visible_before[c] = is_visible ? 1u : 0u;
    }
  }
  if (stage != second_of_two) {
    drawn[c] = is_drawn ? 1u : 0u;
  } else if (is_drawn) {
    drawn[c] = 1u;
  }
  put(c, own, is_drawn);
}
