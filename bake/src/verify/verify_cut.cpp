// Rays at the cut that a host draws. Viewpoints, directions and random numbers are those of verify(), so a cut without
// error has its misses. Each ray compares what the host draws with the cut drawn whole, and this with level 0.
#include "sightcell/bake/verify_cut.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "bound/clopper_pearson.h"
#include "sightcell/base/error.h"
#include "trace/triangle_math.h"
#include "verify/cut_scene.h"
#include "verify/each_cell.h"
#include "verify/verified_file.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t counted_views = 4;  // per cell

void validate_cut(const cut_settings& cut) {
  const auto refuse = [](const char* option, double value, const char* how) {
    throw error(error_kind::wrong_use, "settings.out-of-range", option, "is " + std::to_string(value), how);
  };
  for (const double pixels : cut.pixels)
    if (!(pixels >= 0.0 && pixels <= 1e6)) refuse("--cut", pixels, "give 0 to 1000000 pixels");
  if (cut.rows == 0) refuse("--cut-rows", 0.0, "give at least 1");
  if (!(cut.fov > 0.0 && cut.fov < 180.0)) refuse("--cut-fov", cut.fov, "give degrees above 0 and below 180");
}

// A ray whose first cluster is not visible.
struct missed_cluster {
  std::uint32_t cluster = 0;
  cut_miss kind = cut_miss::of_set;
  glm::vec3 eye{0.0f}, target{0.0f};
};

struct part_result {
  std::uint64_t rays = 0, in_gaps = 0, opened = 0, opened_beyond_error = 0;
  std::vector<missed_cluster> missed;
  std::vector<glm::vec3> eyes;  // some
};

// Where what a host draws for one number of pixels is counted.
class cut_meter {
 public:
  cut_meter(const cut_scene& levels, const cut_settings& cut, double pixels)
      : levels_(levels),
        error_at_1_(static_cast<float>(pixels * 2.0 * std::tan(cut.fov * std::numbers::pi / 360.0) / cut.rows)) {
    result_.pixels = pixels;
    result_.leaf_clusters = levels.leaf_count();
    result_.coarse_clusters = levels.cluster_count() - levels.leaf_count();
  }

  float error_at_1() const { return error_at_1_; }

  void add(std::uint32_t cell, const std::vector<part_result>& parts, std::size_t set_size,
           const std::vector<std::uint8_t>& visible) {
    cell_verification one{.cell = cell};
    std::vector<glm::vec3> eyes;
    std::map<std::pair<cut_miss, std::uint32_t>, missing_cluster> missing;
    for (const part_result& part : parts) {
      one.rays += part.rays;
      one.misses += part.missed.size();
      for (const missed_cluster& missed : part.missed) note(cell, missed, missing[{missed.kind, missed.cluster}]);
      result_.rays_in_gaps += part.in_gaps;
      result_.rays_opened += part.opened;
      result_.rays_opened_beyond_error += part.opened_beyond_error;
      if (eyes.size() < counted_views) eyes.insert(eyes.end(), part.eyes.begin(), part.eyes.end());
    }
    for (const auto& [key, entry] : missing) result_.missing.push_back(entry);
    one.error = one.rays > 0 ? static_cast<double>(one.misses) / static_cast<double>(one.rays) : 0.0;
    one.upper_bound = clopper_pearson_upper(one.misses, one.rays, result_.confidence);
    result_.rays += one.rays;
    result_.misses += one.misses;
    result_.cells.push_back(one);
    result_.set_polygons += static_cast<double>(set_size);
    eyes.resize(std::min(eyes.size(), counted_views));
    count(eyes, visible);
  }

  cut_verification finished() {
    const double cells = std::max<double>(1.0, static_cast<double>(result_.cells.size()));
    for (double* mean :
         {&result_.cut_clusters, &result_.cut_triangles, &result_.drawn_clusters, &result_.drawn_triangles,
          &result_.set_clusters, &result_.set_cluster_polygons, &result_.set_polygons})
      *mean /= cells;
    finish(result_);
    return std::move(result_);
  }

 private:
  void note(std::uint32_t cell, const missed_cluster& missed, missing_cluster& entry) {
    const bool leaf = levels_.is_leaf(missed.cluster);
    result_.misses_of_leaves += leaf ? 1 : 0;
    ++(missed.kind == cut_miss::of_set      ? result_.misses_of_set
       : missed.kind == cut_miss::at_coarse ? result_.misses_at_coarse
                                            : result_.misses_revealed);
    if (entry.rays++ > 0) return;
    entry.kind = missed.kind;
    entry.cell = cell;
    entry.draw = levels_.draw_of(missed.cluster);
    entry.cluster = levels_.number_in_draw(missed.cluster);
    entry.leaf = leaf;
    entry.eye = {missed.eye.x, missed.eye.y, missed.eye.z};
    entry.target = {missed.target.x, missed.target.y, missed.target.z};
  }

  void count(const std::vector<glm::vec3>& eyes, const std::vector<std::uint8_t>& visible) {
    const double share = 1.0 / std::max<double>(1.0, static_cast<double>(eyes.size()));
    for (std::uint32_t c = 0; c < levels_.cluster_count(); ++c) {
      const auto triangles = static_cast<double>(levels_.triangles_of(c));
      if (levels_.is_leaf(c) && visible[c]) result_.set_clusters += 1.0, result_.set_cluster_polygons += triangles;
      for (const glm::vec3& eye : eyes) {
        if (!levels_.in_cut(c, eye, error_at_1_)) continue;
        result_.cut_clusters += share, result_.cut_triangles += share * triangles;
        if (visible[c]) result_.drawn_clusters += share, result_.drawn_triangles += share * triangles;
      }
    }
  }

  const cut_scene& levels_;
  float error_at_1_;
  cut_verification result_;
};

class cut_check {
 public:
  cut_check(const scene::scene& s, verified_file& opened, const verify_settings& how, const cut_settings& cut)
      : opened_(opened),
        how_(how),
        levels_(s, opened.rays().geometry()),
        all_(levels_.geometry(), opened.rules().all_double_sided),
        in_set_(s.polygon_count) {
    for (const double pixels : cut.pixels) meters_.emplace_back(levels_, cut, pixels);
  }

  void check(std::uint32_t cell, std::uint64_t rays) {
    std::vector<std::uint32_t> set;
    opened_.cell_set(cell, set);
    std::fill(in_set_.begin(), in_set_.end(), std::uint8_t{0});
    for (const std::uint32_t polygon : set) in_set_[polygon] = 1;
    levels_.find_visible([&](std::uint32_t polygon) { return in_set_[polygon] != 0; }, visible_);
    for (cut_meter& meter : meters_) {
      const auto cast_one = [&](const sight_line& line, part_result& part) { cast(line, meter.error_at_1(), part); };
      meter.add(cell, cast_lines<part_result>(opened_, how_.seed, cell, rays, cast_one), set.size(), visible_);
    }
  }

  std::vector<cut_verification> finished() {
    std::vector<cut_verification> out;
    for (cut_meter& meter : meters_) out.push_back(meter.finished());
    return out;
  }

 private:
  using filter = std::function<bool(std::uint32_t)>;

  void cast(const sight_line& line, float error_at_1, part_result& part) const {
    if (part.eyes.size() < counted_views) part.eyes.push_back(line.eye);
    const filter in_cut = [&](std::uint32_t polygon) {
      return levels_.in_cut(levels_.cluster_of(polygon), line.eye, error_at_1);
    };
    sight whole, finest;  // along the line, of the whole cut and of level 0
    all_.trace_against_set(line.eye, line.direction, in_cut, whole);
    opened_.rays().trace(line.eye, line.direction, finest);
    if (finest.front != no_polygon && is_behind(whole.distance, finest.distance, error_at_1)) {
      ++part.opened;
      part.opened_beyond_error += is_near_cut(line, finest.distance, error_at_1, in_cut) ? 0 : 1;
    }
    bool gap = false;
    const std::optional<passed_polygon> wrong = first_wrong(whole, [&](std::uint32_t polygon, float distance) {
      if (is_drawn(line, polygon, distance, in_cut)) return true;
      const bool excused = is_in_gap(line, std::min(distance, finest.distance));
      gap = gap || excused;
      return excused;
    });
    if (!wrong) {
      part.in_gaps += gap ? 1 : 0;
      return;
    }
    const std::uint32_t cluster = levels_.cluster_of(wrong->polygon);
    const bool revealed = levels_.is_leaf(cluster) || is_behind(wrong->distance, finest.distance, error_at_1);
    const cut_miss kind = lacks_polygons(opened_, line, finest, in_set_) ? cut_miss::of_set
                          : revealed                                     ? cut_miss::revealed
                                                                         : cut_miss::at_coarse;
    part.missed.push_back({cluster, kind, line.eye, line.eye + wrong->distance * line.direction});
  }

  // Returns whether a host draws a polygon of the cut, or one in the same place (rule 2).
  bool is_drawn(const sight_line& line, std::uint32_t polygon, float distance, const filter& in_cut) const {
    const auto visible = [&](std::uint32_t one) { return visible_[levels_.cluster_of(one)] != 0; };
    if (visible(polygon)) return true;
    std::vector<std::uint32_t> same;
    all_.coincident(line.eye, line.direction, distance, same);
    return std::any_of(same.begin(), same.end(), [&](std::uint32_t one) { return visible(one) && in_cut(one); });
  }

  // Rule 3, for gaps of level 0. distance: no farther than where level 0 blocks the line. Behind that, the parallel
  // lines of the rule are blocked too, and an opening of the cut of any width would pass for a narrow gap.
  bool is_in_gap(const sight_line& line, float distance) const {
    return opened_.rays().through_gap(line.eye, line.direction, distance, opened_.rules().smallest_gap);
  }

  // Returns whether a distance is behind that of level 0 by more than rule 3 and the error of the cut allow.
  static bool is_behind(float distance, float of_level_0, float error_at_1) {
    return distance > of_level_0 + std::max({0.02f, 0.01f * of_level_0, error_at_1 * of_level_0});
  }

  // Returns whether a polygon of the cut is within its error of where level 0 blocks a line.
  bool is_near_cut(const sight_line& line, float distance, float error_at_1, const filter& in_cut) const {
    const glm::vec3 point = line.eye + distance * line.direction;
    const float reach = error_at_1 * distance + coincidence_reach(distance);
    const std::vector<std::uint32_t> around = all_.touching(point - reach, point + reach);
    return std::any_of(around.begin(), around.end(), [&](std::uint32_t polygon) {
      return in_cut(polygon) && distance_to_triangle(point, bake::corners_of(levels_.geometry(), polygon)) <= reach;
    });
  }

  verified_file& opened_;
  const verify_settings& how_;
  cut_scene levels_;
  ray_scene all_;  // all levels; rays ignore what is not in the cut
  std::vector<cut_meter> meters_;
  std::vector<std::uint8_t> in_set_;   // by polygon of the scene, for the cell
  std::vector<std::uint8_t> visible_;  // by cluster, for the cell
};

}  // namespace

std::vector<cut_verification> verify_cut(const scene::scene& s, std::span<const std::byte> file,
                                         const std::string& name, const verify_settings& how, const cut_settings& cut,
                                         const verify_progress& on_progress) {
  validate_cut(cut);
  verified_file opened(s, how.cells_from, file, name);
  std::vector<cut_verification> result;
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  arena.execute([&] {
    opened.build_rays();
    cut_check check(s, opened, how, cut);
    each_cell(opened, how, on_progress, [&](std::uint32_t cell, std::uint64_t rays) { check.check(cell, rays); });
    result = check.finished();
  });
  return result;
}

}  // namespace sightcell::bake
