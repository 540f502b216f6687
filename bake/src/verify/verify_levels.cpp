// Rays at the levels of objects that a host draws. Viewpoints, directions and random numbers are those of verify().
#include "sightcell/bake/verify_levels.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include "bound/clopper_pearson.h"
#include "sightcell/base/error.h"
#include "sightcell/scene/object_levels.h"
#include "verify/each_cell.h"
#include "verify/level_scene.h"
#include "verify/verified_file.h"

namespace sightcell::bake {
namespace {

// A ray that met what is not drawn.
struct missed_level {
  sight_line line;
  passed_polygon hit;
};

struct level_part {
  std::uint64_t rays = 0, at_levels = 0;
  std::vector<missed_level> missed;
};

class level_check {
 public:
  level_check(const scene::scene& s, verified_file& opened, const verify_settings& how,
              const scene::object_levels& levels, double fov)
      : scene_(s),
        opened_(opened),
        how_(how),
        levels_(s, opened.rays().geometry(), levels, opened.rules(), fov),
        all_(levels_.geometry(), opened.rules().all_double_sided),
        in_set_(s.polygon_count) {
    result_.objects = levels_.object_count();
    result_.levels = levels_.level_count();
    result_.levels_without_switch = levels_.levels_without_switch();
    if (result_.levels == result_.levels_without_switch)
      throw error(error_kind::bad_input, "scene.no-levels", s.name,
                  "has no object with a coarser level and the distance or coverage where it begins",
                  "give levels by MSFT_lod with MSFT_screencoverage or by extras.sightcell.level_of, or omit --levels");
  }

  void check(std::uint32_t cell, std::uint64_t rays) {
    std::vector<std::uint32_t> set;
    opened_.cell_set(cell, set);
    std::fill(in_set_.begin(), in_set_.end(), std::uint8_t{0});
    for (const std::uint32_t polygon : set) in_set_[polygon] = 1;
    levels_.find_visible(in_set_, visible_);
    const auto cast_one = [this](const sight_line& line, level_part& part) { cast(line, part); };
    add(cell, cast_lines<level_part>(opened_, how_.seed, cell, rays, cast_one));
  }

  level_verification finished() {
    finish(result_);
    return std::move(result_);
  }

 private:
  void cast(const sight_line& line, level_part& part) const {
    sight seen;
    const std::function<bool(std::uint32_t)> drawn = [&](std::uint32_t p) { return levels_.is_drawn(p, line.eye); };
    all_.trace_against_set(line.eye, line.direction, drawn, seen);
    if (seen.front != no_polygon && levels_.level_of(seen.front) > 0) ++part.at_levels;
    const auto right = [&](std::uint32_t polygon, float distance) { return is_right(line, polygon, distance, drawn); };
    if (const std::optional<passed_polygon> wrong = first_wrong(seen, right)) part.missed.push_back({line, *wrong});
  }

  // Returns whether the host draws a polygon that the distance of its object chooses.
  bool is_visible(std::uint32_t polygon) const {
    return polygon < in_set_.size() ? in_set_[polygon] != 0 : visible_[levels_.object_of(polygon)] != 0;
  }

  // Rules 2 and 3 excuse as in verify(). Gaps are those of the scene: where its polygons block the line, the ray is not
  // in a gap of the scene, but passes where a coarser level covers less.
  bool is_right(const sight_line& line, std::uint32_t polygon, float distance,
                const std::function<bool(std::uint32_t)>& drawn) const {
    if (is_visible(polygon)) return true;
    sight without;
    opened_.rays().trace(line.eye, line.direction, without);
    const bool open = without.distance + coincidence_reach(distance) >= distance;
    if (open && opened_.rays().through_gap(line.eye, line.direction, distance, opened_.rules().smallest_gap))
      return true;
    std::vector<std::uint32_t> same;
    all_.coincident(line.eye, line.direction, distance, same);
    return std::any_of(same.begin(), same.end(), [&](std::uint32_t one) { return drawn(one) && is_visible(one); });
  }

  void add(std::uint32_t cell, const std::vector<level_part>& parts) {
    cell_verification one{.cell = cell};
    std::map<std::tuple<level_miss, std::uint32_t, std::uint32_t>, missing_at_levels> missing;
    for (const level_part& part : parts) {
      one.rays += part.rays;
      one.misses += part.missed.size();
      result_.rays_at_levels += part.at_levels;
      for (const missed_level& missed : part.missed) {
        missing_at_levels entry = described(cell, missed);
        ++(entry.kind == level_miss::of_set     ? result_.misses_of_set
           : entry.kind == level_miss::at_level ? result_.misses_at_levels
                                                : result_.misses_revealed);
        ++missing.try_emplace({entry.kind, entry.draw, entry.level}, entry).first->second.rays;
      }
    }
    for (const auto& [key, entry] : missing) result_.missing.push_back(entry);
    one.error = one.rays > 0 ? static_cast<double>(one.misses) / static_cast<double>(one.rays) : 0.0;
    one.upper_bound = clopper_pearson_upper(one.misses, one.rays, result_.confidence);
    result_.rays += one.rays;
    result_.misses += one.misses;
    result_.cells.push_back(one);
  }

  missing_at_levels described(std::uint32_t cell, const missed_level& missed) const {
    const sight_line& line = missed.line;
    missing_at_levels out{.cell = cell, .level = levels_.level_of(missed.hit.polygon)};
    const bool of_scene = out.level == 0;
    out.polygon = of_scene ? missed.hit.polygon : scene::no_index;
    out.draw =
        of_scene ? scene::draw_of(scene_, out.polygon) : levels_.first_draw(levels_.object_of(missed.hit.polygon));
    sight without;
    opened_.rays().trace(line.eye, line.direction, without);
    out.before = without.front == no_polygon ? scene::no_index : scene::draw_of(scene_, without.front);
    const bool misses_too = lacks_polygons(opened_, line, without, in_set_);
    out.kind = misses_too ? level_miss::of_set : of_scene ? level_miss::revealed : level_miss::at_level;
    const glm::vec3 target = line.eye + missed.hit.distance * line.direction;
    out.eye = {line.eye.x, line.eye.y, line.eye.z};
    out.target = {target.x, target.y, target.z};
    return out;
  }

  const scene::scene& scene_;
  verified_file& opened_;
  const verify_settings& how_;
  level_scene levels_;
  ray_scene all_;                      // all levels; rays ignore what is not drawn
  std::vector<std::uint8_t> in_set_;   // by polygon of the scene, for the cell
  std::vector<std::uint8_t> visible_;  // by object, for the cell
  level_verification result_;
};

}  // namespace

level_verification verify_levels(const scene::scene& s, const scene::object_levels& levels,
                                 std::span<const std::byte> file, const std::string& name, const verify_settings& how,
                                 double fov, const verify_progress& on_progress) {
  if (!(fov > 0.0 && fov < 180.0))
    throw error(error_kind::wrong_use, "settings.out-of-range", "--levels-fov", "is " + std::to_string(fov),
                "give degrees above 0 and below 180");
  verified_file opened(s, how.cells_from, file, name);
  level_verification result;
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  arena.execute([&] {
    opened.build_rays();
    level_check check(s, opened, how, levels, fov);
    each_cell(opened, how, on_progress, [&](std::uint32_t cell, std::uint64_t rays) { check.check(cell, rays); });
    result = check.finished();
  });
  return result;
}

}  // namespace sightcell::bake
