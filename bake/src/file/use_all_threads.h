#pragma once
// Lets the format library encode rows on the threads of the calling arena. It has no threads of its own.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <functional>

#include "sightcell/format/writer.h"

namespace sightcell::bake {

// most_groups: that are in work at the same time; each takes memory.
inline void use_all_threads(format::file_contents& contents, std::size_t most_groups) {
  contents.run_at_once = [](std::size_t count, const std::function<void(std::size_t)>& work) {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const auto& range) {
          for (std::size_t item = range.begin(); item < range.end(); ++item) work(item);
        },
        tbb::simple_partitioner());
  };
  // Two groups for each thread: what some take longer, others take less.
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  contents.groups_at_once = std::clamp<std::size_t>(most_groups, 1, 2 * threads);
}

}  // namespace sightcell::bake
