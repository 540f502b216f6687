#include "job/bake_context.h"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <utility>
#include <vector>

#include "job/bake_key.h"
#include "job/stoppable_work.h"
#include "sightcell/base/json_text.h"
#include "sightcell/base/stop_request.h"

namespace sightcell::bake {
namespace {

void report(bake_phase phase, const callbacks& events) {
  if (events.on_phase) events.on_phase(phase);
}

bake_input input_of(const scene::scene& s, const settings& how, const callbacks& events) {
  report(bake_phase::loading, events);
  return load_input(s, how);
}

// Returns false if the caller cancels.
bool is_wanted(bake_phase phase, std::chrono::steady_clock::time_point began, const callbacks& events) {
  if (!events.on_progress) return true;
  progress now;
  now.phase = phase;
  now.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return events.on_progress(now);
}

void report_parts(const bake_context& context, const callbacks& events) {
  if (!events.on_message) return;
  for (const std::string& warning : context.input.geometry.warnings) events.on_message(severity::warning, warning);
  const chosen_source& chosen = context.device->chosen;
  events.on_message(severity::note, fmt::format("device: {}, source {}{}", chosen.source->device(), chosen.name,
                                                chosen.because.empty() ? std::string() : " (" + chosen.because + ")"));
  events.on_message(severity::note, "cells: " + context.cells->list.how);
  if (context.cells->volumes)
    events.on_message(severity::note,
                      fmt::format("volumes: {} of {:g} m", context.cells->volumes->count(), context.how.volumes));
  for (const std::string& warning : context.cells->list.warnings) events.on_message(severity::warning, warning);
}

}  // namespace

bake_context::bake_context(const scene::scene& from, const settings& settings_of_bake, const earlier_records& earlier,
                           const find_decided& find, tbb::task_arena& arena, const callbacks& events)
    : s(from), how(settings_of_bake), input(input_of(from, settings_of_bake, events)) {
  report(bake_phase::finding_cells, events);
  const auto began = std::chrono::steady_clock::now();
  const std::string inputs = inputs_of_cells(s, how, input);
  std::optional<decided_cells> decided = find ? find(inputs) : std::nullopt;
  const kept_records* const before = earlier ? earlier() : nullptr;
  cell_list list;
  stop_request stop;
  const auto build_parts = [&] {
    if (how.keep_records || before) edit.emplace(input.geometry, before);
    // Cells do not depend on rays, and most of both is the work of one thread.
    tbb::parallel_invoke(
        [&] {
          if (!decided) list = all_cells(input, how, &stop);
        },
        [&] {
          traced.emplace(input.geometry, how, before ? &edit->partners : nullptr, &stop);
          device.emplace(s, how, input.geometry, *traced);
          stop.check();
          if (edit && traced->neighbors) put_neighbors(*traced->neighbors, edit->now);
        });
  };
  run_stoppable(arena, build_parts, [&] { return is_wanted(bake_phase::finding_cells, began, events); }, stop);
  report(bake_phase::preparing_hemicubes, events);
  arena.execute([&] { decide(std::move(decided), std::move(list), inputs, events); });
}

void bake_context::decide(std::optional<decided_cells> decided, cell_list list, const std::string& inputs,
                          const callbacks& events) {
  if (decided && decided->device != name_of(*device)) {
    decided.reset();
    list = all_cells(input, how);
  }
  if (!decided)
    decided = decide_cells(std::move(list), inputs, how, *traced, *device, s.polygon_count, events, merging_cubes);
  if (decided->list.can_merge) cell_bytes = encode(*decided);
  cells.emplace(input, std::move(decided->list), std::move(decided->boxes), how);
  sampler = make_cell_sampler(
      how, {traced->rays, device->source(), device->colors_or_null(), cells->list.cells, traced->neighbors_or_null()});
  report_parts(*this, events);
  settings_text = settings_text_of(how, input, *cells, *device);
  key = key_of(s, how, input, *cells, *device);
}

bool build(std::optional<bake_context>& context, const scene::scene& s, const settings& how, const earlier_records& earlier,
           const find_decided& find, tbb::task_arena& arena, const callbacks& events) {
  try {
    context.emplace(s, how, earlier, find, arena, events);
  } catch (const step_stopped&) {
    return false;
  }
  return true;
}

pvs_frame bake_context::frame() const {
  std::string text = with_overrides(settings_text, input.given);
  const auto say = [&](const char* name) {
    auto with_name = scene::parse_ordered_json(text);
    with_name[name] = true;
    text = with_name.dump();
  };
  if (how.keep_found) say("keep_found");
  if (order) say("keep_order");
  pvs_frame frame = frame_of(s, how, std::move(text), cells->list.cells, volumes_or_null());
  frame.order = order ? &*order : nullptr;
  return frame;
}

}  // namespace sightcell::bake
