#include "job/light_section.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "file/light_sets.h"
#include "job/cell_bake.h"
#include "job/cell_workers.h"
#include "job/memory_limit.h"
#include "search/coarser_levels.h"
#include "sightcell/base/error.h"
#include "sightcell/base/random.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/light_writer.h"
#include "sightcell/format/set_reader.h"
#include "trace/light_reach.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {
namespace {

// A light is a point. The search needs a box of viewpoints, and lamps are often close to what holds them.
constexpr float half_of_box = 0.01f, clearance = 0.002f;  // meters
// Far from the origin a float has larger steps.
constexpr float least_half = 1e-6f;  // of the largest coordinate

float half_around(const scene::light& light) {
  float largest = 0.0f;
  for (const float value : light.position) largest = std::max(largest, std::abs(value));
  return std::max(half_of_box, least_half * largest);
}

view_cell cell_around(const scene::light& light) {
  const glm::vec3 at = position_of(light);
  const float half = half_around(light);
  view_cell cell;
  cell.min = at - half, cell.max = at + half;
  for (const float value : light.position)
    cell.place = mix_bits(cell.place + 0x9E3779B97F4A7C15ull + std::bit_cast<std::uint32_t>(value + 0.0f));
  return cell;
}

// The settings of the search, which is for points and not for cameras.
settings settings_of_lights(const settings& how) {
  settings out = how;
  out.margin = 0.0f;
  out.player_radius = clearance;
  out.metric = {};
  return out;
}

void require_encoded(format::status outcome, const std::string& name) {
  if (outcome != format::status::ok)
    throw error(error_kind::failed, "output.encode", name, "its lights could not be encoded", "report this file");
}

// By polygon: the host transforms it and each set has it, wherever it is.
std::vector<bool> moving_polygons(const scene::scene& s, const scene::world_geometry& geometry) {
  std::vector<bool> moving(s.polygon_count);
  for (const scene::draw& d : s.draws) {
    if (!d.moves) continue;
    for (std::uint32_t polygon = d.first_source; polygon < d.first_source + d.polygon_count; ++polygon)
      moving[polygon] = geometry.kinds[polygon].always;
  }
  return moving;
}

// Those that do not move, as many as a file takes.
std::vector<scene::light> lights_of_scene(const scene::scene& s, const callbacks& events) {
  const auto warn = [&](const std::string& line) {
    if (events.on_message) events.on_message(severity::warning, line);
  };
  std::vector<scene::light> lights = s.lights;
  for (const std::string& line : s.light_warnings) warn(line);
  if (const auto moving = std::erase_if(lights, [](const scene::light& one) { return one.moves; }); moving > 0)
    warn(fmt::format("{} lights move: they are left out", moving));
  if (lights.size() > format::layout::max_lights) {
    warn(fmt::format("the scene has {} lights: the file has the first {}", lights.size(), format::layout::max_lights));
    lights.resize(format::layout::max_lights);
  }
  if (lights.empty()) warn("the scene has no point or spot light: the file has no lights");
  return lights;
}

class light_section {
 public:
  light_section(const bake_context& context, std::vector<scene::light> lights)
      : context_(context),
        geometry_(context.input.geometry),
        how_(settings_of_lights(context.how)),
        lights_(std::move(lights)),
        moving_(moving_polygons(context.s, geometry_)),
        sampler_(make_cell_sampler(
            how_, {context.traced->rays, context.device->source(), nullptr, {}, context.traced->neighbors_or_null()})),
        baker_(how_, none_, context.traced->rays, context.traced->neighbors_or_null(), context.traced->duplicates,
               *sampler_, pixel_metric, nullptr,
               context.s.polygon_count) {}

  // Returns false if it was canceled.
  bool find(const callbacks& events) {
    const std::size_t workers = worker_count(tbb::this_task_arena::max_concurrency(), baker_.set_bytes());
    const std::size_t group =
        std::min(workers_that_fit(workers, memory_of_worker(geometry_.kinds.size(), baker_.set_bytes(), how_), how_),
                 lights_.size());
    std::vector<cell_set> sets;
    for (std::size_t i = 0; i < group; ++i) sets.push_back(baker_.make_set());
    records_.resize(lights_.size());
    for (std::size_t done = 0; done < lights_.size();) {
      const std::size_t count = std::min(group, lights_.size() - done);
      tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        // A thread that waits for rays begins no other light meanwhile.
        tbb::this_task_arena::isolate([&] { records_[done + i] = search(lights_[done + i], sets[i]); });
      });
      done += count;
      progress now;
      now.phase = bake_phase::finding_lights;
      now.cells_done = now.cells_checked = now.cells_total = context_.cells->blocks.cell_count();
      now.lights = static_cast<double>(done) / static_cast<double>(lights_.size());
      if (events.on_progress && !events.on_progress(now)) return false;
    }
    return true;
  }

  std::vector<std::byte> with_section(std::span<const std::byte> bytes, const std::string& name,
                                      light_summary& sum) const {
    format::reader file;
    format::set_reader seen;
    require_encoded(format::reader::open(bytes, file), name);
    require_encoded(seen.open(file), name);
    std::vector<std::vector<std::uint32_t>> sets, at_rest;
    std::vector<format::certificate_record> proofs;
    format::light_source source;
    for (std::size_t i = 0; i < lights_.size(); ++i) {
      source.lights.push_back(record_of_light(lights_[i]));
      proofs.push_back(proof_of(records_[i]));
      sets.push_back(records_[i].set);
      std::erase_if(at_rest.emplace_back(sets.back()), [this](std::uint32_t polygon) { return moving_[polygon]; });
    }
    source.sets = format::sets_of(sets);
    source.certificate = proofs;
    marked_set of_cell(file.polygon_count());
    std::uint32_t marked = file.cell_count();  // the cell that of_cell is of
    std::uint64_t touching = 0;
    source.touches = [&](std::uint32_t cell, std::uint32_t light) {
      if (cell != marked) {
        std::vector<std::uint32_t> set;
        require_encoded(seen.source_ids(cell, set), name);
        of_cell.mark(std::move(set));
        marked = cell;
      }
      const bool touches = of_cell.meets(at_rest[light]);
      touching += touches ? 1 : 0;
      return touches;
    };
    std::vector<std::byte> made;
    require_encoded(format::put_lights(bytes, source, made), name);
    sum = summed();
    sum.lights_per_cell = static_cast<double>(touching) / std::max(file.cell_count(), 1u);
    return made;
  }

 private:
  cell_record search(const scene::light& light, cell_set& set) const {
    cell_record record = baker_.sample_and_finish(cell_around(light), set);
    const float slack = std::sqrt(3.0f) * half_around(light);
    std::erase_if(record.set, [&](std::uint32_t polygon) {
      return !moving_[polygon] && !may_reach(light, corners_of(geometry_, polygon), slack);
    });
    add_coarser_levels(geometry_.lods, record.set);
    record.witnesses = {};
    record.witness_of = {};
    return record;
  }

  // A light inside a solid has none.
  format::certificate_record proof_of(const cell_record& record) const {
    if (!record.stored) return {.upper_bound = 1.0, .confidence = 0.0, .seed = how_.seed};
    return {.rays = record.rays,
            .misses = record.misses,
            .upper_bound = record.upper_bound,
            .confidence = record.confidence,
            .seed = how_.seed};
  }

  light_summary summed() const {
    light_summary sum;
    sum.lights = static_cast<std::uint32_t>(lights_.size());
    for (const cell_record& record : records_) {
      sum.rays += record.rays_spent;
      sum.polygons_per_light += static_cast<double>(record.set.size()) / static_cast<double>(lights_.size());
      if (!record.stored) {
        ++sum.inside_solids;
        continue;
      }
      sum.max_upper_bound = std::max(sum.max_upper_bound, record.upper_bound);
      sum.over_bound += record.bound_met ? 0 : 1;
    }
    return sum;
  }

  const bake_context& context_;
  const scene::world_geometry& geometry_;
  const settings how_;
  const std::vector<scene::light> lights_;
  const std::vector<bool> moving_;
  const overrides none_{};
  std::unique_ptr<cell_sampler> sampler_;
  cell_baker baker_;
  std::vector<cell_record> records_;  // by light
};

}  // namespace

file_completion lights_of(const bake_context& context, const std::filesystem::path& output, const callbacks& events,
                          std::optional<light_summary>& found) {
  if (!context.how.lights) return {};
  return [&](std::vector<std::byte>& file) {
    if (events.on_phase) events.on_phase(bake_phase::finding_lights);
    found.emplace();
    std::vector<scene::light> lights = lights_of_scene(context.s, events);
    if (lights.empty()) return true;
    light_section section(context, std::move(lights));
    if (!section.find(events)) return false;
    file = section.with_section(file, output.string(), *found);
    if (found->inside_solids > 0 && events.on_message)
      events.on_message(
          severity::warning,
          fmt::format("{} of {} lights are inside solids and reach nothing: mark the lamps around them as "
                      "non-occluders",
                      found->inside_solids, found->lights));
    return true;
  };
}

}  // namespace sightcell::bake
