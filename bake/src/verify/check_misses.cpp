// Checks the reports of a host against a file, with a ray scene of its own that is built from the import, and without
// any state of the bake.
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "input/host_scene.h"
#include "misses/misses_file.h"
#include "misses/probe_polygon.h"
#include "misses/reported_misses.h"
#include "sightcell/bake/misses.h"
#include "verify/verified_file.h"

namespace sightcell::bake {
namespace {

// The result of a report in the cells that contain its eye: the last of these that holds for one of them.
enum class finding : std::uint8_t { outside, not_missing, not_visible, not_free, reproduced };

// Returns the result for a cell whose set lacks the polygon.
finding try_miss(const verified_file& file, const reported_miss& miss,
                 const std::function<bool(std::uint32_t)>& contains) {
  const stored_rules& rules = file.rules();
  if (!file.rays().is_valid(miss.eye, rules.player_radius)) return finding::not_free;
  const polygon_sight sight = probe_polygon(file.rays(), rules.smallest_gap, miss.eye, miss.polygon, contains);
  if (sight.counts) return finding::reproduced;
  return sight.seen ? finding::not_missing : finding::not_visible;
}

miss_check check_all(verified_file& file, const reported_misses& known,
                     const std::function<void(std::uint32_t, std::uint32_t)>& on_progress) {
  miss_check result;
  const std::vector<reported_miss>& all = known.all();
  std::vector<finding> worst(all.size(), finding::outside);
  std::vector<std::uint32_t> set;
  const std::uint32_t cells = file.file().cell_count();
  for (std::uint32_t cell = 0; cell < cells; ++cell) {
    const box own = file.cell_box(cell);
    const std::vector<std::uint32_t> here = known.in(own.min, own.max, file.file().facts().margin);
    if (!here.empty()) file.cell_set(cell, set);
    // Polygons of the other scene are in no set and are not misses.
    const std::function<bool(std::uint32_t)> contains = [&](std::uint32_t polygon) {
      return polygon >= file.file().polygon_count() || std::binary_search(set.begin(), set.end(), polygon);
    };
    std::vector<finding> found(here.size());
    tbb::parallel_for(std::size_t{0}, here.size(), [&](std::size_t i) {
      const reported_miss& miss = all[here[i]];
      found[i] = contains(miss.polygon) ? finding::not_missing : try_miss(file, miss, contains);
    });
    for (std::size_t i = 0; i < here.size(); ++i) {
      const reported_miss& miss = all[here[i]];
      worst[here[i]] = std::max(worst[here[i]], found[i]);
      if (found[i] == finding::reproduced)
        result.list.push_back({cell, miss.polygon, {miss.eye.x, miss.eye.y, miss.eye.z}});
    }
    if (on_progress) on_progress(cell + 1, cells);
  }
  const auto count = [&](finding which) {
    return static_cast<std::uint64_t>(std::count(worst.begin(), worst.end(), which));
  };
  result.reports = all.size();
  result.reproduced = count(finding::reproduced);
  result.not_missing = count(finding::not_missing);
  result.not_visible = count(finding::not_visible);
  result.not_free = count(finding::not_free);
  result.outside = count(finding::outside);
  return result;
}

}  // namespace

miss_check check_misses(const scene::scene& s, std::span<const std::byte> file, const std::string& name,
                        const std::filesystem::path& misses, const verify_settings& how,
                        const std::function<void(std::uint32_t, std::uint32_t)>& on_progress) {
  verified_file opened(s, how.cells_from, file, name);
  const reported_misses known(read_misses(misses, s));
  miss_check result;
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  arena.execute([&] {
    opened.build_rays();
    result = check_all(opened, known, on_progress);
  });
  return result;
}

miss_check check_misses(const host_scene& s, std::span<const std::byte> file, const std::string& name,
                        const std::filesystem::path& misses, const verify_settings& how,
                        const std::function<void(std::uint32_t, std::uint32_t)>& on_progress) {
  return check_misses(scene_of(s), file, name, misses, how, on_progress);
}

}  // namespace sightcell::bake
