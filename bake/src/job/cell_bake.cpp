#include "job/cell_bake.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <iterator>

#include "bound/cell_eyes.h"
#include "bound/explore_viewpoints.h"
#include "misses/join_misses.h"
#include "search/coarser_levels.h"
#include "search/dilation.h"
#include "search/refinement.h"
#include "search/volume_search.h"
#include "trace/triangle_math.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

// The shares of --seconds-per-cell until which the stages may work. What a stage leaves, the next ones have.
constexpr double sampling_time = 0.4, bounding_time = 0.9;
constexpr double neighbor_time = 0.25;          // of the time for the bound: the neighbor check before it
constexpr std::size_t viewpoints_wanted = 128;  // for cubes inside the cell and the test of polygons inside

void take_bound(const finish_result& proof, cell_record& record) {
  record.rays = proof.rays;
  record.misses = proof.misses;
  record.upper_bound = proof.upper_bound;
  record.confidence = proof.confidence;
  record.bound_met = proof.bound_met;
  record.of_bound = proof.of_bound;
}

}  // namespace

cell_baker::cell_baker(const settings& how, const overrides& given, const ray_scene& rays,
                       const near_polygons* neighbors, const duplicate_classes& duplicates, const cell_sampler& sampler,
                       const error_metric& metric, const reported_misses* misses, std::uint32_t own_polygons,
                       const volume_grid* volumes)
    : how_(how),
      given_(given),
      rays_(rays),
      neighbors_(neighbors),
      duplicates_(duplicates),
      sampler_(sampler),
      metric_(metric),
      misses_(misses),
      own_polygons_(own_polygons),
      volumes_(volumes) {
  const auto& kinds = rays.geometry().kinds;
  for (std::uint32_t polygon = 0; polygon < kinds.size(); ++polygon)
    if (kinds[polygon].always) always_.push_back(polygon);
}

cell_set cell_baker::make_set() const {
  return cell_set(static_cast<std::uint32_t>(rays_.geometry().kinds.size()), &duplicates_, own_polygons_,
                  volumes_ ? volumes_->count() : 0);
}

std::size_t cell_baker::set_bytes() const {
  return cell_set::bytes_for(rays_.geometry().kinds.size()) + (volumes_ ? volume_search_bytes(*volumes_) : 0);
}

// A damaged record has a checksum that fails, so the bytes are those of encode().
viewpoint_region cell_baker::region_of(const view_cell& cell, const cell_record& record) const {
  return viewpoint_region::decode(grown(cell), record.region).value_or(viewpoint_region(grown(cell)));
}

// The limit of a stage: the stages up to it together may take this share of --seconds-per-cell. A stage whose time is
// used up still does the least that it can.
time_limit cell_baker::limit_until(double share, const cell_record& record, stop_request* stop) const {
  const double cap = how_.seconds_per_cell;
  const double left = cap > 0.0 ? std::max(share * cap - record.seconds, 1e-9) : 0.0;
  return {left, !sampler_.uses_device(), stop};
}

// Without the option a record must not depend on time.
void cell_baker::note_time(const time_limit& limit, cell_record& record) const {
  if (limit.has_time()) record.seconds += limit.spent();
}

cell_record cell_baker::sample(const view_cell& cell, cell_set& set, stop_request* stop,
                               const found_before* before) const {
  return sample(cell, set, limit_until(how_.max_pixel_error > 0.0 ? sampling_time : 1.0, {}, stop), before);
}

cell_record cell_baker::sample(const view_cell& cell, cell_set& set, const time_limit& limit,
                               const found_before* before) const {
  cell_record record;
  set.clear();
  const auto wanted =
      std::max<std::size_t>(viewpoints_wanted, static_cast<std::size_t>(how_.samples * how_.interior_share / 2.0));
  random_stream random(how_.seed, cell.place, purpose::viewpoints);
  std::uint64_t tests = 0;
  const auto found = explore_viewpoints(
      rays_, {.own = {cell.min, cell.max}, .grown = grown(cell), .radius = how_.player_radius, .wanted = wanted},
      random, tests);
  if (!found) {
    record.stored = false;
    return record;
  }
  record.region = found->region.encode();
  record.valid_share = found->valid_share;
  record.outside_share = found->outside_share;
  std::vector<glm::vec3> known = found->own;
  known.insert(known.end(), found->viewpoints.begin(), found->viewpoints.end());
  record.eyes = choose_eyes(rays_, {cell.min, cell.max}, found->region, how_.player_radius, known);
  const std::vector<glm::vec3>& viewpoints = found->viewpoints;
  {
    const finding without_test(set, found_by::touching);
    for (const std::uint32_t polygon : always_) set.add(polygon, viewpoints.front());
  }
  const auto inside = rays_.touching(grown(cell).min, grown(cell).max);
  record.geometry_inside = !inside.empty();
  if (before) {
    record.samples = before->record.samples;
    record.batches = before->record.batches;
    record.rays_spent = join_found_before(rays_, *before, rules(), set);
  } else {
    const sampling_effort effort =
        sampler_.sample({grown(cell), cell.place, record.geometry_inside, viewpoints, &found->region, &limit}, set);
    record.samples = effort.samples;
    record.rays_spent = effort.rays;
  }

  add_inside(cell, inside, viewpoints, set);
  set.save(record);
  note_time(limit, record);
  return record;
}

// Visibility rule 4: a polygon that touches the cell and faces a valid viewpoint of it is in its set.
void cell_baker::add_inside(const view_cell& cell, const std::vector<std::uint32_t>& inside,
                            const std::vector<glm::vec3>& viewpoints, cell_set& set) const {
  const finding inside_it(set, found_by::touching);
  // A polygon that no drawn viewpoint faces may still be visible from nearby, like the underside of a shelf just above
  // the floor. So a point in front of its center is tested too.
  const box where = grown(cell);
  std::vector<glm::vec3> candidates;
  std::vector<std::uint32_t> polygon_of;
  for (const std::uint32_t polygon : inside) {
    const auto facing = std::find_if(viewpoints.begin(), viewpoints.end(),
                                     [&](const glm::vec3& eye) { return faces(rays_, polygon, eye); });
    if (facing != viewpoints.end()) {
      set.add(polygon, *facing);
      continue;
    }
    const triangle t = corners_of(rays_.geometry(), polygon);
    const glm::vec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
    const float length = glm::length(normal);
    if (!(length > 0.0f)) continue;
    // No viewpoint faces it, so it is single-sided.
    const glm::vec3 eye = (t[0] + t[1] + t[2]) / 3.0f + normal * (1.1f * how_.player_radius / length);
    if (glm::any(glm::lessThan(eye, where.min)) || glm::any(glm::greaterThan(eye, where.max))) continue;
    candidates.push_back(eye);
    polygon_of.push_back(polygon);
  }
  std::vector<std::uint8_t> is_valid(candidates.size());
  rays_.find_valid(candidates, how_.player_radius, is_valid);
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (is_valid[i]) set.add(polygon_of[i], candidates[i]);
}

// Reported misses join before the search: verified dilation then starts from them and from their viewpoints as well.
void cell_baker::add_misses(const view_cell& cell, cell_set& set, cell_record& record) const {
  if (!misses_) return;
  std::vector<reported_miss> own;
  for (const std::uint32_t place : misses_->in(cell.min, cell.max, how_.margin)) own.push_back(misses_->all()[place]);
  if (own.empty()) return;
  const finding reported(set, found_by::report);
  record.rays_spent += join_misses(rays_, {how_.player_radius, how_.smallest_gap}, own, set);
  set.save(record);
}

std::optional<search_views> cell_baker::views_of(const view_cell& cell, const cell_record& record) const {
  const viewpoint_region region = region_of(cell, record);
  return sampler_.later_views({grown(cell), cell.place, record.geometry_inside, {}, &region}, record.samples);
}

// Adds what an earlier bake found in later steps than sampling, and what rays at the edit find.
search_start cell_baker::start_from(const view_cell& cell, const found_before& before, const time_limit& limit,
                                    cell_set& set, cell_record& record) const {
  const neighbor_check_settings how = check_of(cell, purpose::found_before, limit);
  record.batches = std::max(record.batches, before.record.batches);
  record.samples = std::max(record.samples, before.record.samples);
  record.rays_spent += join_found_before(rays_, before, rules(), set);
  record.rays_spent += look_again(rays_, grown(cell), before, how, set);
  search_start start{set.members().size(), before.missing(), {}};
  record.rays_spent += look_at_edit(rays_, before, how, set);
  // Rays start in the same places only where the region is the same.
  if (record.region == before.record.region) start.again = bound_before(rays_, before, how.rules.smallest_gap, set);
  return start;
}

// Searches and verifies. Stores the set and the effort in the record, but not the bound.
// set: the cell's set so far.
finish_result cell_baker::finish(const view_cell& cell, finish_settings how, std::optional<search_views>& views,
                                 cell_set& set, cell_record& record) const {
  how.rules = {how_.player_radius, how_.smallest_gap, &metric_};
  how.valid_share = record.valid_share;
  how.seed = how_.seed;
  how.place = cell.place;
  how.volumes = volumes_;
  const finish_result proof =
      finish_with_rays(rays_, *neighbors_, region_of(cell, record), how, set, views ? &*views : nullptr);
  if (views) record.samples = views->poses.taken();
  record.batches = static_cast<std::uint32_t>(how.batches_elsewhere + proof.batches);
  record.rays_spent += proof.rays_spent;
  set.save(record);
  return proof;
}

neighbor_check_settings cell_baker::check_of(const view_cell& cell, purpose use, const time_limit& limit) const {
  return {.seed = how_.seed,
          .place = cell.place,
          .use = use,
          .rules = rules(),
          .least_solid_angle = least_solid_angle(how_.max_pixel_error),
          .limit = &limit};
}

// Searches and verifies up to the target of the settings.
// set: the cell's set so far.
void cell_baker::bound(const view_cell& cell, const time_limit& limit, const search_start& start, cell_set& set,
                       cell_record& record) const {
  auto views = views_of(cell, record);
  const std::uint32_t tried = start.again ? start.again->of.number : 0;
  const finish_settings how{.max_pixel_error = how_.max_pixel_error,
                            .limit = &limit,
                            .batches_before = tried,
                            .batches_elsewhere = record.batches - tried,
                            .missing = start.missing,
                            .known = start.known,
                            .known_to = how_.max_pixel_error,
                            .again = start.again ? &*start.again : nullptr};
  take_bound(finish(cell, how, views, set, record), record);
  record.out_of_time = limit.reached() && !record.bound_met;
}

cell_record cell_baker::finish_rays(const view_cell& cell, const cell_record& own,
                                    std::span<const cell_record> neighbors, cell_set& set, stop_request* stop,
                                    const found_before* before) const {
  cell_record record = own;
  if (!record.stored) return record;
  const time_limit limit = limit_until(bounding_time, record, stop);
  set.load(record);
  search_start start;
  if (before) {
    start = start_from(cell, *before, limit, set, record);
  } else {
    const time_limit of_check = limit.part(neighbor_time);
    record.rays_spent +=
        neighbor_check(rays_, grown(cell), check_of(cell, purpose::neighbor_check, of_check), neighbors, set);
  }
  add_misses(cell, set, record);
  bound(cell, limit, start, set, record);
  std::set_difference(record.set.begin(), record.set.end(), own.set.begin(), own.set.end(),
                      std::back_inserter(record.late));
  note_time(limit, record);
  return record;
}

cell_record cell_baker::sample_and_finish(const view_cell& cell, cell_set& set, stop_request* stop,
                                          const found_before* before) const {
  cell_record record = sample(cell, set, stop, before);
  if (!record.stored) return record;
  const time_limit limit = limit_until(bounding_time, record, stop);
  search_start start;
  if (before) start = start_from(cell, *before, limit, set, record);
  add_misses(cell, set, record);
  if (shares()) bound(cell, limit, start, set, record);
  note_time(limit, record);
  return record;
}

cell_record cell_baker::keep_checked(const cell_record& own, const found_before& before, cell_set& set,
                                     stop_request* stop) const {
  cell_record record = own;
  if (!record.stored) return record;
  const time_limit limit = limit_until(1.0, record, stop);
  set.load(record);
  record.rays_spent += join_found_before(rays_, before, rules(), set);
  set.save(record);
  note_time(limit, record);
  return record;
}

cell_record cell_baker::check(const view_cell& cell, const cell_record& own, std::span<const cell_record> neighbors,
                              cell_set& set, stop_request* stop, const time_limit* limit) const {
  cell_record record = own;
  if (!record.stored) return record;
  const time_limit own_limit = limit_until(1.0, record, stop);
  if (!limit) limit = &own_limit;
  set.load(record);
  const std::size_t before = set.members().size();
  record.rays_spent += neighbor_check(rays_, grown(cell), check_of(cell, purpose::check_all, *limit), neighbors, set);
  refinement dilation(rays_, *neighbors_,
                      {.seed = how_.seed,
                       .place = cell.place,
                       .smallest_gap = how_.smallest_gap,
                       .use = purpose::dilation_of_finds,
                       .limit = limit,
                       .known = before},
                      set);
  record.rays_spent += dilation.run(how_.max_pixel_error * whole_sphere, finish_settings().max_rays);
  set.save(record);
  note_time(own_limit, record);
  return record;
}

cell_record cell_baker::improve(const view_cell& cell, const cell_record* before,
                                std::span<const cell_record> neighbors, const cell_turn& turn, cell_set& set) const {
  if (turn.limit->reached()) return before ? *before : cell_record();
  cell_record record = before ? *before : sample(cell, set, *turn.limit);
  if (!record.stored) return record;
  if (before) set.load(record);
  const std::size_t known = before ? set.members().size() : 0;
  if (before) {
    neighbor_check_settings how = check_of(cell, purpose::check_all, *turn.limit);
    how.seed = seed_after(record.batches, how_.seed);
    how.least_solid_angle = least_solid_angle(turn.target);
    record.rays_spent += neighbor_check(rays_, grown(cell), how, neighbors, set);
  } else {
    add_misses(cell, set, record);
  }
  auto views = views_of(cell, record);
  const finish_settings how{.max_pixel_error = turn.target,
                            .max_rays = turn.max_rays,
                            .further_rounds = 0,  // the cell gets another turn
                            .limit = turn.limit,
                            .limit_ends_batches = true,
                            .batches_before = record.batches,
                            .known = known,
                            // A turn that met a bound searched about as far as that bound needs.
                            .known_to = before ? before->upper_bound : turn.target};
  const finish_result proof = finish(cell, how, views, set, record);
  // The bounds of all turns hold together with the stated confidence, and sets only grow. So the smallest one holds.
  if (proof.upper_bound < record.upper_bound) take_bound(proof, record);
  record.bound_met = record.upper_bound <= how_.max_pixel_error;
  return record;
}

// Adds what is in a set without a visibility test: coarser levels of detail and polygons of the cells file.
void cell_baker::complete(const view_cell& cell, std::vector<std::uint32_t>& set) const {
  add_coarser_levels(rays_.geometry().lods, set);
  add_polygons(given_, cell.number, set);
}

cell_record cell_baker::finished(const view_cell& cell, cell_record last) const {
  last.witnesses.clear();
  last.witness_of.clear();
  last.late.clear();
  if (!last.stored) return last;
  std::vector<std::uint32_t> dilated = last.set;
  complete(cell, last.set);
  if (how_.safety_ring == safety_ring::none) return last;
  // The dilation starts from the polygons that were found, not from those of complete(). complete() then runs on both
  // sets, because dilation may add the finest level of another object.
  auto added = ring_of(rays_, neighbors_->sharing, how_.safety_ring, grown(cell), dilated);
  added.erase(std::lower_bound(added.begin(), added.end(), own_polygons_), added.end());
  const auto first_added = dilated.insert(dilated.end(), added.begin(), added.end());
  std::inplace_merge(dilated.begin(), first_added, dilated.end());
  complete(cell, dilated);
  last.unverified = dilated.size() - last.set.size();
  last.set = std::move(dilated);
  return last;
}

}  // namespace sightcell::bake
