// Structs of buffers. gpu_records.h has the same ones.
struct cluster_record {
  vec4 sphere;  // world space: center, radius
  vec4 cone;    // axis, and the cosine from which on all its triangles face away; above 1: never
  float min_x, min_y, min_z;
  uint first_index;
  float max_x, max_y, max_z;
  uint index_count;
  int base_vertex;
  uint bin;
  uint is_blended;
  uint made_by, member_of;  // level groups; none: 0xFFFFFFFF
  uint unused_a, unused_b, unused_c;
};

struct level_group_record {
  vec4 sphere;  // world space: center, radius
  float error;  // meters
  uint unused_a, unused_b, unused_c;
};

struct draw_command {  // DrawElementsIndirectCommand
  uint index_count, instance_count, first_index;
  int base_vertex;
  uint base_instance;
};

struct material_record {
  vec4 base_color;
  float alpha_cutoff;
  uint base_texture;    // layer of the texture array
  uint wrap_u, wrap_v;  // 0: repeat, 1: clamp, 2: mirror
};
