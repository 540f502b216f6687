// two_pictures A.glb B.glb POSES [--size N] [--views N] [--draw-colors]: the share of pixels that differ by more than 8
// of 255 levels between pictures of two files with the same draws, such as a scene and what a streamed scene of it
// contains. POSES: a file of stream_truth (pose_file.h). Prints one line of JSON.
//
// --draw-colors: each draw has a color of its own and no texture, so that edges between draws of one material count.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "pose_file.h"
#include "sightcell/picture/gl_context.h"
#include "sightcell/picture/picture.h"
#include "sightcell/scene/scene.h"

namespace {

using namespace sightcell;

constexpr int most_levels = 8;

void color_by_draw(scene::scene& s) {
  const std::vector<scene::material> before = s.materials;
  s.materials.clear();
  for (std::uint32_t i = 0; i < s.draws.size(); ++i) {
    const std::uint32_t old = s.draws[i].material;
    scene::material one = old < before.size() ? before[old] : scene::material{};
    const std::uint32_t mixed = (i + 1) * 2654435761u;
    const auto part = [&](unsigned shift) { return static_cast<float>(mixed >> shift & 255u) / 255.0f; };
    one.base_color = {part(0), part(8), part(16), one.base_color.w};
    s.materials.push_back(one);
    s.draws[i].material = i;
  }
}

struct loaded {
  scene::scene content;
  scene::world_geometry world;

  loaded(const std::string& path, bool draw_colors) : content(scene::load_gltf(path)) {
    if (draw_colors) color_by_draw(content);
    world = scene::flatten(content);
  }
};

struct pose {
  glm::vec3 eye{0.0f};
  float heading = 0.0f;
};

std::vector<pose> read_poses(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  std::size_t at = 8;
  const auto u32 = [&] {
    std::uint32_t value = 0;
    if (bytes.size() < 4 || at > bytes.size() - 4) throw std::runtime_error(path + ": ends early");
    std::memcpy(&value, &bytes[at], 4);
    at += 4;
    return value;
  };
  const auto f32 = [&] { return std::bit_cast<float>(u32()); };
  if (u32() != bench::pose_file_version) throw std::runtime_error(path + ": another version");
  std::vector<pose> out(u32());
  for (pose& one : out) {
    one.eye.x = f32(), one.eye.y = f32(), one.eye.z = f32();
    one.heading = f32();
    u32();  // cell
    const std::size_t polygons = u32();
    at += 4 * (polygons * (1 + 1 + bench::views_of_pose) +                     // ids and angles
               bench::views_of_pose * bench::tiles_up * bench::tiles_across);  // depths
  }
  if (at != bytes.size()) throw std::runtime_error(path + ": not what its version has");
  return out;
}

std::uint64_t wrong_pixels(const picture::image_rgba& a, const picture::image_rgba& b) {
  std::uint64_t wrong = 0;
  for (std::size_t i = 0; i + 3 < a.pixels.size(); i += 4) {
    int most = 0;
    for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::abs(int{a.pixels[i + k]} - int{b.pixels[i + k]}));
    wrong += most > most_levels;
  }
  return wrong;
}

int run(const std::string& first, const std::string& second, const std::string& poses, std::uint32_t size,
        std::uint32_t views, bool draw_colors) {
  const loaded a(first, draw_colors), b(second, draw_colors);
  const picture::gl_context context;
  picture::renderer draw_a(context, a.content, a.world), draw_b(context, b.content, b.world);
  const std::uint32_t height = size * 9 / 16;
  std::uint64_t wrong = 0, pixels = 0, worst = 0;
  for (const pose& one : read_poses(poses))
    for (std::uint32_t view = 0; view < views; ++view) {
      const float turned =
          one.heading + static_cast<float>(view) * 2.0f * std::numbers::pi_v<float> / static_cast<float>(views);
      picture::camera camera;
      camera.eye = one.eye;
      camera.forward = {std::sin(turned), 0.0f, -std::cos(turned)};
      camera.vertical_fov = std::numbers::pi_v<float> / 3.0f;
      const std::uint64_t here = wrong_pixels(draw_a.draw(camera, size, height), draw_b.draw(camera, size, height));
      wrong += here;
      worst = std::max(worst, here);
      pixels += std::uint64_t{size} * height;
    }
  const double each = static_cast<double>(size) * height;
  std::cout << nlohmann::ordered_json{{"pixels", pixels},
                                      {"wrong_share", static_cast<double>(wrong) / static_cast<double>(pixels)},
                                      {"worst_share", static_cast<double>(worst) / each}}
            << "\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app;
  std::string first, second, poses;
  std::uint32_t size = 960, views = 4;
  bool draw_colors = false;
  app.add_option("A", first)->required();
  app.add_option("B", second)->required();
  app.add_option("POSES", poses)->required();
  app.add_option("--size", size);
  app.add_option("--views", views)->check(CLI::Range(1, 64));
  app.add_flag("--draw-colors", draw_colors);
  CLI11_PARSE(app, argc, argv);
  try {
    return run(first, second, poses, size, views, draw_colors);
  } catch (const std::exception& e) {
    std::cerr << "two_pictures: " << e.what() << "\n";
    return 1;
  }
}
