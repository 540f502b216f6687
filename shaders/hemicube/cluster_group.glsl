// Work groups with a cluster of a list each, and an invocation per triangle.
layout(local_size_x = hemicube_cluster_size) in;

layout(std430, binding = hemicube_buffer_packed) readonly buffer packed_buffer { uint packed_commands[]; };
layout(std140, binding = hemicube_block_cull_scene) uniform cull_scene_block { hemicube_cull_scene scene; };

// Returns the number of this group's cluster among those of all lists. There may be groups without a cluster.
uint cluster_number() { return gl_WorkGroupID.y * hemicube_most_columns + gl_WorkGroupID.x; }

uint list_of(uint number) {
  uint which = 0u;
  while (number >= lists[which].first_cluster + lists[which].clusters) ++which;
  return which;
}

// Returns where the draw of a cluster is in the packed commands.
uint command_of(uint number, uint list) {
  uint face = list / hemicube_classes, first = scene.classes[list % hemicube_classes].x;
  return hemicube_command_words * (face * scene.cluster_count + first + number - lists[list].first_cluster);
}
