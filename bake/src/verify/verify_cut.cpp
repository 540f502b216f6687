// Rays at the cut that a host draws. Viewpoints, directions and random numbers are those of verify(), so a cut without
// error has its misses.
#include "sightcell/bake/verify_cut.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "bound/clopper_pearson.h"
#include "bound/metric.h"
#include "sightcell/base/error.h"
#include "trace/viewpoints.h"
#include "verify/cut_scene.h"
#include "verify/verified_file.h"

namespace sightcell::bake {
namespace {

constexpr std::uint64_t rays_of_part = 512, most_tries_per_ray = 256;
constexpr std::size_t counted_views = 4;  // per cell
constexpr std::size_t reported_clusters = 100;

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
  glm::vec3 eye{0.0f}, target{0.0f};
};

struct part_result {
  std::uint64_t rays = 0;
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
    std::map<std::uint32_t, missing_cluster> missing;
    for (const part_result& part : parts) {
      one.rays += part.rays;
      one.misses += part.missed.size();
      for (const missed_cluster& missed : part.missed) note(cell, missed, missing[missed.cluster]);
      if (eyes.size() < counted_views) eyes.insert(eyes.end(), part.eyes.begin(), part.eyes.end());
    }
    for (const auto& [cluster, entry] : missing) result_.missing.push_back(entry);
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
    if (result_.rays > 0) result_.pixel_error = static_cast<double>(result_.misses) / static_cast<double>(result_.rays);
    result_.upper_bound = clopper_pearson_upper(result_.misses, result_.rays, result_.confidence);
    std::stable_sort(result_.missing.begin(), result_.missing.end(),
                     [](const missing_cluster& a, const missing_cluster& b) { return a.rays > b.rays; });
    if (result_.missing.size() > reported_clusters) result_.missing.resize(reported_clusters);
    return std::move(result_);
  }

 private:
  void note(std::uint32_t cell, const missed_cluster& missed, missing_cluster& entry) {
    const bool leaf = levels_.is_leaf(missed.cluster);
    result_.misses_of_leaves += leaf ? 1 : 0;
    if (entry.rays++ > 0) return;
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
        all_(levels_.geometry(), opened.rules().all_double_sided) {
    for (const double pixels : cut.pixels) meters_.emplace_back(levels_, cut, pixels);
  }

  void check(std::uint32_t cell, std::uint64_t rays) {
    std::vector<std::uint32_t> set;
    opened_.cell_set(cell, set);
    levels_.find_visible([&](std::uint32_t polygon) { return std::binary_search(set.begin(), set.end(), polygon); },
                         visible_);
    const viewpoint_region region = opened_.region(cell);
    std::vector<part_result> parts((rays + rays_of_part - 1) / rays_of_part);
    for (cut_meter& meter : meters_) {
      tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
        parts[i] = cast(cell, region, i, std::min(rays_of_part, rays - i * rays_of_part), meter.error_at_1());
      });
      meter.add(cell, parts, set.size(), visible_);
    }
  }

  std::vector<cut_verification> finished() {
    std::vector<cut_verification> out;
    for (cut_meter& meter : meters_) out.push_back(meter.finished());
    return out;
  }

 private:
  part_result cast(std::uint32_t cell, const viewpoint_region& region, std::uint64_t part, std::uint64_t rays,
                   float error_at_1) const {
    part_result out;
    random_stream random(how_.seed, cell, purpose::verify, 0, part);
    std::uint64_t tries = 0;
    const std::vector<glm::vec3> eyes = draw_viewpoints(opened_.rays(), region, opened_.rules().player_radius, rays,
                                                        rays * most_tries_per_ray, random, tries);
    out.rays = eyes.size();
    out.eyes.assign(eyes.begin(), eyes.begin() + static_cast<std::ptrdiff_t>(std::min(eyes.size(), counted_views)));
    sight seen;
    for (const glm::vec3& eye : eyes) {
      const sight_line line{eye, pixel_metric.direction(random)};
      const std::function<bool(std::uint32_t)> in_cut = [&](std::uint32_t polygon) {
        return levels_.in_cut(levels_.cluster_of(polygon), eye, error_at_1);
      };
      all_.trace_against_set(line.eye, line.direction, in_cut, seen);
      const std::optional<passed_polygon> wrong = first_wrong(line, seen, in_cut);
      if (wrong)
        out.missed.push_back({levels_.cluster_of(wrong->polygon), eye, eye + wrong->distance * line.direction});
    }
    return out;
  }

  // Returns what a ray met and the host does not draw.
  std::optional<passed_polygon> first_wrong(const sight_line& line, const sight& seen,
                                            const std::function<bool(std::uint32_t)>& in_cut) const {
    if (seen.front != no_polygon && !is_right(line, seen.front, seen.distance, in_cut))
      return passed_polygon{seen.front, seen.distance};
    for (const passed_polygon& passed : seen.before)
      if (!is_right(line, passed.polygon, passed.distance, in_cut)) return passed;
    return std::nullopt;
  }

  // Rules 2 and 3 excuse as in verify(). Gaps are those of the scene.
  bool is_right(const sight_line& line, std::uint32_t polygon, float distance,
                const std::function<bool(std::uint32_t)>& in_cut) const {
    const auto visible = [&](std::uint32_t one) { return visible_[levels_.cluster_of(one)] != 0; };
    if (visible(polygon)) return true;
    if (opened_.rays().through_gap(line.eye, line.direction, distance, opened_.rules().smallest_gap)) return true;
    std::vector<std::uint32_t> same;
    all_.coincident(line.eye, line.direction, distance, same);
    return std::any_of(same.begin(), same.end(), [&](std::uint32_t one) { return visible(one) && in_cut(one); });
  }

  verified_file& opened_;
  const verify_settings& how_;
  cut_scene levels_;
  ray_scene all_;  // all levels; rays ignore what is not in the cut
  std::vector<cut_meter> meters_;
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
    const std::uint32_t stored = opened.file().cell_count();
    const std::uint32_t chosen = how.cells == 0 ? stored : std::min(how.cells, stored);
    const std::uint64_t rays_each = std::max<std::uint64_t>((how.rays + chosen - 1) / std::max(chosen, 1u), 1);
    for (std::uint32_t i = 0; i < chosen; ++i) {
      check.check(static_cast<std::uint32_t>(std::uint64_t{i} * stored / chosen), rays_each);
      if (on_progress) on_progress(i + 1, chosen);
    }
    result = check.finished();
  });
  return result;
}

}  // namespace sightcell::bake
