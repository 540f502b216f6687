#include "visible_set.h"

#include <algorithm>
#include <utility>

namespace engine_hook {
namespace {

void require(sightcell_status status, const std::string& subject) {
  if (status == SIGHTCELL_OK) return;
  const bool bad_file = status >= SIGHTCELL_ERR_IO;
  throw sightcell::error(bad_file ? sightcell::error_kind::bad_input : sightcell::error_kind::failed, "hook.runtime",
                         subject, sightcell_status_text(status), bad_file ? "bake the scene again" : "report this");
}

// By state, and otherwise as they were: in the order of the file, so that of surfaces in the same place the same one is
// drawn first by all ways.
void sort_by_batch(const engine_scene& engine, std::vector<draw_call>& calls) {
  std::stable_sort(calls.begin(), calls.end(), [&](const draw_call& a, const draw_call& b) {
    return engine.units()[a.unit].batch < engine.units()[b.unit].batch;
  });
}

}  // namespace

draw_list everything(const engine_scene& engine) {
  draw_list out;
  for (std::uint32_t u = 0; u < engine.units().size(); ++u) {
    const unit& whole = engine.units()[u];
    if (whole.drawn) out.calls.push_back({u, whole.first_index, whole.index_count});
  }
  sort_by_batch(engine, out.calls);
  return out;
}

visible_set::visible_set(const engine_scene& engine, const sightcell::db& db, const std::string& pvs_file,
                         std::uint32_t min_gap)
    : engine_(engine), pvs_file_(pvs_file), min_gap_(min_gap), all_(everything(engine)) {
  auto created = sightcell::view::create(db);
  require(created.status(), pvs_file);
  view_ = std::move(*created);
  const auto info = db.info();
  require(info.status(), pvs_file);
  ranges_.resize(info->range_bound);
  command_memory_.resize(info->range_bound);
  bits_.resize((info->draw_count + 63) / 64);
  index_list_.indices = index_buffer_.id();
  commands_.buffer = command_buffer_.id();
}

void visible_set::move(const std::array<float, 3>& eye) {
  // Fails for a position that is no number alone, and says DRAW_ALL then.
  (void)view_.move(eye, frame_);
  if (!changed()) return;  // what is on the device still holds
  write_commands();
  // Everything lies in the engine's own buffers already: the copy of it that the runtime would make can be spared.
  if (draws_all()) return;
  write_index_list();
  if (!engine_.merged()) read_objects();
}

void visible_set::write_index_list() {
  const std::size_t room = 3 * std::size_t{frame_.polygon_count};
  index_buffer_.write_mapped<std::uint32_t>(room, [&](std::span<std::uint32_t> memory) {
    require(view_.indices(engine_.stored_indices(), memory).status, pvs_file_);
  });

  // The indices of the ranges lie one behind the other, in their order; those of one unit can be one draw call.
  const sightcell::list_result got = view_.ranges(ranges_);
  require(got.status, pvs_file_);
  index_list_.calls.clear();
  std::uint32_t at = 0;
  for (const sightcell_range& r : std::span(ranges_).first(got.count)) {
    const std::uint32_t indices = 3 * r.count;
    if (index_list_.calls.empty() || index_list_.calls.back().unit != r.draw)
      index_list_.calls.push_back({r.draw, at, 0});
    index_list_.calls.back().index_count += indices;
    at += indices;
  }
  std::erase_if(index_list_.calls, [&](const draw_call& c) { return !engine_.units()[c.unit].drawn; });
  sort_by_batch(engine_, index_list_.calls);
}

void visible_set::write_commands() {
  const sightcell::list_result got = view_.commands(min_gap_, command_memory_);
  require(got.status, pvs_file_);
  std::vector<sightcell_command> commands(command_memory_.begin(),
                                          command_memory_.begin() + static_cast<std::ptrdiff_t>(got.count));
  const auto unit_of = [&](const sightcell_command& c) -> const unit& { return engine_.units()[c.first_instance]; };
  std::erase_if(commands, [&](const sightcell_command& c) { return !unit_of(c).drawn; });
  std::stable_sort(commands.begin(), commands.end(), [&](const sightcell_command& a, const sightcell_command& b) {
    return unit_of(a).batch < unit_of(b).batch;
  });
  commands_.runs.clear();
  commands_.polygons = 0;
  for (std::uint32_t i = 0; i < commands.size(); ++i) {
    // The runtime counts vertices through all draws, as a flattened mesh has them. Here each primitive has buffers of
    // its own, which its instances share: its vertices begin at 0, and so do its indices, as the runtime expects. An
    // engine whose primitives share a large buffer adds their places to first_index and base_vertex here.
    commands[i].base_vertex = 0;
    commands_.polygons += commands[i].index_count / 3;
    const std::uint32_t batch = unit_of(commands[i]).batch;
    if (commands_.runs.empty() || commands_.runs.back().batch != batch) commands_.runs.push_back({batch, i, 0});
    ++commands_.runs.back().count;
  }
  command_buffer_.write_mapped<sightcell_command>(commands.size(), [&](std::span<sightcell_command> memory) {
    std::copy(commands.begin(), commands.end(), memory.begin());
  });
}

void visible_set::read_objects() {
  require(sightcell_view_objects(view_.get(), bits_.data(), bits_.size()), pvs_file_);
  objects_.calls.clear();
  for (const draw_call& whole : all_.calls) {
    if ((bits_[whole.unit / 64] >> whole.unit % 64 & 1) != 0) objects_.calls.push_back(whole);
  }
}

}  // namespace engine_hook
