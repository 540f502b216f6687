#include "sightcell/bake/bake.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <numeric>
#include <utility>
#include <vector>

#include "checkpoint.h"
#include "host_scene.h"
#include "ledger.h"
#include "phases.h"
#include "process_time.h"
#include "pvs_output.h"
#include "sightcell/scene/error.h"
#include "workshop.h"

namespace sightcell::bake {
namespace {

std::vector<std::uint32_t> counted_up(std::uint32_t count) {
  std::vector<std::uint32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0u);
  return numbers;
}

// What an earlier run left, into the book.
void resume(checkpoint& done, ledger& book, std::size_t cells, const callbacks& tell) {
  const std::uint32_t damaged = done.survey([&](std::uint32_t cell, cell_stage stage, const cell_summary& record) {
    if (cell < cells) book.resume(cell, stage, record);
  });
  if (!tell.on_message) return;
  if (damaged > 0)
    tell.on_message(severity::warning,
                    fmt::format("{} records of the unfinished bake are damaged: their cells are baked anew", damaged));
  if (book.resumed() > 0)
    tell.on_message(severity::note, fmt::format("resuming: {} of {} cells are done", book.resumed(), cells));
}

void warn_of_geometry_inside(const ledger& book, const settings& how, const callbacks& tell) {
  if (!book.stopped() && tell.on_message && how.max_pixel_error == 0.0 && book.not_empty() > 0)
    tell.on_message(severity::warning,
                    fmt::format("{} cells have geometry inside; without rays (--max-pixel-error 0) polygons "
                                "are missed there however many samples are taken",
                                book.not_empty()));
}

cell_record required(std::optional<cell_record> record, std::uint32_t cell) {
  if (!record)
    throw error(error_kind::failed, "checkpoint.failed", fmt::format("cell {}", cell), "its record is gone",
                "run the same command again");
  return std::move(*record);
}

}  // namespace

summary bake(const scene::scene& s, const settings& how, const std::filesystem::path& output, bool fresh,
             const callbacks& tell) {
  validate(how);
  const double began = process_cpu_seconds();
  summary sum;
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  std::optional<workshop> shop;
  arena.execute([&] { shop.emplace(s, how, tell); });
  sum.source = shop->eyes.name;
  sum.device = shop->eyes.source->device();

  std::filesystem::path beside = output;
  beside += ".bake";
  checkpoint done(beside, shop->key, fresh);
  const std::uint32_t cells = shop->blocks->cell_count();
  const stage_plan plan(*shop->blocks, shop->neighbors.has_value());
  const std::vector<std::uint32_t> all_cells = counted_up(cells), all_blocks = counted_up(shop->blocks->count());
  ledger book(s.polygon_count, plan, all_cells, tell);
  resume(done, book, cells, tell);
  sum.cells_resumed = book.resumed();
  arena.execute([&] { print_estimate(*shop, cells - book.resumed(), tell); });
  book.open();
  const phase_work work{*shop, plan, all_blocks, arena, book, done};
  run_phase_1(work);
  run_phase_2(work, [&](std::uint32_t cell) { return required(done.load(cell, plan.end_of_phase_1(cell)), cell); });
  warn_of_geometry_inside(book, how, tell);
  if (book.stopped()) {
    sum.result = outcome::cancelled;
  } else {
    const pvs_frame frame = frame_of(s, how, with_overrides(shop->settings_text, shop->given), shop->list.cells);
    arena.execute([&] {
      write_pvs(
          frame, [&](std::uint32_t cell) { return required(done.load(cell, cell_stage::finished), cell); }, output,
          tell, sum);
    });
    done.remove();
  }
  sum.cpu_seconds = process_cpu_seconds() - began;
  return sum;
}

summary bake(const host_scene& s, const settings& how, const std::filesystem::path& output, bool fresh,
             const callbacks& tell) {
  validate(how);  // before alpha functions are called
  return bake(scene_of(s), how, output, fresh, tell);
}

}  // namespace sightcell::bake
