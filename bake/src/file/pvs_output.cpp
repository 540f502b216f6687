#include "file/pvs_output.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "file/kept_sets.h"
#include "file/stored_rules.h"
#include "file/use_all_threads.h"
#include "order/draw_table.h"
#include "order/file_order.h"
#include "order/stored_draws.h"
#include "sightcell/base/error.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/writer.h"
#include "volumes/volume_order.h"

namespace sightcell::bake {
namespace {

// A bound may be rounded upward only.
float rounded_up(double bound) {
  const auto nearest = static_cast<float>(bound);
  return static_cast<double>(nearest) < bound ? std::nextafter(nearest, 2.0f) : nearest;
}

void require_ok(format::status outcome, const std::filesystem::path& output, const char* doing) {
  if (outcome == format::status::ok) return;
  const bool disk = outcome == format::status::io;
  throw error(
      error_kind::failed, disk ? "output.io" : "output.encode", output.string(),
      fmt::format("{} failed: {}", doing, format::status_text(outcome)),
      disk ? "free space or choose another folder, then run the same command: it resumes" : "report this scene");
}

// A part of the limit of the memory is what the cells took that were baked at the same time.
std::uint64_t room_for_sets(const pvs_frame& frame) {
  constexpr std::uint64_t most = std::uint64_t{1} << 30;
  return frame.memory == 0 ? most : std::min(most, frame.memory / 8);
}

// Returns how many groups of 64 cells may be encoded at the same time. A group takes about six times the bytes of its
// sets as they are kept: runs of 8 bytes in place of 2 to 3, and what is computed for slack.
std::size_t groups_that_fit(const pvs_frame& frame, const kept_sets& sets) {
  if (frame.memory == 0) return SIZE_MAX;
  return frame.memory / 16 / (std::uint64_t{6} * format::layout::cells_per_block * sets.mean_bytes());
}

struct stored_cells {
  stored_cells(const record_source& record_of, std::uint64_t room_for_sets) : sets(record_of, room_for_sets) {}

  kept_sets sets;                                             // by the index in the list of all cells
  format::file_parts parts;                                   // the content of the file about its cells, without sets
  std::vector<std::uint32_t> places;                          // indices into the list of all cells
  double polygons = 0.0;                                      // in all sets together
  double unseen = 0.0;                                        // of these, added by the conservative dilation
  double volumes = 0.0;                                       // in all sets together
  std::array<double, found_by_count> found{};                 // polygons in all sets together, by found_by
  std::array<double, growth_steps> growth{};                  // of these, found by hemicubes, by step
  std::vector<std::uint32_t> hemicubes;                       // of each cell
  std::vector<std::uint32_t> number_of_volume;                // in the file, by the number in records
  std::vector<std::pair<double, std::uint32_t>> out_of_time;  // bound and place of cells that a limit of time ended
};

// Returns a share above 0 as the file has it.
float share_in_file(double share) {
  return std::max(static_cast<float>(share), std::numeric_limits<float>::min());
}

// A cell that is stored, by its index in the list of all cells.
struct read_cell {
  cell_record record;
  std::vector<std::uint8_t> set;  // as kept_sets keeps it
};

void take_cell(const pvs_frame& frame, std::uint32_t i, read_cell cell, stored_cells& out, summary& sum) {
  const cell_record& record = cell.record;
  const auto number = static_cast<std::uint32_t>(out.places.size());
  out.parts.certificate.push_back({.cell = number,
                                   .rays = record.rays,
                                   .misses = record.misses,
                                   .upper_bound = record.upper_bound,
                                   .confidence = record.confidence,
                                   .seed = frame.seed});
  const auto region = std::as_bytes(std::span(record.region));
  out.parts.viewpoints.push_back({.cell = number,
                                  .valid_share = share_in_file(record.valid_share),
                                  .outside_share = record.outside_share,
                                  .region = {region.begin(), region.end()},
                                  .eyes = record.eyes});
  out.parts.cells.push_back(frame.cells[i]);
  out.places.push_back(i);
  out.sets.keep(i, std::move(cell.set));
  out.polygons += static_cast<double>(record.set.size());
  out.unseen += static_cast<double>(record.unverified);
  out.volumes += static_cast<double>(record.volumes.size());
  for (std::size_t by = 0; by < found_by_count; ++by) out.found[by] += record.found[by];
  for (std::size_t step = 0; step < growth_steps; ++step) out.growth[step] += record.growth[step];
  out.hemicubes.push_back(record.samples);
  sum.max_upper_bound = std::max(sum.max_upper_bound, record.upper_bound);
  if (!record.bound_met) ++sum.cells_over_bound;
  if (record.out_of_time) out.out_of_time.emplace_back(record.upper_bound, i);
}

// Records are decoded on all threads and taken in order.
stored_cells first_pass(const pvs_frame& frame, const record_source& record_of, summary& sum) {
  constexpr std::size_t most_at_once = 64;
  stored_cells out(record_of, room_for_sets(frame));
  out.parts.player_radius = stored_rules_of(frame.settings).player_radius;
  sum.max_upper_bound = 0.0;
  for (std::size_t first = 0; first < frame.cells.size(); first += most_at_once) {
    std::vector<read_cell> read(std::min(most_at_once, frame.cells.size() - first));
    tbb::parallel_for(std::size_t{0}, read.size(), [&](std::size_t k) {
      read[k].record = record_of(static_cast<std::uint32_t>(first + k));
      if (read[k].record.stored) read[k].set = kept_sets::bytes_of(read[k].record.set);
    });
    for (std::size_t k = 0; k < read.size(); ++k) {
      if (read[k].record.stored)
        take_cell(frame, static_cast<std::uint32_t>(first + k), std::move(read[k]), out, sum);
      else
        ++sum.cells_left_out;
    }
  }
  return out;
}

found_shares shares_of(const std::array<double, found_by_count>& found) {
  const double all = std::max(std::accumulate(found.begin(), found.end(), 0.0), 1.0);
  const auto share = [&](found_by how) { return found[static_cast<std::size_t>(how)] / all; };
  return {.sampler = share(found_by::sampler),
          .touching = share(found_by::touching),
          .adjacent_cells = share(found_by::adjacent_cell),
          .later_hemicubes = share(found_by::later_hemicubes),
          .nearby_rays = share(found_by::nearby_rays),
          .verification_rays = share(found_by::verification),
          .reported = share(found_by::report)};
}

std::vector<growth_point> growth_of(const stored_cells& stored) {
  const double all = std::max(std::accumulate(stored.found.begin(), stored.found.end(), 0.0), 1.0);
  const std::uint32_t most =
      stored.hemicubes.empty() ? 0 : *std::max_element(stored.hemicubes.begin(), stored.hemicubes.end());
  std::vector<growth_point> points;
  double found = 0.0;
  for (std::size_t step = 0; step < growth_steps && most > 0; ++step) {
    found += stored.growth[step];
    const bool last = step + 1 == growth_steps || most <= 1u << step;
    const std::uint32_t hemicubes = last ? most : 1u << step;
    const auto cells = std::count_if(stored.hemicubes.begin(), stored.hemicubes.end(),
                                     [&](std::uint32_t of_cell) { return of_cell >= hemicubes; });
    points.push_back({hemicubes, found / all, static_cast<std::uint32_t>(cells)});
    if (last) break;
  }
  return points;
}

void warn_of_cells_left_out(const pvs_frame& frame, const summary& sum, const callbacks& events) {
  if (sum.cells_left_out == 0 || !events.on_message) return;
  events.on_message(severity::warning,
                    fmt::format("{} of {} cells have no valid viewpoint, or too few for a camera, and are left out; a "
                                "camera there is outside all cells",
                                sum.cells_left_out, frame.cells.size()));
}

// Names the cells with the largest bounds.
void warn_of_cells_out_of_time(const pvs_frame& frame, stored_cells& stored, summary& sum, const callbacks& events) {
  sum.cells_out_of_time = static_cast<std::uint32_t>(stored.out_of_time.size());
  if (stored.out_of_time.empty() || !events.on_message) return;
  constexpr std::size_t most_named = 5;
  std::sort(stored.out_of_time.begin(), stored.out_of_time.end(),
            [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
  std::string names;
  for (std::size_t i = 0; i < std::min(most_named, stored.out_of_time.size()); ++i) {
    const auto& [bound, place] = stored.out_of_time[i];
    const format::box& box = frame.cells[place];
    names += fmt::format("{}{:.1e} in cell {} at ({:.4g}, {:.4g}, {:.4g}) m", i == 0 ? "" : ", ", bound, place,
                         0.5f * (box.min[0] + box.max[0]), 0.5f * (box.min[1] + box.max[1]),
                         0.5f * (box.min[2] + box.max[2]));
  }
  events.on_message(severity::warning,
                    fmt::format("--seconds-per-cell ended {} cells above the bound: {}{}", stored.out_of_time.size(),
                                names, stored.out_of_time.size() > most_named ? " and others" : ""));
}

// Returns the slack that the file states.
double slack_of(std::span<const std::byte> bytes) {
  format::reader file;
  return format::reader::open(bytes, file) == format::status::ok ? static_cast<double>(file.facts().slack) : 0.0;
}

// Puts cells and polygons in the order of the file.
void put_in_order(const pvs_frame& frame, stored_cells& stored) {
  format::file_parts& parts = stored.parts;
  if (const std::vector<std::uint32_t> before = order_cells(parts); !before.empty()) {
    std::vector<std::uint32_t> places;
    for (const std::uint32_t cell : before) places.push_back(stored.places[cell]);
    stored.places = std::move(places);
  }
  parts.draws = frame.draws;
  parts.named_groups = frame.named_groups;
  put_identity(frame.identity, parts);
  const polygon_order_kind kind = file_settings_of(frame.settings).order;
  const auto set_of = [&](std::uint32_t cell, std::vector<std::uint32_t>& set) {
    set = stored.sets.of(stored.places[cell]);
  };
  if (frame.order)
    put(keep_order(parts.draws, parts.facts.layout, kind, frame.identity, *frame.order), parts);
  else if (frame.clusters.empty())
    order_polygons_of(parts, kind, set_of);
  else
    order_clusters_of(parts, kind, frame.clusters, set_of);
}

void put_volumes_in_order(const pvs_frame& frame, const record_source& record_of, stored_cells& stored) {
  if (frame.volumes.empty()) return;
  const std::vector<std::uint32_t> order =
      order_volumes(static_cast<std::uint32_t>(frame.volumes.size()), static_cast<std::uint32_t>(stored.places.size()),
                    [&](std::uint32_t cell, std::vector<std::uint32_t>& volumes) {
                      volumes = record_of(stored.places[cell]).volumes;
                    });
  stored.number_of_volume.resize(order.size());
  for (const std::uint32_t volume : order) {
    stored.number_of_volume[volume] = static_cast<std::uint32_t>(stored.parts.volumes.size());
    stored.parts.volumes.push_back(frame.volumes[volume]);
  }
  stored.parts.volume_shape = {frame.volume_width, frame.volume_width};
}

// Returns the set as the writer needs it, with volumes after the polygons.
std::vector<std::uint32_t> items_of(std::uint32_t place, const record_source& record_of, const stored_cells& stored) {
  std::vector<std::uint32_t> items = stored.sets.of(place);
  if (stored.number_of_volume.empty()) return items;
  const auto volumes = static_cast<std::ptrdiff_t>(items.size());
  for (const std::uint32_t volume : record_of(place).volumes)
    items.push_back(stored.parts.facts.polygon_count + stored.number_of_volume[volume]);
  std::sort(items.begin() + volumes, items.end());
  return items;
}

// Puts everything in the order of the file and encodes it.
// name: for messages.
std::vector<std::byte> encoded(const pvs_frame& frame, const record_source& record_of, stored_cells& stored,
                               double max_upper_bound, const std::filesystem::path& name) {
  stored.parts.facts = frame.facts;
  stored.parts.facts.max_pixel_error = rounded_up(max_upper_bound);
  stored.parts.settings = frame.settings;
  put_in_order(frame, stored);
  put_volumes_in_order(frame, record_of, stored);
  format::file_contents contents = stored.parts.contents({stored.places.size(),
                                                          [&](std::uint32_t cell, std::vector<std::uint32_t>& set) {
                                                            set = items_of(stored.places[cell], record_of, stored);
                                                            return format::status::ok;
                                                          },
                                                          true});
  contents.slack = slack_of_profile[static_cast<std::size_t>(file_settings_of(frame.settings).profile)];
  use_all_threads(contents, groups_that_fit(frame, stored.sets));
  std::vector<std::byte> bytes;
  require_ok(format::encode(contents, bytes), name, "encoding");
  return bytes;
}

}  // namespace

std::size_t encoded_bytes(const pvs_frame& frame, const record_source& record_of) {
  summary sum;
  stored_cells stored = first_pass(frame, record_of, sum);
  return stored.places.empty() ? 0 : encoded(frame, record_of, stored, sum.max_upper_bound, frame.scene_name).size();
}

pvs_frame frame_of(const scene::scene& s, const settings& how, std::string settings_text,
                   const std::vector<view_cell>& cells, const volume_grid* volumes) {
  pvs_frame frame;
  frame.scene_name = s.name;
  frame.facts.polygon_count = s.polygon_count;
  frame.facts.layout = static_cast<format::host_layout>(how.file.layout);
  frame.facts.margin = how.margin;
  frame.facts.scene_fingerprint = s.fingerprint;
  frame.facts.repeatable = how.time_budget == 0.0 && how.seconds_per_cell == 0.0;
  frame.seed = how.seed;
  frame.draws = draw_table(s, frame.facts.layout);
  frame.named_groups = s.groups;
  remove_closed_groups(how.closed, frame.named_groups, frame.draws);
  if (how.file.granularity == set_granularity::cluster) frame.clusters = clusters_of_scene(s);
  if (how.file.names) frame.identity = identity_of(s);
  for (const view_cell& c : cells) frame.cells.push_back({{c.min.x, c.min.y, c.min.z}, {c.max.x, c.max.y, c.max.z}});
  if (volumes != nullptr) {
    frame.volume_width = volumes->width();
    for (const volume_place& p : volumes->places()) frame.volumes.push_back({p.x, p.y, p.z, 0});
  }
  frame.settings = std::move(settings_text);
  frame.memory = how.memory;
  return frame;
}

bool write_pvs(const pvs_frame& frame, const record_source& record_of, const std::filesystem::path& output,
               const callbacks& events, summary& sum, const file_completion& complete) {
  if (events.on_phase) events.on_phase(bake_phase::writing_file);
  stored_cells stored = first_pass(frame, record_of, sum);
  if (stored.places.empty())
    throw error(error_kind::failed, "bake.no-free-cell", frame.scene_name, "no cell has a valid viewpoint",
                "give boxes with --cells-file or --cells-grid, or a smaller --player-radius");
  warn_of_cells_left_out(frame, sum, events);
  warn_of_cells_out_of_time(frame, stored, sum, events);
  // Removes the unfinished file of a bake of this output that was killed here: it takes disk space, and nothing else
  // removes it.
  format::remove_unfinished(output.string().c_str());
  std::vector<std::byte> bytes = encoded(frame, record_of, stored, sum.max_upper_bound, output);
  if (complete && !complete(bytes)) return false;
  require_ok(format::write_file(output.string().c_str(), bytes), output, "writing");

  const auto cells_written = static_cast<std::uint32_t>(stored.places.size());
  sum.cells = cells_written;
  sum.visible_percent =
      100.0 * stored.polygons / (static_cast<double>(cells_written) * std::max(frame.facts.polygon_count, 1u));
  sum.found = shares_of(stored.found);
  sum.growth = growth_of(stored);
  sum.unseen_per_cell = stored.unseen / cells_written;
  sum.unseen_percent = 100.0 * stored.unseen / std::max(stored.polygons - stored.unseen, 1.0);
  sum.volumes = static_cast<std::uint32_t>(frame.volumes.size());
  sum.volumes_per_cell = stored.volumes / cells_written;
  sum.slack = slack_of(bytes);
  sum.bytes = bytes.size();
  if (sum.cells_over_bound > 0) sum.result = outcome::bound_not_met;
  return true;
}

}  // namespace sightcell::bake
