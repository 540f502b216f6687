// Shadow maps of a sun with four cascades, drawn with the set of the cell, with its casters too, and with everything,
// for random views from the cells of a file that was baked with --sun: which pixels have another shadow than with
// everything, and how many polygons are drawn of those that the boxes of the cascades let through.
//
// A pixel is wrong at its point if the casters lack the shadow of the point itself, which the bound of the casters is
// about, and beside it if only the texel that the pixel reads lacks its depth: the center of the texel is beside the
// point.
//
// A texel of a map has the depth of what a ray through its center meets first, with the sides of the materials. Only
// texels that a pixel reads are computed, which changes no pixel.
#include <tbb/parallel_for.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/baked_scene.h"
#include "casters/shadow_batch.h"
#include "file/caster_sets.h"
#include "sightcell/base/random.h"
#include "trace/triangle_math.h"
#include "trace/viewpoints.h"

namespace {

using namespace sightcell;
using bench::require;

constexpr std::size_t cascades = 4;
constexpr double near_plane = 0.1, split_weight = 0.75;  // of logarithmic over even splits

struct view_options {
  std::filesystem::path scene, file;
  std::uint32_t cells = 0, views = 4, width = 480, height = 270, texels = 2048;
  double fov = 60.0, far_plane = 300.0;  // degrees, vertical; meters
  std::uint64_t seed = 1;
  bool no_casters = false;  // plants a fault: the maps lack the casters of the file
};

struct totals {
  std::uint64_t views = 0, shaded = 0, shadowed = 0, wrong_of_sets = 0, wrong = 0, wrong_at_point = 0, worst = 0;
  std::uint64_t culled = 0, drawn_of_sets = 0, drawn = 0;  // polygons in the boxes of cascades
  double share = 0.0, share_of_sets = 0.0;                 // sums over views
};

struct view_count {
  std::uint64_t shaded = 0, wrong = 0;
};

// Returns the standard error of the share of wrong pixels, from how it differs between views.
double standard_error(const std::vector<view_count>& views) {
  double shaded = 0.0, wrong = 0.0, squares = 0.0;
  for (const view_count& one : views)
    shaded += static_cast<double>(one.shaded), wrong += static_cast<double>(one.wrong);
  if (views.size() < 2 || shaded == 0.0) return 0.0;
  for (const view_count& one : views) {
    const double off = static_cast<double>(one.wrong) - wrong / shaded * static_cast<double>(one.shaded);
    squares += off * off;
  }
  const auto count = static_cast<double>(views.size());
  return std::sqrt(squares * count / (count - 1.0)) / shaded;
}

// The box of a cascade across the light, which is open toward the light.
struct cascade_box {
  glm::dvec3 min{std::numeric_limits<double>::infinity()}, max{-std::numeric_limits<double>::infinity()};

  void add(const glm::dvec3& p) { min = glm::min(min, p), max = glm::max(max, p); }
  // z grows toward the light.
  bool lets_through(const cascade_box& of) const {
    return of.max.x >= min.x && of.min.x <= max.x && of.max.y >= min.y && of.min.y <= max.y && of.max.z >= min.z;
  }
};

struct camera {
  glm::dvec3 eye{0.0}, right{0.0}, up{0.0}, forward{0.0};
  double tangent_x = 0.0, tangent_y = 0.0;

  // x, y: -1 to 1
  glm::dvec3 ray(double x, double y) const { return forward + x * tangent_x * right + y * tangent_y * up; }
};

class comparison {
 public:
  explicit comparison(const view_options& how) : how_(how), baked_(how.scene, how.file) {
    require(casters_.open(opened_.file()));
    format::sun_record sun;
    require(casters_.table().sun(0, sun));
    to_light_ = glm::normalize(glm::dvec3(sun.from[0], sun.from[1], sun.from[2]));
    across_ =
        glm::normalize(glm::cross(to_light_, std::abs(to_light_.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
    along_ = glm::cross(to_light_, across_);
    state_.resize(s_.polygon_count);
    const scene::world_geometry& world = opened_.rays().geometry();
    boxes_.resize(s_.polygon_count);
    for (std::uint32_t i = 0; i < s_.polygon_count; ++i) {
      if (world.kinds[i].absent || world.kinds[i].alpha == scene::alpha_mode::blend) continue;
      for (const glm::vec3& corner : bake::corners_of(world, i)) boxes_[i].add(in_light(glm::dvec3(corner)));
      top_ = std::max(top_, boxes_[i].max.z);
    }
  }

  nlohmann::ordered_json run() {
    const std::uint32_t stored = opened_.file().cell_count();
    const std::uint32_t chosen = how_.cells == 0 ? stored : std::min(how_.cells, stored);
    for (std::uint32_t i = 0; i < chosen; ++i)
      look_from(static_cast<std::uint32_t>(std::uint64_t{i} * stored / chosen));
    const auto share = [](auto part, auto all) {
      return all > 0 ? static_cast<double>(part) / static_cast<double>(all) : 0.0;
    };
    return {{"scene", how_.scene.stem().string()},
            {"cells", chosen},
            {"views", all_.views},
            {"pixels", all_.shaded},
            {"shadowed_percent", 100.0 * share(all_.shadowed, all_.shaded)},
            {"wrong_of_sets", share(all_.wrong_of_sets, all_.shaded)},
            {"wrong", share(all_.wrong, all_.shaded)},
            {"standard_error", standard_error(counts_)},
            {"wrong_at_point", share(all_.wrong_at_point, all_.shaded)},
            {"worst_view", share(all_.worst, std::uint64_t{how_.width} * how_.height)},
            {"culled_polygons", share(all_.culled, all_.views)},
            {"drawn_of_sets_percent", 100.0 * share(all_.share_of_sets, static_cast<double>(all_.views))},
            {"drawn_percent", 100.0 * share(all_.share, static_cast<double>(all_.views))},
            {"drawn_percent_of_sum", 100.0 * share(all_.drawn, all_.culled)}};
  }

 private:
  enum state : std::uint8_t { absent, seen, caster };

  glm::dvec3 in_light(const glm::dvec3& p) const {
    return {glm::dot(p, across_), glm::dot(p, along_), glm::dot(p, to_light_)};
  }

  void look_from(std::uint32_t cell) {
    std::vector<std::uint32_t> ids;
    std::fill(state_.begin(), state_.end(), std::uint8_t{absent});
    require(casters_.source_ids(cell, 0, ids));
    for (const std::uint32_t id : ids)
      if (!how_.no_casters) state_[id] = caster;
    opened_.cell_set(cell, ids);
    for (const std::uint32_t id : ids) state_[id] = seen;
    bake::random_stream random(how_.seed, cell, static_cast<bake::purpose>(0));
    std::uint64_t tries = 0;
    for (const glm::vec3& eye :
         bake::draw_viewpoints(opened_.rays(), opened_.region(cell), opened_.rules().player_radius, how_.views,
                               2000 * std::uint64_t{how_.views}, random, tries)) {
      const double heading = 2.0 * std::numbers::pi * static_cast<double>(random.uniform());
      camera view;
      view.eye = glm::dvec3(eye);
      view.forward = {std::sin(heading), 0.0, -std::cos(heading)};
      view.up = {0.0, 1.0, 0.0};
      view.right = glm::cross(view.forward, view.up);
      view.tangent_y = std::tan(how_.fov * std::numbers::pi / 360.0);
      view.tangent_x = view.tangent_y * how_.width / how_.height;
      look(view);
    }
  }

  void look(const camera& view) {
    place_cascades(view);
    count_polygons();
    std::vector<totals> rows(how_.height);
    tbb::parallel_for(std::uint32_t{0}, how_.height, [&](std::uint32_t y) { shade_row(view, y, rows[y]); });
    view_count count;
    for (const totals& row : rows) {
      all_.shaded += row.shaded, all_.shadowed += row.shadowed;
      all_.wrong += row.wrong, all_.wrong_of_sets += row.wrong_of_sets, all_.wrong_at_point += row.wrong_at_point;
      count.shaded += row.shaded, count.wrong += row.wrong;
    }
    counts_.push_back(count);
    all_.worst = std::max(all_.worst, count.wrong);
    ++all_.views;
  }

  void place_cascades(const camera& view) {
    double begin = near_plane;
    for (std::size_t i = 0; i < cascades; ++i) {
      const double part = static_cast<double>(i + 1) / cascades;
      ends_[i] = split_weight * near_plane * std::pow(how_.far_plane / near_plane, part) +
                 (1.0 - split_weight) * (near_plane + (how_.far_plane - near_plane) * part);
      maps_[i] = {};
      for (const double depth : {begin, ends_[i]})
        for (const double x : {-1.0, 1.0})
          for (const double y : {-1.0, 1.0}) maps_[i].add(in_light(view.eye + depth * view.ray(x, y)));
      begin = ends_[i];
    }
  }

  void count_polygons() {
    std::uint64_t culled = 0, of_set = 0, drawn = 0;
    for (std::uint32_t i = 0; i < s_.polygon_count; ++i)
      for (const cascade_box& map : maps_) {
        if (boxes_[i].min.x > boxes_[i].max.x || !map.lets_through(boxes_[i])) continue;
        ++culled, of_set += state_[i] == seen, drawn += state_[i] != absent;
      }
    all_.culled += culled, all_.drawn_of_sets += of_set, all_.drawn += drawn;
    if (culled == 0) return;
    all_.share += static_cast<double>(drawn) / static_cast<double>(culled);
    all_.share_of_sets += static_cast<double>(of_set) / static_cast<double>(culled);
  }

  void shade_row(const camera& view, std::uint32_t y, totals& out) const {
    bake::sight what;
    for (std::uint32_t x = 0; x < how_.width; ++x) {
      const glm::dvec3 ray = view.ray(2.0 * (x + 0.5) / how_.width - 1.0, 1.0 - 2.0 * (y + 0.5) / how_.height);
      const glm::vec3 direction(glm::normalize(ray));
      opened_.rays().trace(glm::vec3(view.eye), direction, what);
      const double depth = static_cast<double>(what.distance) / glm::length(ray);
      if (what.front == bake::no_polygon || what.front >= s_.polygon_count || state_[what.front] != seen) continue;
      if (depth >= ends_.back()) continue;
      ++out.shaded;
      if (!bake::faces_light(opened_.rays().geometry(), what.front, direction, glm::vec3(to_light_))) continue;
      const auto cascade = static_cast<std::size_t>(
          std::find_if(ends_.begin(), ends_.end(), [depth](double end) { return depth < end; }) - ends_.begin());
      const std::uint64_t before = out.wrong;
      shade(view.eye + static_cast<double>(what.distance) * glm::dvec3(direction), maps_[cascade], out);
      if (out.wrong > before) out.wrong_at_point += is_wrong_at_point({glm::vec3(view.eye), direction}, what);
    }
  }

  bool is_wrong_at_point(const bake::sight_line& line, const bake::sight& what) const {
    bake::lacking_casters lacking;
    const glm::vec3 point = line.eye + line.direction * what.distance, to_light(to_light_);
    return bake::find_lacking(
        opened_.rays(), bake::shadow_line_of(point, what.distance, to_light, what.front),
        [this](std::uint32_t id) { return id >= s_.polygon_count || state_[id] != absent; }, lacking);
  }

  void shade(const glm::dvec3& point, const cascade_box& map, totals& out) const {
    const glm::dvec3 at = in_light(point), texel = (map.max - map.min) / static_cast<double>(how_.texels);
    const double x = map.min.x + (std::floor((at.x - map.min.x) / texel.x) + 0.5) * texel.x;
    const double y = map.min.y + (std::floor((at.y - map.min.y) / texel.y) + 0.5) * texel.y;
    const double height = top_ + 1.0, bias = 0.01 + 2.0 * std::max(texel.x, texel.y);
    const glm::vec3 from(x * across_ + y * along_ + height * to_light_);
    bake::sight first;
    opened_.rays().trace(from, glm::vec3(-to_light_), first);
    const auto is_dark = [&] { return height - static_cast<double>(first.distance) > at.z + bias; };
    const bool right = is_dark();
    out.shadowed += right;
    if (!right || first.front >= s_.polygon_count) return;  // a map of fewer polygons has no shadow more
    const std::uint32_t front = first.front;
    if (state_[front] == seen) return;
    const auto lacks = [&](const auto& drawn) {
      opened_.rays().trace_against_set(from, glm::vec3(-to_light_), drawn, first);
      return !is_dark();
    };
    out.wrong_of_sets += lacks([this](std::uint32_t id) { return id >= s_.polygon_count || state_[id] == seen; });
    if (state_[front] == absent)
      out.wrong += lacks([this](std::uint32_t id) { return id >= s_.polygon_count || state_[id] != absent; });
  }

  view_options how_;
  bench::baked_scene baked_;
  const scene::scene& s_ = baked_.s;
  bake::verified_file& opened_ = baked_.opened;
  bake::caster_set_reader casters_;
  glm::dvec3 to_light_{0.0}, across_{0.0}, along_{0.0};
  std::vector<std::uint8_t> state_;  // by polygon
  std::vector<cascade_box> boxes_;   // by polygon, in the axes of the light
  double top_ = -std::numeric_limits<double>::infinity();
  std::array<cascade_box, cascades> maps_;
  std::array<double, cascades> ends_{};  // meters along the view
  totals all_;
  std::vector<view_count> counts_;  // of each view
};

}  // namespace

int main(int argc, char** argv) {
  view_options how;
  CLI::App program{
      "Shadow maps with four cascades, drawn with the casters of a .pvs file, against those with everything."};
  program.add_option("SCENE", how.scene)->required();
  program.add_option("FILE", how.file)->required();
  program.add_option("--cells", how.cells, "Cells, spread evenly; 0: all.");
  program.add_option("--views", how.views, "Views per cell.");
  program.add_option("--width", how.width)->check(CLI::Range(1, 8192));
  program.add_option("--height", how.height)->check(CLI::Range(1, 8192));
  program.add_option("--texels", how.texels, "Along a side of a shadow map.")->check(CLI::Range(1, 65536));
  program.add_option("--far", how.far_plane, "End of the last cascade, meters.");
  program.add_option("--seed", how.seed);
  program.add_flag("--no-casters", how.no_casters, "A planted fault: maps lack the casters of the file.");
  CLI11_PARSE(program, argc, argv);
  try {
    std::printf("%s\n", comparison(how).run().dump().c_str());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "shadow_cascades: %s\n", e.what());
    return 1;
  }
  return 0;
}
