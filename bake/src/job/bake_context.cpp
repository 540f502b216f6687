#include "job/bake_context.h"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include "job/bake_key.h"

namespace sightcell::bake {
namespace {

void report(bake_phase phase, const callbacks& events) {
  if (events.on_phase) events.on_phase(phase);
}

bake_input input_of(const scene::scene& s, const settings& how, const callbacks& events) {
  report(bake_phase::loading, events);
  return load_input(s, how);
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

bake_context::bake_context(const scene::scene& from, const settings& settings_of_bake, const callbacks& events)
    : s(from), how(settings_of_bake), input(input_of(from, settings_of_bake, events)) {
  report(bake_phase::finding_cells, events);
  // Cells do not depend on rays, and most of both is the work of one thread.
  tbb::parallel_invoke([&] { cells.emplace(input, how); }, [&] { traced.emplace(input.geometry, how); });
  report(bake_phase::preparing_hemicubes, events);
  device.emplace(s, how, input.geometry, *traced, *cells);
  report_parts(*this, events);
  settings_text = settings_text_of(how, input, *device);
  key = key_of(s, how, input, *cells, *device);
}

pvs_frame bake_context::frame() const {
  return frame_of(s, how, with_overrides(settings_text, input.given), cells->list.cells, volumes_or_null());
}

}  // namespace sightcell::bake
