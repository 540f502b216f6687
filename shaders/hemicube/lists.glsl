// The draws of a pass: a list of clusters per face and class.
layout(std430, binding = hemicube_buffer_lists) buffer lists_buffer {
  uvec4 all_clusters;  // work groups along x, y, z of the shaders that have one per cluster; number of clusters
  hemicube_list lists[hemicube_faces * hemicube_classes];
};
