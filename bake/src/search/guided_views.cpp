#include "search/guided_views.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "search/hemicubes.h"
#include "search/radical_inverse.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

// Number of invalid viewpoints in a row after which a face counts as a wall, or points inside are drawn at random.
constexpr std::uint32_t give_up_after = 64;
constexpr std::uint32_t most_points = 4096;   // of the sequence, for one viewpoint: most may lie outside the region
constexpr std::uint64_t most_tests = 16'384;  // after these no viewpoint inside is searched for

pose rotated(const pose& where) {
  const float half = std::sqrt(0.5f);
  return {where.eye, where.forward, (where.right + where.up) * half, (where.up - where.right) * half};
}

}  // namespace

guided_views::guided_views(const ray_scene& rays, const viewpoint_region& where, const guided_settings& how)
    : rays_(rays),
      where_(where),
      how_(how),
      faces_(faces_of(where.whole().min, where.whole().max)),
      used_inside_(how.taken),
      random_inside_(how.seed, how.place, purpose::interior, 1, how.taken) {
  random_stream on_faces(how.seed, how.place, purpose::boundary), in_the_middle(how.seed, how.place, purpose::interior);
  for (glm::vec2& shift : shifts_) {
    shift.x = on_faces.uniform();
    shift.y = on_faces.uniform();
  }
  shift_inside_ = in_the_middle.in_box(glm::vec3{0.0f}, glm::vec3{1.0f});
  used_.fill(how.taken);
}

std::optional<pose> guided_views::on_a_face() {
  while (std::find(walled_.begin(), walled_.end(), false) != walled_.end()) {
    const std::uint32_t face = turns_ % 6, turn = turns_ / 6;
    ++turns_;
    if (walled_[face]) continue;
    for (std::uint32_t tests = 0, points = 0; tests < give_up_after && points < most_points; ++points) {
      const std::uint32_t i = ++used_[face];
      const glm::vec2 halton{radical_inverse(i, 2), radical_inverse(i, 3)};
      const pose where = faces_[face].at(glm::fract(halton + shifts_[face]));
      if (!where_.contains(where.eye)) continue;
      if (is_nearly_valid(where.eye)) return turn % 2 == 1 ? rotated(where) : where;
      ++tests;
    }
    walled_[face] = true;
  }
  return std::nullopt;
}

std::optional<glm::vec3> guided_views::inside() {
  const box& whole = where_.whole();
  for (std::uint32_t tests = 0, points = 0; tests < give_up_after && points < most_points; ++points) {
    const std::uint32_t i = ++used_inside_;
    const glm::vec3 halton{radical_inverse(i, 2), radical_inverse(i, 3), radical_inverse(i, 5)};
    const glm::vec3 eye = whole.min + (whole.max - whole.min) * glm::fract(halton + shift_inside_);
    if (!where_.contains(eye)) continue;
    if (is_nearly_valid(eye)) return eye;
    ++tests;
  }
  std::uint64_t tested = 0;
  const auto found = draw_viewpoints(rays_, where_, how_.player_radius, 1, most_tests, random_inside_, tested);
  return found.empty() ? std::nullopt : std::optional(found.front());
}

std::vector<pose> guided_views::next(std::uint32_t count) {
  std::vector<pose> poses;
  const auto add_inside = [&] {
    const auto eye = inside();
    if (eye) add_cube(*eye, poses);
    return eye.has_value();
  };
  while (poses.size() < count) {
    if (how_.geometry_inside) due_inside_ += how_.interior_share;
    if (due_inside_ >= 2.0 && poses.size() + 2 <= count) {
      due_inside_ += how_.interior_share - 2.0;  // a cube is two hemicubes
      if (add_inside()) continue;
    }
    if (const auto where = on_a_face())
      poses.push_back(*where);
    else if (poses.size() + 2 > count || !add_inside())
      break;
  }
  turn_by_less_than_a_pixel(poses);
  return poses;
}

std::vector<pose> guided_views::cubes_at(std::span<const glm::vec3> eyes) {
  std::vector<pose> poses;
  for (const glm::vec3& eye : eyes) add_cube(eye, poses);
  turn_by_less_than_a_pixel(poses);
  return poses;
}

void guided_views::turn_by_less_than_a_pixel(std::vector<pose>& poses) {
  for (pose& where : poses)
    where = jittered(where, how_.resolution, random_stream(how_.seed, how_.place, purpose::jitter, 0, how_.taken++));
}

}  // namespace sightcell::bake
