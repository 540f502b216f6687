#include "progress_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "number_text.h"

namespace sightcell::cli {

namespace {

struct phase_words {
  std::string_view name, text;
};

// By phase.
constexpr phase_words words_of_phases[] = {{"loading", "loading"},
                                           {"finding_cells", "finding cells"},
                                           {"preparing_hemicubes", "preparing hemicubes"},
                                           {"merging_cells", "merging cells"},
                                           {"estimating", "estimating the time"},
                                           {"preparing_sampler", "preparing the sampler"},
                                           {"baking_cells", "baking cells"},
                                           {"checking_neighbors", "neighbor check"},
                                           {"writing_file", "writing the file"},
                                           {"measuring_importance", "importance of polygons"},
                                           {"finding_casters", "shadow casters"},
                                           {"finding_lights", "lights"}};

// What the line has, the most important first.
enum class rank { head, time_left, slow_cell, place_of_cell, target, worst_bound, rate, error, visible };

// A part of the line.
struct field {
  rank least;        // needed to show text
  std::string text;  // with the comma in front of it
  // Replaces text if there is room for fields of this rank.
  rank least_for_longer = rank::visible;
  std::string longer = {};
};

std::size_t columns_of(std::string_view text) {
  std::size_t columns = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80)
      ++columns;
    else if (byte >= 0xC0)
      columns += 2;  // the other bytes of the character count nothing
  }
  return columns;
}

// Returns as many fields as fit, the most important first.
std::string fitted(const std::vector<field>& fields, std::size_t width) {
  std::string text;
  for (auto most = static_cast<int>(rank::visible); most >= 0; --most) {
    text.clear();
    for (const field& one : fields) {
      if (static_cast<int>(one.least) > most) continue;
      text += !one.longer.empty() && static_cast<int>(one.least_for_longer) <= most ? one.longer : one.text;
    }
    if (columns_of(text) <= width) return text;
  }
  return cut_to(text, width);
}

// An estimate: 42 s, 18 min, 2 h 10 min.
std::string about(double seconds) {
  if (!(seconds < 1e9)) return "long";
  if (seconds < 99.5) return fmt::format("{:.0f} s", std::max(seconds, 0.0));
  const double minutes = seconds / 60.0;
  if (minutes < 99.5) return fmt::format("{:.0f} min", minutes);
  const auto whole = static_cast<std::uint64_t>(std::llround(minutes));
  return whole < 100 * 60 ? fmt::format("{} h {:02} min", whole / 60, whole % 60) : fmt::format("{} h", whole / 60);
}

std::string rate_text(double per_second) {
  const auto digits = [](double rate) {
    return rate < 0.995 ? fmt::format("{:.2f}", rate) : fmt::format("{:.{}f}", rate, rate < 9.95 ? 1 : 0);
  };
  if (per_second >= 0.1) return digits(per_second) + " cells/s";
  if (60.0 * per_second >= 0.1) return digits(60.0 * per_second) + " cells/min";
  return digits(3600.0 * per_second) + " cells/h";
}

std::string small_number(double value) {
  return value == 0.0 ? "0" : fmt::format("{:.1e}", value);
}

void add_slow_cell(const bake::progress& now, std::vector<field>& fields) {
  if (!now.slow) return;
  const std::string cell = fmt::format(", cell {}", grouped(now.slow->cell)), time = " for " + about(now.slow->seconds);
  std::array<float, 3> center = now.slow->center;
  for (float& value : center) value = std::round(value) + 0.0f;  // without a negative zero
  fields.push_back({rank::slow_cell, cell + time, rank::place_of_cell,
                    cell + fmt::format(" ({:.0f}, {:.0f}, {:.0f}) m", center[0], center[1], center[2]) + time});
}

void add_quality(const bake::progress& now, std::vector<field>& fields) {
  if (now.worst_bound > 0.0) {
    fields.push_back({rank::error, ", error " + small_number(now.pixel_error)});
    fields.push_back({rank::worst_bound, ", worst bound " + small_number(now.worst_bound)});
  }
  if (now.visible_percent > 0.0)
    fields.push_back({rank::visible, fmt::format(", {:.2f} % visible", now.visible_percent)});
}

void add_time_left(const bake::progress& now, std::vector<field>& fields) {
  if (now.seconds_left > 0.0)
    fields.push_back({rank::time_left, ", " + about(std::max(now.seconds_left, 1.0)) + " left"});
}

std::string cells_text(const bake::progress& now, std::size_t width) {
  std::vector<field> fields;
  if (is_last(now)) {
    fields.push_back({rank::head, fmt::format("{} cells", grouped(now.cells_total)), rank::time_left,
                      fmt::format("baked {} cells in {}", grouped(now.cells_total), duration_text(now.seconds))});
    add_quality(now, fields);
    return fitted(fields, width);
  }
  const bool check = now.phase == bake::bake_phase::checking_neighbors;
  fields.push_back(
      {rank::head, fmt::format("{}: {} of {}", phase_text(now.phase),
                               grouped(check ? now.cells_checked : now.cells_done), grouped(now.cells_total))});
  if (now.target > 0.0)
    fields.push_back({rank::target, fmt::format(", {} finished, now to bound {}", grouped(now.cells_checked),
                                                small_number(now.target))});
  if (now.cells_per_second > 0.0) fields.push_back({rank::rate, ", " + rate_text(now.cells_per_second)});
  add_time_left(now, fields);
  add_slow_cell(now, fields);
  add_quality(now, fields);
  return fitted(fields, width);
}

}  // namespace

std::string_view phase_name(bake::bake_phase phase) {
  return words_of_phases[static_cast<std::size_t>(phase)].name;
}

std::string_view phase_text(bake::bake_phase phase) {
  return words_of_phases[static_cast<std::size_t>(phase)].text;
}

bool is_counted(bake::bake_phase phase) {
  using enum bake::bake_phase;
  return phase == merging_cells || phase == preparing_sampler || phase == baking_cells || phase == checking_neighbors ||
         phase == measuring_importance || phase == finding_casters || phase == finding_lights;
}

bool is_last(const bake::progress& now) {
  if (now.phase == bake::bake_phase::measuring_importance) return now.importance == 1.0;
  if (now.phase == bake::bake_phase::finding_casters) return now.casters == 1.0;
  if (now.phase == bake::bake_phase::finding_lights) return now.lights == 1.0;
  const bool cells = now.phase == bake::bake_phase::baking_cells || now.phase == bake::bake_phase::checking_neighbors;
  return cells && now.target == 0.0 && now.cells_done == now.cells_total && now.cells_per_second > 0.0 &&
         now.seconds_left == 0.0 && now.cells_in_work == 0;
}

std::string progress_text(const bake::progress& now, std::size_t width) {
  using enum bake::bake_phase;
  const std::string phase(phase_text(now.phase));
  if (now.phase == baking_cells || now.phase == checking_neighbors) return cells_text(now, width);
  std::vector<field> fields{{rank::head, phase}};
  if ((now.phase == preparing_sampler || now.phase == merging_cells) && now.prepared < 1.0) {
    fields.back().text += fmt::format(": {:.0f} %", 100.0 * now.prepared);
    add_time_left(now, fields);
  }
  if (now.phase == measuring_importance && now.importance > 0.0)
    fields.back().text += fmt::format(": {:.0f} %", 100.0 * now.importance);
  if (now.phase == finding_casters && now.casters > 0.0)
    fields.back().text += fmt::format(": {:.0f} %", 100.0 * now.casters);
  if (now.phase == finding_lights && now.lights > 0.0)
    fields.back().text += fmt::format(": {:.0f} %", 100.0 * now.lights);
  return fitted(fields, width);
}

std::string stopping_text(const bake::progress& now, std::size_t width) {
  std::vector<field> fields{{rank::head, "stopping", rank::time_left, "stopping"}};
  if (now.cells_in_work > 0)
    fields.back().longer +=
        fmt::format(" after {} {} in work", grouped(now.cells_in_work), now.cells_in_work == 1 ? "cell" : "cells");
  add_slow_cell(now, fields);
  return fitted(fields, width);
}

std::string waiting_text(const std::string& what, double seconds, std::size_t width) {
  const std::string time = seconds < 2.0 ? std::string() : ", " + about(seconds);
  if (columns_of(time) >= width) return cut_to(what, width);
  return cut_to(what, width - columns_of(time)) + time;
}

std::string cut_to(std::string_view text, std::size_t width) {
  std::string cut;
  std::size_t columns = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    columns += columns_of({&c, 1});
    if (columns > width) break;
    cut += byte < ' ' || byte == 0x7F ? ' ' : c;
  }
  return cut;
}

}  // namespace sightcell::cli
