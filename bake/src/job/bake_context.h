#pragma once
// Everything that a bake has before its first cell, as parts in the order in which they are built.
#include <tbb/task_arena.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "file/pvs_output.h"
#include "job/bake_cells.h"
#include "job/bake_device.h"
#include "job/bake_input.h"
#include "job/decide_cells.h"
#include "job/traced_scene.h"
#include "order/kept_order.h"
#include "sampler/cell_sampler.h"
#include "sightcell/bake/progress.h"
#include "sightcell/bake/settings.h"
#include "sightcell/scene/scene.h"
#include "since/scene_edit.h"

namespace sightcell::bake {

// Returns the records of an earlier bake; null: there was none. They outlive the context. Called once, when the scene is
// loaded, so they may be read in the meantime. Its exceptions pass through.
using earlier_records = std::function<const kept_records*()>;

struct bake_context {
  // Builds all parts.
  // earlier: {} for a bake without such records.
  // find: called once for the cells that an earlier run stored. {}: they are made and merged.
  // events: receives phases, warnings, the device and the cells. s and how must outlive the object.
  // Threads: works in the arena, which the calling thread must not be inside of. The calling thread reports.
  // Throws sightcell::error, as the parts do, and step_stopped if events.on_progress cancels.
  bake_context(const scene::scene& s, const settings& how, const earlier_records& earlier, const find_decided& find,
               tbb::task_arena& arena, const callbacks& events);
  bake_context(const bake_context&) = delete;  // its parts refer to each other
  bake_context& operator=(const bake_context&) = delete;

  // Returns true if rays bound the miss probability of each cell. Then cells also share what they found.
  bool bounds() const { return how.max_pixel_error > 0.0; }
  // Returns the description of the file with all cells.
  pvs_frame frame() const;
  const volume_grid* volumes_or_null() const { return cells->volumes ? &*cells->volumes : nullptr; }

  const scene::scene& s;
  const settings& how;
  const bake_input input;
  std::optional<scene_edit> edit;      // where records are kept or read; what keeps them takes it away
  std::optional<earlier_order> order;  // with settings::order_from; filled in later
  // Never empty once the constructor has returned. Optional because the constructor builds them in several steps.
  std::optional<const traced_scene> traced;
  std::optional<const bake_device> device;
  std::optional<const bake_cells> cells;
  std::unique_ptr<cell_sampler> sampler;
  std::string settings_text;  // as in bake_key.h
  std::string key;
  std::string cell_bytes;           // of the cells, for the checkpoint; empty if they are quickly made again
  std::uint64_t merging_cubes = 0;  // rendered in this run to merge cells

 private:
  // Builds what depends on the cells. decided: of an earlier run; inputs: what cells follow from.
  void decide(std::optional<decided_cells> decided, cell_list list, const std::string& inputs, const callbacks& events);
};

// Builds a context in an arena. The calling thread must not be inside it. Returns false if events.on_progress cancels.
// earlier, find: as for bake_context.
bool build(std::optional<bake_context>& context, const scene::scene& s, const settings& how, const earlier_records& earlier,
           const find_decided& find, tbb::task_arena& arena, const callbacks& events);

}  // namespace sightcell::bake
