#pragma once
// Traverses the tree of clusters front to back. Skips nodes whose box is outside of the frustum, between pixel centers
// or behind the polygons already drawn.
#include "hemicube/cpu/draw_cluster.h"

namespace sightcell::bake::cpu {
namespace {

struct open_child {
  std::int32_t child;
  float nearest;   // largest inverse depth of the box
  float distance;  // of its center, squared; the nearest child is first
  tile_rect rect;
};

// A plane through the eye. A point p is inside where d . (p - eye) >= 0.
struct frustum_plane {
  float d[3];
};

struct frustum {
  frustum_plane planes[5];
};

inline frustum frustum_of(const face_frame& face) {
  frustum f;
  for (int i = 0; i < 3; ++i) {
    f.planes[0].d[i] = face.right[i] - face.min_x * face.forward[i];
    f.planes[1].d[i] = face.max_x * face.forward[i] - face.right[i];
    f.planes[2].d[i] = face.up[i] - face.min_y * face.forward[i];
    f.planes[3].d[i] = face.max_y * face.forward[i] - face.up[i];
    f.planes[4].d[i] = face.forward[i];
  }
  return f;
}

struct child_boxes {
  alignas(32) std::int32_t x0[8], y0[8], x1[8], y1[8];  // tiles
  alignas(32) float nearest[8], distance[8];
};

// Returns a bit per child of a node that may be visible, and fills out for these children.
inline std::uint32_t children_in_view(const face_frame& face, const tile_image& image, const frustum& view,
                                      const tree_node& node, child_boxes& out) {
  floats center[3], extent[3];
  for (int i = 0; i < 3; ++i) {
    const floats low = load(node.low[i]), high = load(node.high[i]), half = all(0.5f);
    const floats middle = low * half + high * half;
    center[i] = middle - all(face.eye[i]);
    // Slightly more than the box, because of rounding here and in the corners.
    extent[i] = (high * half - low * half) +
                all(1e-6f) * (magnitude(center[i]) + magnitude(middle) + all(__builtin_fabsf(face.eye[i])));
  }
  std::uint32_t seen = (1u << node.count) - 1u;
  for (const frustum_plane& p : view.planes) {
    const floats at = center[0] * all(p.d[0]) + center[1] * all(p.d[1]) + center[2] * all(p.d[2]);
    const floats reach = extent[0] * all(__builtin_fabsf(p.d[0])) + extent[1] * all(__builtin_fabsf(p.d[1])) +
                         extent[2] * all(__builtin_fabsf(p.d[2]));
    seen &= ~sign_bits(at + reach);
  }
  if (seen == 0) return 0;

  const auto along = [&](const float(&axis)[3]) {
    return center[0] * all(axis[0]) + center[1] * all(axis[1]) + center[2] * all(axis[2]);
  };
  const floats x = along(face.right), y = along(face.up), z = along(face.forward);
  const floats reach_z = extent[0] * all(__builtin_fabsf(face.forward[0])) +
                         extent[1] * all(__builtin_fabsf(face.forward[1])) +
                         extent[2] * all(__builtin_fabsf(face.forward[2]));
  const floats least_z = z - reach_z, near = all(near_plane);
  const ints in_front = least_z > near;
  floats low_x = all(1e9f), high_x = all(-1e9f), low_y = low_x, high_y = high_x;
  for (int corner = 0; corner < 8; ++corner) {
    floats cx = x, cy = y, cz = z;
    for (int i = 0; i < 3; ++i) {
      const float side = (corner >> i & 1) != 0 ? 1.0f : -1.0f;
      cx = cx + extent[i] * all(side * face.right[i]);
      cy = cy + extent[i] * all(side * face.up[i]);
      cz = cz + extent[i] * all(side * face.forward[i]);
    }
    const floats inverse = all(1.0f) / larger(cz, near);
    cx = cx * inverse;
    cy = cy * inverse;
    low_x = smaller(low_x, cx);
    high_x = larger(high_x, cx);
    low_y = smaller(low_y, cy);
    high_y = larger(high_y, cy);
  }
  // The first pixel center at or after the low end and the last one at or before the high end, with a margin of a
  // twentieth of a pixel. A box that reaches the near plane is assumed to fill the image.
  const auto limit = [](floats v) { return smaller(larger(v, all(-1e6f)), all(1e6f)); };
  const auto first = [&](floats v, std::int32_t middle) {
    return choose(in_front, rounded(limit(v * all(face.half) - all(0.05f + 1e-6f))) + all(middle), all(0));
  };
  const auto last = [&](floats v, std::int32_t middle) {
    return choose(in_front, rounded(limit(v * all(face.half) + all(0.05f + 1e-6f))) + all(middle - 1), all(1 << 24));
  };
  const ints x0 = larger(first(low_x, face.center_x), all(0)), y0 = larger(first(low_y, face.center_y), all(0));
  const ints x1 = smaller(last(high_x, face.center_x), all(static_cast<std::int32_t>(image.tiles_x * 8 - 1)));
  const ints y1 = smaller(last(high_y, face.center_y), all(static_cast<std::int32_t>(image.tiles_y * 8 - 1)));
  seen &= ~sign_bits((x0 > x1) | (y0 > y1));
  store(out.x0, shift_right<3>(x0));
  store(out.y0, shift_right<3>(y0));
  store(out.x1, shift_right<3>(x1));
  store(out.y1, shift_right<3>(y1));
  store(out.nearest, choose(in_front, all(1.00001f) / larger(least_z, near), all(1e9f)));
  store(out.distance, smaller(x * x + y * y + z * z, all(1e30f)));
  return seen;
}

// Rule 2: a see-through polygon is also visible a short distance behind an occluder.
template <pass kind>
inline float as_near_as(float nearest) {
  if (kind != pass::see_through) return nearest;
  const float depth = 1.0f / nearest;
  const float closer = depth - 2e-4f - 4e-5f * depth;
  return closer > near_plane ? 1.0f / closer : 1e9f;
}

template <pass kind>
inline void draw_tree(draw_state& s, const tree_view& tree) {
  if (tree.nodes == nullptr) return;
  const frustum view = frustum_of(s.face);
  open_child stack[7 * max_tree_depth + 8];
  std::uint32_t size = 0;
  stack[size++] = {0, 1e9f, 0, {0, 0, 0, 0}};
  while (size > 0) {
    const open_child next = stack[--size];
    if (next.nearest < 1e8f && is_occluded(s.image, next.rect, as_near_as<kind>(next.nearest))) continue;
    if (next.child < 0) {
      draw_cluster<kind>(s, tree, tree.clusters[~next.child]);
      continue;
    }
    const tree_node& node = tree.nodes[next.child];
    child_boxes boxes;
    const std::uint32_t first = size;
    for (std::uint32_t seen = children_in_view(s.face, s.image, view, node, boxes); seen != 0; seen &= seen - 1) {
      const auto k = static_cast<std::uint32_t>(__builtin_ctz(seen));
      const open_child made{
          node.child[k], boxes.nearest[k], boxes.distance[k], {boxes.x0[k], boxes.y0[k], boxes.x1[k], boxes.y1[k]}};
      // The nearest child ends up on top of the stack.
      std::uint32_t at = size++;
      for (; at > first && stack[at - 1].distance < made.distance; --at) stack[at] = stack[at - 1];
      stack[at] = made;
    }
  }
}

}  // namespace
}  // namespace sightcell::bake::cpu
