#include "worst_view.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "sightcell/bake/stored_overrides.h"
#include "sightcell/picture/gl_context.h"

namespace sightcell::cli {

namespace {

constexpr std::uint32_t width = 1280, height = 720;

}  // namespace

picture::camera camera_of(const scene::world_geometry& world, const bake::missing_polygon& missing) {
  const glm::vec3 eye(missing.eye[0], missing.eye[1], missing.eye[2]);
  const glm::vec3 target(missing.target[0], missing.target[1], missing.target[2]);
  picture::camera view;
  view.eye = eye;
  view.forward = target - eye;
  const float distance = std::max(glm::length(view.forward), 1e-4f);
  if (std::abs(view.forward.y) > 0.99f * distance) view.up = glm::vec3(0.0f, 0.0f, 1.0f);  // straight up or down
  float reach = 0.0f;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::vec3 corner = world.positions[world.indices[3 * std::size_t{missing.polygon} + i]];
    reach = std::max(reach, glm::distance(corner, target));
  }
  view.vertical_fov = std::clamp(8.0f * reach / distance, 0.1f, 1.2f);
  return view;
}

worst_view draw_worst_view(const scene::scene& s, const pvs_file& file, const bake::missing_polygon& missing,
                           const std::string& prefix) {
  scene::world_geometry world = scene::flatten(s, file.animated());
  bake::apply_stored_overrides(file.content().settings(), world);
  const picture::camera view = camera_of(world, missing);
  const picture::gl_context context;
  picture::renderer renderer(context, s, world);
  const picture::image_rgba full = renderer.draw(view, width, height);
  const std::vector<std::uint32_t> set = file.cell_set(missing.cell);
  const picture::image_rgba culled = renderer.draw(view, width, height, std::span<const std::uint32_t>(set));
  const picture::difference difference = picture::compare(full, culled);

  worst_view result;
  result.differing_pixels = difference.differing_pixels;
  result.color_error = difference.color_error;
  const auto save = [&](const char* name, const picture::image_rgba& image) {
    result.pictures.emplace_back(prefix + ".worst-" + name + ".png");
    picture::write_png(result.pictures.back(), image);
  };
  save("full", full);
  save("culled", culled);
  save("difference", difference.marked);
  return result;
}

}  // namespace sightcell::cli
