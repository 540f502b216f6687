// The clusters of the scene, as the shaders of culling divide them among work groups: no group has clusters of two
// classes.
layout(std140, binding = hemicube_block_cull_scene) uniform cull_scene_block { hemicube_cull_scene scene; };

uint class_of_group(uint group) {
  uint which = 0u;
  while (group >= scene.classes[which].z + scene.classes[which].w) ++which;
  return which;
}

// Returns the cluster of an invocation, or no_cluster where the group has fewer clusters than invocations.
const uint no_cluster = 0xFFFFFFFFu;
uint cluster_of_invocation(uint group, uint local) {
  uvec4 clusters = scene.classes[class_of_group(group)];
  uint number = (group - clusters.z) * hemicube_cull_size + local;
  return number < clusters.y ? clusters.x + number : no_cluster;
}
