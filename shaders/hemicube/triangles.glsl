// Finds the triangles of drawn clusters that can have pixels. What is left out has none for certain, whatever the device
// does with positions between its steps; the rest is for the rasterizer to decide.
layout(std140, binding = hemicube_block_cull) uniform cull_block { hemicube_cull view; };
layout(std430, binding = hemicube_buffer_vertices) readonly buffer vertices_buffer { vec4 vertices[]; };
layout(std430, binding = hemicube_buffer_indices) readonly buffer indices_buffer { uint indices[]; };
layout(std430, binding = hemicube_buffer_kept) writeonly buffer kept_buffer { hemicube_kept kept[]; };
layout(std430, binding = hemicube_buffer_triangle_sums) buffer sums_buffer { uint triangle_sums[]; };

shared uint kept_bits[hemicube_cluster_size / 32u];

// Coordinates in pixels are exact enough up to this many images from the face.
const float most_images = 4.0;

struct triangle_place {
  bool on_screen;   // in front of the eye and near the image: the other members are valid
  vec2 low, high;   // box in pixels of the face, enlarged by the slack
  float nearest;    // smallest distance along the axis of the face, in meters
};

// Returns whether a triangle has no pixel in a face, as far as that does not depend on other polygons.
bool without_pixels(uint first_index, hemicube_cull_face face, bool double_sided, out triangle_place place) {
  place = triangle_place(false, vec2(0.0), vec2(0.0), 0.0);
  vec3 q[3];  // right, up, forward
  float size = 0.0;
  for (uint k = 0u; k < 3u; ++k) {
    vec3 p = vertices[indices[first_index + k]].xyz - view.eye.xyz;
    q[k] = vec3(dot(face.right.xyz, p), dot(face.up.xyz, p), dot(face.forward.xyz, p));
    size = max(size, abs(p.x) + abs(p.y) + abs(p.z));
  }
  float slack = 1e-5 * size;
  vec3 right = vec3(q[0].x, q[1].x, q[2].x), up = vec3(q[0].y, q[1].y, q[2].y), depth = vec3(q[0].z, q[1].z, q[2].z);
  vec4 kept = face.kept;
  if (all(lessThan(depth, vec3(-slack))) || all(lessThan(right - kept.x * depth, vec3(-slack))) ||
      all(lessThan(kept.y * depth - right, vec3(-slack))) || all(lessThan(up - kept.z * depth, vec3(-slack))) ||
      all(lessThan(kept.w * depth - up, vec3(-slack))))
    return true;
  place.nearest = min(depth.x, min(depth.y, depth.z));
  if (!(place.nearest > view.eye.w + slack)) return false;

  vec2 scale = face.pixels.zw / (kept.yw - kept.xz), at[3];
  for (uint k = 0u; k < 3u; ++k) {
    at[k] = (q[k].xy / q[k].z - kept.xz) * scale;
    if (!(all(lessThan(abs(at[k]), most_images * face.pixels.zw)))) return false;
  }
  place.on_screen = true;
  place.low = min(at[0], min(at[1], at[2])) - scene.pixel_slack;
  place.high = max(at[0], max(at[1], at[2])) + scene.pixel_slack;
  // A pixel is drawn where the triangle covers its center.
  if (any(greaterThan(ceil(place.low - 0.5), floor(place.high - 0.5)))) return true;
  if (double_sided) return false;
  vec2 ab = at[1] - at[0], ac = at[2] - at[0];
  float area = ab.x * ac.y - ab.y * ac.x;
  float perimeter = length(ab) + length(ac) + length(at[2] - at[1]);
  return area < -scene.pixel_slack * (perimeter + scene.pixel_slack);
}

// Records which triangles of the group's cluster are kept.
void record(uint number, bool keep) {
  uint local = gl_LocalInvocationIndex;
  if (local < hemicube_cluster_size / 32u) kept_bits[local] = 0u;
  barrier();
  if (keep) atomicOr(kept_bits[local / 32u], 1u << (local % 32u));
  barrier();
  if (local != 0u) return;
  uint count = 0u;
  for (uint i = 0u; i < hemicube_cluster_size / 32u; ++i) count += uint(bitCount(kept_bits[i]));
  kept[number].bits = uvec4(kept_bits[0], kept_bits[1], kept_bits[2], kept_bits[3]);
  kept[number].triangles = count;
  atomicAdd(triangle_sums[number / hemicube_sum_size], count);
}
