#include "since/step_keeper.h"

#include <tbb/task_arena.h>
#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <limits>
#include <utility>

#include "checkpoint/checkpoint.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t triangles_of_part = 64;
// A cell that lost more of what it saw is baked as in a full bake: to start from the rest takes longer.
constexpr double least_share_left = 0.75;

bool is_ascending(const std::vector<std::uint32_t>& ids, std::size_t end) {
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (ids[i] >= end || (i > 0 && ids[i] <= ids[i - 1])) return false;
  return true;
}

// Returns whether a cell can have cast these rays, so that casting them again takes no longer than a bake.
bool is_possible(const bound_rays& of, std::uint32_t batches) {
  constexpr std::uint64_t most_rays = 200'000'000;  // twice those of a batch
  std::uint64_t sum = 0;
  for (const std::uint64_t rays : of.parts)
    if (rays > most_rays || (sum += rays) > most_rays) return false;
  return of.number <= batches && of.name <= batches;
}

edited_boxes boxes_of(const std::array<std::span<const edited_part>, 2>& edit, float smallest_gap) {
  constexpr std::size_t most_parts = 256;
  edited_boxes boxes{{glm::vec3(std::numeric_limits<float>::max()), glm::vec3(std::numeric_limits<float>::lowest())},
                     {}};
  for (const auto parts : edit)
    for (const edited_part& part : parts) {
      const box& one = boxes.parts.emplace_back(part.where.grown(reach_beside(smallest_gap)));
      boxes.all = {glm::min(boxes.all.min, one.min), glm::max(boxes.all.max, one.max)};
    }
  if (boxes.parts.size() > most_parts) boxes.parts.clear();
  return boxes;
}

struct kept_member {
  std::uint32_t polygon, witness;
};

// Replaces the set of a record. The numbers of most polygons keep their order in an edit.
void put_members(std::vector<kept_member> members, cell_record& record) {
  const auto below = [](const kept_member& a, const kept_member& b) { return a.polygon < b.polygon; };
  if (!std::is_sorted(members.begin(), members.end(), below)) std::sort(members.begin(), members.end(), below);
  record.set.resize(members.size());
  record.witness_of.resize(members.size());
  for (std::size_t i = 0; i < members.size(); ++i) {
    record.set[i] = members[i].polygon;
    record.witness_of[i] = members[i].witness;
  }
}

bool is_share(double value) {
  return value >= 0.0 && value <= 1.0;
}

}  // namespace

step_keeper::step_keeper(const scene::world_geometry& geometry, const near_polygons* neighbors, const settings& how,
                         std::uint32_t volumes, std::string key, std::optional<kept_records> before, scene_edit edit)
    : how_(how), volumes_(volumes), scene_{geometry.min, geometry.max} {
  now_.key = std::move(key);
  now_.polygons = std::move(edit.now);
  if (neighbors) {
    now_.partner_reach = neighbors->coinciding.reach();
    now_.partners = neighbors->coinciding.pairs();
  }
  if (!before) return;
  if (before->key != now_.key) {
    const std::string names = differing_names(before->key, now_.key);
    throw error(error_kind::wrong_use, "records.other-bake", records_beside(how.since).string(),
                "was kept by a bake with other settings" + (names.empty() ? names : " (" + names + ")"),
                "give the same settings, or bake with --keep-records and without --since");
  }
  before_ = std::move(*before);
  edit_ = std::move(edit.polygons);
  near_differs_ = other_neighbors(before_.polygons, now_.polygons, edit_);
  std::vector<triangle> added;
  for (const std::uint32_t polygon : edit_.added) added.push_back(now_.polygons.corners[polygon]);
  edited_ = edited_triangles(parts_of(edit_.removed_corners), parts_of(added), how.smallest_gap);
  edited_boxes_ = boxes_of({edited_.removed, edited_.added}, how.smallest_gap);
  for (const kept_step& step : before_.steps) {
    steps_[{step.place, step.box, step.kind}] = &step;
    cells_.insert({step.place, step.box, step_kind::sample});
  }
}

std::vector<edited_part> step_keeper::parts_of(const std::vector<triangle>& all) {
  std::vector<edited_part> parts;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % triangles_of_part == 0) parts.push_back({{all[i][0], all[i][0]}, {}});
    edited_part& part = parts.back();
    part.corners.push_back(all[i]);
    for (const glm::vec3& corner : all[i]) {
      part.where.min = glm::min(part.where.min, corner);
      part.where.max = glm::max(part.where.max, corner);
    }
  }
  return parts;
}

step_keeper::step_name step_keeper::name_of(const view_cell& cell, step_kind kind) {
  return {cell.place, {cell.min.x, cell.min.y, cell.min.z, cell.max.x, cell.max.y, cell.max.z}, kind};
}

bool step_keeper::meets(const touched_space& space, const std::vector<edited_part>& parts) const {
  const float near = reach_beside(how_.smallest_gap);
  return std::any_of(parts.begin(), parts.end(), [&](const edited_part& part) {
    return space.meets(part.where, near) &&
           std::any_of(part.corners.begin(), part.corners.end(), [&](const auto& t) { return space.meets(t, near); });
  });
}

// Returns a hash of the set with its witnesses that does not depend on the numbers of polygons.
std::uint64_t step_keeper::hash_of_set(const cell_record& record) const {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < record.set.size(); ++i) {
    const glm::vec3& eye = record.witnesses[record.witness_of[i]];
    std::array<std::uint64_t, 3> of{now_.polygons.names[record.set[i]], 0, 0};
    std::memcpy(&of[1], &eye, sizeof(eye));
    sum += XXH3_64bits(of.data(), sizeof(of));
  }
  return sum;
}

std::uint64_t step_keeper::hash_of_own(const cell_record* own) const {
  if (own == nullptr) return 0;
  cell_record rest = *own;
  rest.set.clear();
  rest.witness_of.clear();
  rest.late.clear();
  const std::vector<std::uint8_t> bytes = encode(rest);
  std::uint64_t late = 0;
  for (const std::uint32_t polygon : own->late) late += now_.polygons.names[polygon];
  const std::array<std::uint64_t, 3> hashes{XXH3_64bits(bytes.data(), bytes.size()), hash_of_set(*own), late};
  return XXH3_64bits(hashes.data(), sizeof(hashes));
}

// Of neighbors only what the cell lacks counts, because a step reads nothing else of them.
std::uint64_t step_keeper::hash_of_neighbors(std::span<const cell_record> neighbors) const {
  std::vector<std::uint64_t> hashes;
  for (const cell_record& neighbor : neighbors)
    if (!neighbor.set.empty()) hashes.push_back(hash_of_set(neighbor));
  return XXH3_64bits(hashes.data(), hashes.size() * sizeof(hashes[0]));
}

// The bytes are whole by their checksum, but they may still be of any origin.
void step_keeper::require_sound(const cell_record& record) const {
  const auto is_finite = [](const glm::vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  };
  const bool sound = is_ascending(record.set, edit_.new_of.size()) && is_ascending(record.late, edit_.new_of.size()) &&
                     is_ascending(record.volumes, volumes_) && record.witness_of.size() == record.set.size() &&
                     std::all_of(record.witness_of.begin(), record.witness_of.end(),
                                 [&](std::uint32_t eye) { return eye < record.witnesses.size(); }) &&
                     std::all_of(record.witnesses.begin(), record.witnesses.end(), is_finite) &&
                     is_share(record.upper_bound) && is_share(record.confidence) && is_share(record.valid_share) &&
                     is_share(record.outside_share) && is_possible(record.of_bound, record.batches);
  if (!sound) refuse_records(how_.since);
}

// Gives the polygons of a record their new numbers. Returns false if one is gone or has other neighbors.
bool step_keeper::renumber(cell_record& record) const {
  std::vector<kept_member> members;
  members.reserve(record.set.size());
  for (std::size_t i = 0; i < record.set.size(); ++i) {
    const std::uint32_t now = edit_.new_of[record.set[i]];
    if (now == polygon_edit::gone || near_differs_[record.set[i]] != 0) return false;
    members.push_back({now, record.witness_of[i]});
  }
  put_members(std::move(members), record);
  for (std::uint32_t& polygon : record.late) {
    polygon = edit_.new_of[polygon];
    if (polygon == polygon_edit::gone) return false;
  }
  std::sort(record.late.begin(), record.late.end());
  return true;
}

// Gives the polygons of a record their new numbers and leaves out those that are gone.
void step_keeper::drop_gone(cell_record& record) const {
  std::vector<kept_member> members;
  for (std::size_t i = 0; i < record.set.size(); ++i) {
    const std::uint32_t now = edit_.new_of[record.set[i]];
    if (now != polygon_edit::gone) members.push_back({now, record.witness_of[i]});
  }
  put_members(std::move(members), record);
  record.late.clear();
}

// Returns what the earlier bake found in the cell, by its last step; nothing if it has no set, or little is left of it.
std::optional<found_before> step_keeper::found_in(const view_cell& cell) const {
  for (const step_kind kind :
       {step_kind::check, step_kind::finish_rays, step_kind::sample_and_finish, step_kind::sample}) {
    const auto found = steps_.find(name_of(cell, kind));
    if (found == steps_.end()) continue;
    std::optional<cell_record> record = decode(found->second->record);
    if (!record) refuse_records(how_.since);
    require_sound(*record);
    if (!record->stored || record->samples == 0) return std::nullopt;
    const std::size_t members = record->set.size();
    drop_gone(*record);
    found_before before{std::move(*record), &edited_};
    if (share_left(now_.polygons.corners, before, members) < least_share_left) return std::nullopt;
    return before;
  }
  return std::nullopt;
}

// Returns none if the kept record holds. record: then it, with new numbers.
// now: the inputs of the step in this bake.
rebake_reason step_keeper::why_not(const kept_step* step, const kept_step& now, cell_record& record) const {
  if (step == nullptr) return rebake_reason::new_cell;
  if (step->started && !how_.keep_found) return rebake_reason::started;
  std::optional<cell_record> kept = decode(step->record);
  if (!kept) refuse_records(how_.since);
  require_sound(*kept);
  if (!renumber(*kept)) return rebake_reason::changed_polygon;
  if (!edited_.removed.empty() || !edited_.added.empty()) {
    if (step->spaces.empty()) refuse_records(how_.since);
    std::vector<touched_space> spaces;
    for (const auto& bytes : step->spaces) spaces.push_back(space_of(bytes));
    const auto any_meets = [&](const std::vector<edited_part>& parts) {
      return std::any_of(spaces.begin(), spaces.end(), [&](const touched_space& one) { return meets(one, parts); });
    };
    if (any_meets(edited_.removed)) return rebake_reason::changed_polygon;
    if (any_meets(edited_.added)) return rebake_reason::something_new;
  }
  // Neighbors only add to a set, and its bound holds without them.
  if (step->own_inputs != now.own_inputs || (step->neighbor_inputs != now.neighbor_inputs && !how_.keep_found))
    return rebake_reason::neighbors;
  record = std::move(*kept);
  return rebake_reason::none;
}

touched_space step_keeper::space_of(std::span<const std::uint8_t> bytes) const {
  std::optional<touched_space> space = touched_space::decode(bytes);
  if (!space) refuse_records(how_.since);
  return std::move(*space);
}

// Puts the spaces of an earlier step in the list of a step that started from it, or adds them to its own where they
// would become many: to deflate a space takes as long as a few thousand rays.
void step_keeper::put_spaces(const std::vector<std::vector<std::uint8_t>>& before, touched_space& own,
                             std::vector<std::vector<std::uint8_t>>& spaces) const {
  constexpr std::size_t most = 4;
  if (before.size() < most) {
    spaces = before;
    return;
  }
  for (const auto& bytes : before) own.add(space_of(bytes));
}

cell_record step_keeper::take(const view_cell& cell, step_kind kind, const cell_record* own,
                              const neighbor_records& neighbors, const bake_step& bake) {
  const step_name name = name_of(cell, kind);
  const auto found = steps_.find(name);
  const kept_step* before = found != steps_.end() ? found->second : nullptr;
  kept_step step{.place = name.place,
                 .box = name.box,
                 .kind = kind,
                 .own_inputs = hash_of_own(own),
                 .record = {},
                 .spaces = {},
                 .tested = {}};
  // A cell that starts from what it had does not check its neighbors, and one that may do so does not depend on them.
  const bool may_start = how_.keep_found && before != nullptr;
  if (!may_start) step.neighbor_inputs = hash_of_neighbors(neighbors());
  cell_record record;
  rebake_reason why = why_not(before, step, record);
  // A cell that had other steps has other neighbors now.
  if (why == rebake_reason::new_cell && cells_.contains(name_of(cell, step_kind::sample)))
    why = rebake_reason::neighbors;
  if (why == rebake_reason::none) {
    step.neighbor_inputs = before->neighbor_inputs;
    step.started = before->started;
    step.spaces = before->spaces;
    step.tested = before->tested;
  } else {
    std::optional<found_before> start;
    if (how_.keep_found && why != rebake_reason::new_cell) start = found_in(cell);
    if (may_start && !start) step.neighbor_inputs = hash_of_neighbors(neighbors());
    touched_space space(box{cell.min, cell.max}.grown(how_.margin), scene_);
    tested_viewpoints tested;
    if (start && before) tested.know(tested_viewpoints::decode(before->tested), edited_boxes_);
    // What is recorded belongs to a thread, so no other thread may help. Cells are many, so all have work.
    tbb::task_arena alone(1);
    alone.execute([&] {
      const recording on_this_thread(&space);
      const recording_viewpoints and_tests(&tested);
      record = bake(start ? &*start : nullptr);
    });
    step.started = start.has_value();
    // What the set has from earlier steps depends on what these touched.
    if (step.started && before != nullptr) put_spaces(before->spaces, space, step.spaces);
    step.spaces.push_back(space.encode());
    step.tested = tested.encode();
  }
  step.record = encode(record);
  note(cell, why, std::move(step));
  return record;
}

void step_keeper::note(const view_cell& cell, rebake_reason why, kept_step step) {
  const std::scoped_lock lock(mutex_);
  rebake_reason& of_cell = reasons_[name_of(cell, step_kind::sample)];
  of_cell = std::max(of_cell, why);
  now_.steps.push_back(std::move(step));
}

std::array<std::uint32_t, 6> step_keeper::cells_by_reason() const {
  std::array<std::uint32_t, 6> counts{};
  for (const auto& [cell, why] : reasons_) ++counts[static_cast<std::size_t>(why)];
  return counts;
}

std::unique_ptr<written_records> step_keeper::write(const std::filesystem::path& pvs) {
  return std::make_unique<written_records>(now_, pvs);
}

}  // namespace sightcell::bake
