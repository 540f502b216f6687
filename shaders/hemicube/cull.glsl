// Tests which clusters are in the frustum of a face, with one invocation per cluster and face. The results are written
// into the draws of one pass.
layout(local_size_x = hemicube_cull_size) in;

layout(std140, binding = hemicube_block_cull) uniform cull_block { hemicube_cull view; };
layout(std430, binding = hemicube_buffer_clusters) readonly buffer clusters_buffer { hemicube_cluster clusters[]; };
layout(std430, binding = hemicube_buffer_commands) writeonly buffer commands_buffer { uint commands[]; };
layout(std430, binding = hemicube_buffer_group_draws) writeonly buffer group_draws_buffer { uint group_draws[]; };
layout(std430, binding = hemicube_buffer_last_seen) readonly buffer seen_buffer { uint last_seen[]; };

shared uint draws;

// Returns half the extent of the box, enlarged for rounding here and in the vertex shader.
vec3 reach_of(hemicube_cluster c) {
  return c.extent.xyz + 1e-5 * (abs(c.center.xyz - view.eye.xyz) + abs(view.eye.xyz));
}

bool outside(vec3 plane, vec3 from_eye, vec3 reach) { return dot(plane, from_eye) + dot(abs(plane), reach) < 0.0; }

// Returns whether a box touches the frustum of a face. The formula is that of bake/src/hemicube/gpu/gpu_culling.cpp.
bool in_frustum(hemicube_cluster c, hemicube_cull_face face) {
  vec3 from_eye = c.center.xyz - view.eye.xyz, reach = reach_of(c);
  vec3 forward = face.forward.xyz, right = face.right.xyz, up = face.up.xyz;
  return !(outside(right - face.kept.x * forward, from_eye, reach) ||
           outside(face.kept.y * forward - right, from_eye, reach) ||
           outside(up - face.kept.z * forward, from_eye, reach) ||
           outside(face.kept.w * forward - up, from_eye, reach) || outside(forward, from_eye, reach));
}

// Returns whether a cluster in the frustum is drawn in the first pass.
bool in_first_pass(uint cluster) {
  if (cluster >= scene.hiding_clusters || last_seen[cluster] == 0u) return false;
  return view.number - last_seen[cluster] <= hemicube_memory;
}

void write_draw(uint cluster, uint face, bool drawn) {
  if (gl_LocalInvocationIndex == 0u) draws = 0u;
  barrier();
  if (cluster != no_cluster) {
    uint at = hemicube_command_words * (face * scene.cluster_count + cluster);
    commands[at] = drawn ? 3u * clusters[cluster].polygon_count : 0u;
    commands[at + 1u] = 1u;
    commands[at + 2u] = 3u * clusters[cluster].first_polygon;
    commands[at + 3u] = 0u;
    commands[at + 4u] = 0u;
    if (drawn) atomicAdd(draws, 1u);
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u) group_draws[face * scene.group_count + gl_WorkGroupID.x] = draws;
}
