#include "sightcell/bake/bake.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <numeric>
#include <optional>
#include <vector>

#include "disk.h"
#include "disk_space.h"
#include "host_scene.h"
#include "ledger.h"
#include "phases.h"
#include "process_time.h"
#include "pvs_output.h"
#include "sightcell/bake/sampler_options.h"
#include "work_file.h"
#include "workshop.h"

namespace sightcell::bake {
namespace {

void warn_of_geometry_inside(const ledger& book, const settings& how, const callbacks& tell) {
  // Samplers that look with rays have new places inside in every round: there more rays do find what is missing.
  if (!book.stopped() && tell.on_message && how.max_pixel_error == 0.0 && book.not_empty() > 0 &&
      takes_hemicubes(how.sampler))
    tell.on_message(severity::warning,
                    fmt::format("{} cells have geometry inside; without rays (--max-pixel-error 0) polygons "
                                "are missed there however many samples are taken",
                                book.not_empty()));
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

  const stage_plan plan(*shop->blocks, shop->bounds());
  std::vector<std::uint32_t> blocks(shop->blocks->count());
  std::iota(blocks.begin(), blocks.end(), 0u);
  work_file file(output, how.scratch, shop->key, fresh);
  checkpoint& done = file.records();
  ledger book(s.polygon_count, plan, shop->blocks->cell_count(), tell);
  resume(done, book, tell);
  sum.cells_resumed = book.resumed();
  double seen = 0.0;
  arena.execute([&] { seen = print_estimate(*shop, book.cells_left(), tell); });
  const std::uint64_t of_records = book.cells_left() * checkpoint_bytes_of_cell(seen);
  check_disk_space({{folder_of(file.path()), of_records},
                    {folder_of(output), shop->blocks->cell_count() * file_bytes_of_cell(seen)},
                    {folder_of(output), how.scratch.empty() ? 0 : of_records}},  // the copy
                   tell);
  const phase_work work{*shop, plan, blocks, arena, book, file};
  keeping(file, [&] {
    book.open();
    run_phase_1(work);
    run_phase_2(work, [&](std::uint32_t cell) { return required(done, cell, plan.end_of_phase_1(cell)); });
  });
  warn_of_geometry_inside(book, how, tell);
  if (book.stopped()) {
    sum.result = outcome::cancelled;
    file.copy();
  } else {
    const pvs_frame frame = frame_of(s, how, with_overrides(shop->settings_text, shop->given), shop->list.cells);
    keeping(file, [&] {
      arena.execute([&] {
        write_pvs(
            frame, [&](std::uint32_t cell) { return required(done, cell, cell_stage::finished); }, output, tell, sum);
      });
    });
    file.remove();
  }
  sum.cpu_seconds = process_cpu_seconds() - began;
  return sum;
}

summary bake(const host_scene& s, const settings& how, const std::filesystem::path& output, bool fresh,
             const callbacks& tell) {
  validate(how);  // before alpha functions are called
  require_no_colors(how.metric);
  return bake(scene_of(s), how, output, fresh, tell);
}

}  // namespace sightcell::bake
