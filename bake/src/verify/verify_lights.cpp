// The independent check of lights: it reads lights and their sets from the file.
#include "sightcell/bake/verify_lights.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "bound/clopper_pearson.h"
#include "bound/ray_trial.h"
#include "file/light_sets.h"
#include "sightcell/base/error.h"
#include "sightcell/base/random.h"
#include "trace/light_reach.h"
#include "verify/verified_file.h"

namespace sightcell::bake {
namespace {

constexpr std::uint64_t rays_of_chunk = 1024;
constexpr std::size_t reported_lit_polygons = 100;
constexpr float least_clearance = 1e-4f;  // meters: a light this close to a surface is measured too

class light_check {
 public:
  light_check(verified_file& opened, const std::string& name, const verify_settings& how)
      : opened_(opened), name_(name), how_(how), in_(opened.rays().geometry().kinds.size()) {
    const format::status s = lights_.open(opened.file());
    if (s == format::status::absent)
      throw error(error_kind::wrong_use, "pvs.no-lights", name, "has no lights", "bake it with --lights");
    require(s);
  }

  std::uint32_t count() const { return lights_.table().light_count(); }

  void check(std::uint32_t number, std::uint64_t rays, light_verification& result) {
    format::light_record record;
    require(lights_.table().light(number, record));
    const scene::light light = light_of(record);
    if (!opened_.rays().is_valid(position_of(light), least_clearance)) {
      ++result.inside_solids;
      return;
    }
    require(lights_.source_ids(number, ids_));
    std::fill(in_.begin(), in_.end(), std::uint8_t{0});
    for (const std::uint32_t polygon : ids_) in_[polygon] = 1;
    ++result.lights;
    result.rays += rays;
    std::vector<std::vector<missed_polygon>> chunks((rays + rays_of_chunk - 1) / rays_of_chunk);
    std::vector<std::uint64_t> misses(chunks.size());
    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) {
      const std::uint64_t size = std::min(rays_of_chunk, rays - i * rays_of_chunk);
      misses[i] = cast(light, size, random_stream(how_.seed, number, purpose::light_verify, 0, i), chunks[i]);
    });
    for (const std::uint64_t of_chunk : misses) result.misses += of_chunk;
    note_missing_lit(number, chunks, result.missing);
  }

 private:
  // Returns the number of misses; appends what is missing inside range and cone.
  std::uint64_t cast(const scene::light& light, std::uint64_t rays, random_stream random,
                     std::vector<missed_polygon>& missing) const {
    const visibility_rules rules{.smallest_gap = opened_.rules().smallest_gap};
    const std::function<bool(std::uint32_t)> contains = [this](std::uint32_t polygon) {
      return polygon >= opened_.file().polygon_count() || in_[polygon] != 0;
    };
    ray_trial trial(opened_.rays(), rules, contains);
    std::vector<missed_polygon> lacking;
    std::uint64_t misses = 0;
    sight seen;
    for (std::uint64_t i = 0; i < rays; ++i) {
      const sight_line line{position_of(light), random.on_sphere()};
      opened_.rays().trace(line.eye, line.direction, seen);
      lacking.clear();
      if (!trial.test(line, seen, random, lacking)) continue;
      std::erase_if(lacking, [&](const missed_polygon& one) {
        return !one.counts || !is_in_reach(light, one.eye + one.direction * one.distance);
      });
      misses += lacking.empty() ? 0 : 1;
      missing.insert(missing.end(), lacking.begin(), lacking.end());
    }
    return misses;
  }

  static void note_missing_lit(std::uint32_t light, const std::vector<std::vector<missed_polygon>>& chunks,
                               std::vector<missing_polygon>& missing) {
    std::map<std::uint32_t, missing_polygon> by_polygon;
    for (const std::vector<missed_polygon>& chunk : chunks)
      for (const missed_polygon& one : chunk) {
        missing_polygon& entry = by_polygon[one.polygon];
        if (entry.rays++ > 0) continue;
        const glm::vec3 target = one.eye + one.direction * one.distance;
        entry.cell = light;
        entry.polygon = one.polygon;
        entry.eye = {one.eye.x, one.eye.y, one.eye.z};
        entry.target = {target.x, target.y, target.z};
      }
    for (const auto& [polygon, entry] : by_polygon) missing.push_back(entry);
  }

  void require(format::status outcome) const {
    if (outcome != format::status::ok)
      throw error(error_kind::bad_input, "pvs.broken", name_, format::status_text(outcome), "bake it again");
  }

  verified_file& opened_;
  const std::string& name_;
  const verify_settings& how_;
  light_set_reader lights_;
  std::vector<std::uint8_t> in_;  // by polygon: of the set of the light
  std::vector<std::uint32_t> ids_;
};

}  // namespace

light_verification verify_lights(const scene::scene& s, std::span<const std::byte> file, const std::string& name,
                                 const verify_settings& how, const verify_progress& on_progress) {
  verified_file opened(s, how.cells_from, file, name);
  light_verification result;
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  arena.execute([&] {
    opened.build_rays();
    light_check check(opened, name, how);
    const std::uint64_t rays_each = std::max<std::uint64_t>((how.rays + check.count() - 1) / check.count(), 1);
    for (std::uint32_t light = 0; light < check.count(); ++light) {
      check.check(light, rays_each, result);
      if (on_progress) on_progress(light + 1, check.count());
    }
  });
  result.upper_bound = clopper_pearson_upper(result.misses, result.rays, result.confidence);
  std::stable_sort(result.missing.begin(), result.missing.end(),
                   [](const missing_polygon& a, const missing_polygon& b) { return a.rays > b.rays; });
  if (result.missing.size() > reported_lit_polygons) result.missing.resize(reported_lit_polygons);
  return result;
}

}  // namespace sightcell::bake
