// Compares the mip levels that pixels of random views take with those that a file predicts, and counts the texels that
// its cells keep. The level of a pixel is that of the specification of Vulkan, from where the rays of the pixel and its
// two neighbors meet the plane of the triangle.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "file/stored_rules.h"
#include "sightcell/base/random.h"
#include "sightcell/residency.h"
#include "sightcell/scene/scene.h"
#include "trace/ray_scene.h"
#include "trace/triangle_math.h"
#include "trace/viewpoints.h"

namespace {

using namespace sightcell;

struct view_options {
  std::filesystem::path scene, file;
  std::uint32_t views = 200, side = 256, anisotropy = 16;
  double angle = 90.0;  // degrees, of both sides
  std::uint64_t seed = 1;
  double density = 1.0;  // what pixels per radian are multiplied with
  int coarser_by = 0;    // plants a fault: predicted levels are coarser by this
};

struct camera {
  glm::dvec3 eye, right, up, forward;
  double focal = 0.0;  // pixels

  glm::dvec3 ray(double x, double y) const { return forward * focal + right * x + up * y; }
};

// Where a texture is on a triangle, in texels, and the level that a filter takes for two steps.
class texel_map {
 public:
  texel_map(const bake::triangle& t, const std::array<glm::dvec2, 3>& texels) : corner_(t[0]), texels_(texels) {
    const glm::dvec3 ab = glm::dvec3(t[1]) - corner_, ac = glm::dvec3(t[2]) - corner_;
    normal_ = glm::cross(ab, ac);
    inverse_ = glm::inverse(glm::dmat3(ab, ac, normal_));
  }
  glm::dvec2 at(const glm::dvec3& eye, const glm::dvec3& ray) const {
    const double distance = glm::dot(normal_, corner_ - eye) / glm::dot(normal_, ray);
    const glm::dvec3 place = inverse_ * (eye + distance * ray - corner_);  // in edges
    return (1.0 - place.x - place.y) * texels_[0] + place.x * texels_[1] + place.y * texels_[2];
  }

 private:
  glm::dvec3 corner_, normal_{0.0};
  glm::dmat3 inverse_{1.0};
  std::array<glm::dvec2, 3> texels_;
};

double level_of(const glm::dvec2& dx, const glm::dvec2& dy, double anisotropy) {
  const double longer = std::max(glm::length(dx), glm::length(dy)),
               shorter = std::min(glm::length(dx), glm::length(dy));
  return std::log2(longer / std::max(1.0, std::min(longer / shorter, anisotropy)));
}

double texels_from(const scene::texture_info& texture, std::uint32_t level) {
  double texels = 0.0;
  for (; std::max(texture.width, texture.height) >> level != 0; ++level)
    texels += static_cast<double>(std::max(texture.width >> level, 1u)) * std::max(texture.height >> level, 1u);
  return texels;
}

class comparison {
 public:
  explicit comparison(const view_options& how) : how_(how), s_(scene::load_gltf(how.scene)) {
    s_.textures = scene::read_texture_uses(how.scene, s_);
    check(sightcell_db_open_file(how.file.string().c_str(), nullptr, &db_), "open");
    check(sightcell_residency_create(db_, &residency_), "residency");
    world_ = scene::flatten(s_);
    rays_ = std::make_unique<bake::ray_scene>(world_, false);
    levels_.resize(s_.textures.textures.size());
  }
  ~comparison() {
    sightcell_residency_destroy(residency_);
    sightcell_db_close(db_);
  }
  comparison(const comparison&) = delete;
  comparison& operator=(const comparison&) = delete;

  void run() {
    bake::random_stream random(how_.seed, 0, static_cast<bake::purpose>(0));
    while (views_ < how_.views) {
      const auto cell = static_cast<std::uint32_t>(random.bits() % sightcell_db_cell_count(db_));
      if (place(cell, random)) look(cell, random);
    }
  }
  void print() const;

 private:
  static void check(sightcell_status s, const char* what) {
    if (s == SIGHTCELL_OK) return;
    std::fprintf(stderr, "%s: %s\n", what, sightcell_status_text(s));
    std::exit(1);
  }
  float density() const { return static_cast<float>(how_.density * focal()); }
  double focal() const { return 0.5 * how_.side / std::tan(how_.angle * std::numbers::pi / 360.0); }
  // Finds a valid viewpoint in the cell.
  bool place(std::uint32_t cell, bake::random_stream& random) {
    float min[3], max[3];
    check(sightcell_db_cell_box(db_, cell, min, max), "cell");
    std::uint64_t tries = 0;
    const auto found =
        bake::draw_viewpoints(*rays_, bake::viewpoint_region({min[0], min[1], min[2]}, {max[0], max[1], max[2]}),
                              bake::stored_rules{}.player_radius, 1, 2000, random, tries);
    if (found.empty()) return false;
    camera_.eye = found[0];
    return true;
  }
  void look(std::uint32_t cell, bake::random_stream& random);
  void compare(std::uint32_t polygon, double x, double y);
  double texels_kept(std::uint32_t cell, float density) {
    std::size_t count = 0;
    check(sightcell_residency_cell_levels(residency_, cell, density, levels_.data(), levels_.size(), &count), "levels");
    double texels = 0.0;
    for (std::size_t i = 0; i < levels_.size(); ++i)
      if (levels_[i] != SIGHTCELL_NO_LEVEL) texels += texels_from(s_.textures.textures[i], levels_[i]);
    return texels;
  }

  view_options how_;
  scene::scene s_;
  scene::world_geometry world_;
  std::unique_ptr<bake::ray_scene> rays_;
  sightcell_db* db_ = nullptr;
  sightcell_residency* residency_ = nullptr;
  camera camera_;
  std::vector<std::uint8_t> levels_;
  std::uint32_t views_ = 0;
  std::uint64_t pixels_ = 0, coarser_ = 0;  // with a texture; of which one is predicted too coarse
  std::array<std::uint64_t, 32> finer_by_{};
  double kept_in_views_ = 0.0;
};

void comparison::look(std::uint32_t cell, bake::random_stream& random) {
  const double heading = 2.0 * std::numbers::pi * static_cast<double>(random.uniform());
  camera_.forward = {std::sin(heading), 0.0, -std::cos(heading)};
  camera_.right = glm::cross(camera_.forward, glm::dvec3(0, 1, 0));
  camera_.up = {0, 1, 0};
  camera_.focal = focal();
  kept_in_views_ += texels_kept(cell, density());
  ++views_;
  std::vector<bake::sight_line> lines;
  std::vector<bake::sight> sights(how_.side);
  const double middle = 0.5 * (how_.side - 1.0);
  for (std::uint32_t row = 0; row < how_.side; ++row) {
    lines.clear();
    for (std::uint32_t column = 0; column < how_.side; ++column)
      lines.push_back({glm::vec3(camera_.eye), glm::vec3(glm::normalize(camera_.ray(column - middle, row - middle)))});
    rays_->trace(lines, sights);
    for (std::uint32_t column = 0; column < how_.side; ++column) {
      const bake::sight& what = sights[column];
      if (what.front != bake::no_polygon) compare(what.front, column - middle, row - middle);
      for (const bake::passed_polygon& p : what.before) compare(p.polygon, column - middle, row - middle);
    }
  }
}

void comparison::compare(std::uint32_t polygon, double x, double y) {
  const scene::draw& d = s_.draws[scene::draw_of(s_, polygon)];
  if (d.material == scene::no_index || s_.textures.of_material[d.material].empty()) return;
  const auto& sets = s_.textures.coordinates.at({d.mesh, d.primitive});
  bool coarser = false;
  int finer = 100;
  for (const scene::texture_use& use : s_.textures.of_material[d.material]) {
    const scene::texture_info& texture = s_.textures.textures[use.texture];
    const std::vector<glm::vec2>& uvs = sets.at(use.set);
    if (uvs.empty()) continue;
    std::array<glm::dvec2, 3> texels;
    for (std::size_t k = 0; k < 3; ++k)
      texels[k] = use.transform * glm::dvec2(uvs[world_.indices[3 * std::size_t{polygon} + k] - d.base_vertex]) *
                  glm::dvec2(texture.width, texture.height);
    const texel_map map(bake::corners_of(world_, polygon), texels);
    const glm::dvec2 here = map.at(camera_.eye, camera_.ray(x, y));
    const double level = level_of(map.at(camera_.eye, camera_.ray(x + 1, y)) - here,
                                  map.at(camera_.eye, camera_.ray(x, y + 1)) - here, how_.anisotropy);
    const int last = static_cast<int>(std::bit_width(std::max(texture.width, texture.height))) - 1;
    const int needed =
        std::isnan(level) ? 0 : static_cast<int>(std::floor(std::clamp(level, 0.0, static_cast<double>(last))));
    const int predicted = std::min(static_cast<int>(levels_[use.texture]) + how_.coarser_by, 100);
    coarser = coarser || predicted > needed;
    finer = std::min(finer, needed - predicted);
  }
  if (finer == 100) return;
  ++pixels_;
  if (coarser) ++coarser_;
  ++finer_by_[static_cast<std::size_t>(std::clamp(finer + 16, 0, 31))];
}

void comparison::print() const {
  double all = 0.0, mean = 0.0;
  for (const scene::texture_info& one : s_.textures.textures) all += texels_from(one, 0);
  const std::uint32_t cells = sightcell_db_cell_count(db_);
  auto& self = const_cast<comparison&>(*this);
  for (std::uint32_t cell = 0; cell < cells; ++cell) mean += self.texels_kept(cell, density()) / cells;
  double reference = 0.0;
  for (std::uint32_t cell = 0; cell < cells; ++cell) reference += self.texels_kept(cell, 935.307f) / cells;
  const nlohmann::ordered_json out{
      {"scene", how_.scene.filename().string()},
      {"cells", cells},
      {"textures", s_.textures.textures.size()},
      {"views", views_},
      {"side", how_.side},
      {"anisotropy", how_.anisotropy},
      {"density", how_.density},
      {"pixels", pixels_},
      {"too_coarse", coarser_},
      {"fine_enough_percent",
       100.0 - 100.0 * static_cast<double>(coarser_) / static_cast<double>(std::max<std::uint64_t>(pixels_, 1))},
      {"all_mb", 4e-6 * all},
      {"kept_mb", 4e-6 * mean},
      {"kept_in_views_mb", 4e-6 * kept_in_views_ / views_},
      {"kept_percent", 100.0 * mean / all},
      {"kept_percent_1080p_60deg", 100.0 * reference / all},
      {"needed_minus_predicted_from_minus_16", finer_by_}};
  std::printf("%s\n", out.dump(2).c_str());
}

}  // namespace

int main(int argc, char** argv) {
  view_options how;
  CLI::App program{"Mip levels of pixels against those that a .pvs file predicts."};
  program.add_option("SCENE", how.scene)->required();
  program.add_option("FILE", how.file)->required();
  program.add_option("--views", how.views);
  program.add_option("--side", how.side, "Pixels along a side.");
  program.add_option("--angle", how.angle, "Degrees.");
  program.add_option("--anisotropy", how.anisotropy, "Of the filter of the pixels.");
  program.add_option("--density", how.density, "Factor of the pixels per radian that the levels are for.");
  program.add_option("--seed", how.seed);
  program.add_option("--coarser", how.coarser_by, "A planted fault: predicted levels are coarser by this.");
  CLI11_PARSE(program, argc, argv);
  comparison all(how);
  all.run();
  all.print();
  return 0;
}
