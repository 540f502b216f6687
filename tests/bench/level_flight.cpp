// A flight through a scene whose objects have levels of detail (docs/levels.md): pictures of one ray per pixel, with
// everything and with the set of the cell, each object at the level that its distance chooses. Counts pixels that
// differ, and the switches that the flight crosses.
#include <tbb/parallel_for.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/baked_scene.h"
#include "sightcell/scene/object_levels.h"
#include "verify/level_scene.h"

namespace {

using namespace sightcell;

struct flight_options {
  std::filesystem::path scene, file;
  std::vector<float> from, to;
  std::uint32_t frames = 100, headings = 2, width = 480, height = 270;
  double fov = 60.0;  // degrees, vertical
  bool drop = false;  // plants a fault: no coarser level is drawn
};

// What differs between the picture with everything and that with the set.
struct pixel_counts {
  std::uint64_t pixels = 0, at_levels = 0, differ = 0;
  std::uint64_t missed = 0;         // the set shows nothing, or what is farther than rule 2 allows
  std::uint64_t of_set = 0;         // of these: with level 0 of everything too
  std::uint64_t in_gaps = 0;        // of these: through a gap that is narrower than that of the bake
  std::uint64_t inside = 0;         // of these: all eight pixels around it show the same polygon
  std::uint64_t beside_misses = 0;  // of these: one of the eight pixels around it is missed too

  void add(const pixel_counts& other) {
    pixels += other.pixels, at_levels += other.at_levels, differ += other.differ, missed += other.missed;
    of_set += other.of_set, in_gaps += other.in_gaps, inside += other.inside, beside_misses += other.beside_misses;
  }
};

class flight {
 public:
  explicit flight(const flight_options& how) : how_(how), baked_(how.scene, how.file) {
    given_ = scene::load_object_levels(how.scene, s_);
    levels_.emplace(s_, opened_.rays().geometry(), given_, opened_.rules(), how.fov);
    all_.emplace(levels_->geometry(), opened_.rules().all_double_sided);
    in_set_.resize(s_.polygon_count);
    for (std::uint32_t p = 0; p < levels_->geometry().kinds.size(); ++p)
      if (levels_->object_of(p) != scene::no_index) examples_[levels_->object_of(p)].emplace(levels_->level_of(p), p);
    last_.assign(levels_->object_count(), scene::no_index);
    crossed_.assign(levels_->object_count(), 0);
  }

  nlohmann::ordered_json run() {
    const glm::vec3 from(how_.from[0], how_.from[1], how_.from[2]), to(how_.to[0], how_.to[1], how_.to[2]);
    const double ahead = std::atan2(static_cast<double>(to.x - from.x), -static_cast<double>(to.z - from.z));
    for (std::uint32_t i = 0; i < how_.frames; ++i) {
      const glm::vec3 eye =
          glm::mix(from, to, static_cast<float>(i) / static_cast<float>(std::max(how_.frames - 1, 1u)));
      note_switches(eye);
      if (!enter(eye)) {
        ++left_out_;
        continue;
      }
      for (std::uint32_t h = 0; h < how_.headings; ++h) look(eye, ahead + 2.0 * std::numbers::pi * h / how_.headings);
    }
    const double pixels = static_cast<double>(std::max<std::uint64_t>(sum_.pixels, 1));
    const auto objects = static_cast<std::uint32_t>(
        std::count_if(crossed_.begin(), crossed_.end(), [](std::uint32_t count) { return count > 0; }));
    return {{"scene", how_.scene.stem().string()},
            {"objects", levels_->object_count()},
            {"levels", levels_->level_count()},
            {"objects_that_switch", objects},
            {"switches", switches_},
            {"frames", frames_},
            {"positions_without_cell", left_out_},
            {"pixels", sum_.pixels},
            {"at_levels_percent", 100.0 * static_cast<double>(sum_.at_levels) / pixels},
            {"differ", static_cast<double>(sum_.differ) / pixels},
            {"missed", static_cast<double>(sum_.missed) / pixels},
            {"worst_frame", worst_},
            {"frames_with_misses", with_misses_},
            {"missed_pixels", sum_.missed},
            {"of_set", sum_.of_set},
            {"in_gaps", sum_.in_gaps},
            {"inside_polygons", sum_.inside},
            {"beside_misses", sum_.beside_misses}};
  }

 private:
  std::uint32_t level_at(std::uint32_t object, const glm::vec3& eye) const {
    for (const auto& [level, polygon] : examples_.at(object))
      if (levels_->is_drawn(polygon, eye)) return level;
    return scene::no_index - 1;  // none
  }

  void note_switches(const glm::vec3& eye) {
    for (std::uint32_t object = 0; object < levels_->object_count(); ++object) {
      const std::uint32_t level = level_at(object, eye);
      const std::uint32_t before = std::exchange(last_[object], level);
      if (before == scene::no_index || before == level) continue;
      ++crossed_[object];
      ++switches_;
    }
  }

  // Loads the set of the cell with the eye. Returns whether there is one and the eye is a valid viewpoint.
  bool enter(const glm::vec3& eye) {
    if (!opened_.rays().is_valid(eye, opened_.rules().player_radius)) return false;
    for (std::uint32_t cell = 0; cell < opened_.file().cell_count(); ++cell) {
      const bake::box box = opened_.cell_box(cell);
      if (glm::any(glm::lessThan(eye, box.min)) || glm::any(glm::greaterThan(eye, box.max))) continue;
      std::vector<std::uint32_t> ids;
      opened_.cell_set(cell, ids);
      std::fill(in_set_.begin(), in_set_.end(), std::uint8_t{0});
      for (const std::uint32_t id : ids) in_set_[id] = 1;
      levels_->find_visible(in_set_, visible_);
      return true;
    }
    return false;
  }

  bool host_draws(std::uint32_t polygon) const {
    if (polygon < in_set_.size()) return in_set_[polygon] != 0;
    return !how_.drop && visible_[levels_->object_of(polygon)] != 0;
  }

  void look(const glm::vec3& eye, double heading) {
    const glm::dvec3 forward(std::sin(heading), 0.0, -std::cos(heading)),
        right = glm::cross(forward, glm::dvec3(0, 1, 0));
    const double tangent = std::tan(how_.fov * std::numbers::pi / 360.0), wide = tangent * how_.width / how_.height;
    std::vector<std::uint32_t> shown(std::size_t{how_.width} * how_.height);
    std::vector<std::uint8_t> missing(shown.size(), 0);
    std::vector<pixel_counts> rows(how_.height);
    tbb::parallel_for(std::uint32_t{0}, how_.height, [&](std::uint32_t y) {
      for (std::uint32_t x = 0; x < how_.width; ++x) {
        const glm::dvec3 ray = forward + wide * (2.0 * (x + 0.5) / how_.width - 1.0) * right +
                               tangent * (1.0 - 2.0 * (y + 0.5) / how_.height) * glm::dvec3(0, 1, 0);
        const std::size_t at = std::size_t{y} * how_.width + x;
        compare(eye, glm::vec3(glm::normalize(ray)), rows[y], shown[at], missing[at]);
      }
    });
    pixel_counts frame;
    for (const pixel_counts& row : rows) frame.add(row);
    count_neighbors(shown, missing, frame);
    sum_.add(frame);
    ++frames_;
    with_misses_ += frame.missed > 0;
    worst_ = std::max(worst_, static_cast<double>(frame.missed) / static_cast<double>(frame.pixels));
  }

  void compare(const glm::vec3& eye, const glm::vec3& direction, pixel_counts& out, std::uint32_t& shown,
               std::uint8_t& missing) const {
    bake::sight what, with_set;
    all_->trace_against_set(
        eye, direction, [&](std::uint32_t p) { return levels_->is_drawn(p, eye); }, what);
    ++out.pixels;
    shown = what.front;
    float distance = what.distance;
    out.at_levels += shown != bake::no_polygon && levels_->level_of(shown) > 0;
    bool lacks = shown != bake::no_polygon && !host_draws(shown);
    for (const bake::passed_polygon& passed : what.before)
      if (!host_draws(passed.polygon)) lacks = true, distance = std::min(distance, passed.distance);
    if (!lacks) return;
    ++out.differ;
    const auto drawn = [&](std::uint32_t p) { return levels_->is_drawn(p, eye) && host_draws(p); };
    all_->trace_against_set(eye, direction, drawn, with_set);
    const auto nearest = [](const bake::sight& one) {
      float near = one.distance;
      for (const bake::passed_polygon& passed : one.before) near = std::min(near, passed.distance);
      return near;
    };
    if (nearest(with_set) <= distance + bake::coincidence_reach(distance)) return;
    missing = 1;
    ++out.missed;
    opened_.rays().trace(eye, direction, what);
    out.of_set += what.front != bake::no_polygon && in_set_[what.front] == 0;
    // As in verify --levels: where level 0 blocks the line, the ray passes where a coarser level covers less.
    const bool open = what.distance + bake::coincidence_reach(distance) >= distance;
    out.in_gaps += open && opened_.rays().through_gap(eye, direction, distance, opened_.rules().smallest_gap);
  }

  void count_neighbors(const std::vector<std::uint32_t>& shown, const std::vector<std::uint8_t>& missing,
                       pixel_counts& out) const {
    for (std::uint32_t y = 1; y + 1 < how_.height; ++y)
      for (std::uint32_t x = 1; x + 1 < how_.width; ++x) {
        const std::size_t at = std::size_t{y} * how_.width + x;
        if (missing[at] == 0) continue;
        bool same = true, other = false;
        for (std::size_t row = at - how_.width; row <= at + how_.width; row += how_.width)
          for (std::size_t i = row - 1; i <= row + 1; ++i)
            same = same && shown[i] == shown[at], other = other || (i != at && missing[i] != 0);
        out.inside += same;
        out.beside_misses += other;
      }
  }

  flight_options how_;
  bench::baked_scene baked_;
  const scene::scene& s_ = baked_.s;
  bake::verified_file& opened_ = baked_.opened;
  scene::object_levels given_;
  std::optional<bake::level_scene> levels_;
  std::optional<bake::ray_scene> all_;
  std::map<std::uint32_t, std::map<std::uint32_t, std::uint32_t>> examples_;  // a polygon by object and level
  std::vector<std::uint32_t> last_, crossed_;                                 // by object: level, switches
  std::vector<std::uint8_t> in_set_, visible_;
  std::uint64_t switches_ = 0, frames_ = 0, left_out_ = 0, with_misses_ = 0;
  pixel_counts sum_;
  double worst_ = 0.0;
};

}  // namespace

int main(int argc, char** argv) {
  flight_options how;
  CLI::App program{"A flight across switches of levels of detail, with the sets of a .pvs file and with everything."};
  program.add_option("SCENE", how.scene)->required();
  program.add_option("FILE", how.file)->required();
  program.add_option("--from", how.from, "x,y,z in meters.")->delimiter(',')->expected(3)->required();
  program.add_option("--to", how.to, "x,y,z in meters.")->delimiter(',')->expected(3)->required();
  program.add_option("--frames", how.frames, "Positions, evenly spread.");
  program.add_option("--headings", how.headings, "Per position; the first one is ahead.");
  program.add_option("--width", how.width)->check(CLI::Range(3, 8192));
  program.add_option("--height", how.height)->check(CLI::Range(3, 8192));
  program.add_option("--fov", how.fov, "Vertical, degrees.")->check(CLI::Range(1.0, 170.0));
  program.add_flag("--drop-levels", how.drop, "A planted fault: no coarser level is drawn.");
  CLI11_PARSE(program, argc, argv);
  try {
    std::printf("%s\n", flight(how).run().dump().c_str());
  } catch (const std::exception& e) {
    std::fprintf(stderr, "level_flight: %s\n", e.what());
    return 1;
  }
  return 0;
}
