// Base color, and a simple light: sun, sky and a little haze. Normals are those of the triangles.
layout(std140, binding = 0) uniform view_block { camera_record view; };
layout(std430, binding = 0) readonly buffer material_block { material_record materials[]; };
layout(binding = 0) uniform sampler2DArray textures;

layout(location = 0) in vec3 from_eye;
layout(location = 1) in vec2 texture_uv;
layout(location = 2) in vec4 color;
layout(location = 3) flat in uvec2 numbers;

const vec3 sun = vec3(0.48, 0.76, 0.44);
const vec3 sky = vec3(0.46, 0.63, 0.86);

float wrapped(float at, uint wrap, int texels) {
  if (wrap == 1u) return clamp(at, 0.5 / float(texels), 1.0 - 0.5 / float(texels));
  if (wrap == 2u) return 1.0 - abs(mod(at, 2.0) - 1.0);
  return at;
}

vec3 place_in_texture(material_record own) {
  ivec2 texels = textureSize(textures, 0).xy;
  return vec3(wrapped(texture_uv.x, own.wrap_u, texels.x), wrapped(texture_uv.y, own.wrap_v, texels.y),
              float(own.base_texture));
}

vec4 base_of(material_record own) {
  return own.base_color * color * texture(textures, place_in_texture(own));
}

vec3 lit(vec3 base) {
  vec3 across = cross(dFdx(from_eye), dFdy(from_eye));
  float area = length(across);
  vec3 normal = area > 0.0 ? across / area : vec3(0.0, 1.0, 0.0);
  vec3 toward = normalize(from_eye);
  if (dot(normal, toward) > 0.0) normal = -normal;
  vec3 light = mix(vec3(0.44, 0.39, 0.34), vec3(0.58, 0.65, 0.76), 0.5 + 0.5 * normal.y) +
               vec3(0.58, 0.51, 0.40) * max(dot(normal, sun), 0.0) + vec3(0.12) * -dot(normal, toward);
  return mix(base * light, sky, 1.0 - exp(-length(from_eye) * view.clip_x.w));
}
