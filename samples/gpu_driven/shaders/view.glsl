// A camera: clip coordinates are dot products with (position - eye). Depth is reversed and has no far plane.
struct camera_record {
  vec4 eye;  // w: distance of the near plane
  vec4 clip_x, clip_y, clip_w;  // clip_x.w: 1 / distance of the haze
  vec4 planes[5];  // normals of the frustum to the inside; the planes contain the eye
  vec4 size;  // pixels: width, height; meters of a pixel at a distance of 1 m
};
