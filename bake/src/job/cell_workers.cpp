#include "job/cell_workers.h"

#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace sightcell::bake {
namespace {

constexpr std::size_t memory_of_sets = std::size_t{1} << 30;
// Lanes wait while so many records lie there to be committed: a slow disk must not fill the memory.
constexpr std::size_t ended_limit = 64;

// What lanes and the calling thread share.
class work_list {
 public:
  explicit work_list(step_queue& queue) : queue_(queue) {}

  // Waits where all that is left depends on what has not been committed.
  std::optional<cell_step> begin_next() {
    std::unique_lock lock(mutex_);
    for (;;) {
      if (stopped_ || queue_.left() == 0) return std::nullopt;
      if (ended_.size() < ended_limit) {
        if (auto step = queue_.begin_next()) {
          ++in_lanes_;
          return step;
        }
      }
      room_.wait(lock);
    }
  }
  void stop() {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
    room_.notify_all();
  }
  void add(stage_record one) {
    const std::scoped_lock lock(mutex_);
    --in_lanes_;
    ended_.push_back(std::move(one));
    changed_.notify_one();
  }
  // Whatever goes wrong ends the bake; the first of it is what the user is told.
  void fail(std::exception_ptr why) {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
    if (!failure_) failure_ = std::move(why);
    room_.notify_all();
  }
  void close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    changed_.notify_one();
  }
  // Waits for steps to end; nothing when all lanes have.
  std::vector<stage_record> take(std::size_t& in_work) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || !ended_.empty(); });
    in_work = in_lanes_;
    return std::exchange(ended_, {});
  }
  void committed(std::span<const stage_record> records) {
    const std::scoped_lock lock(mutex_);
    for (const stage_record& one : records) queue_.committed({one.cell, one.stage});
    room_.notify_all();
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  step_queue& queue_;
  std::mutex mutex_;
  std::condition_variable changed_, room_;
  std::vector<stage_record> ended_;
  std::size_t in_lanes_ = 0;
  bool stopped_ = false, closed_ = false;
  std::exception_ptr failure_;
};

// One step after another. Isolated: a thread that waits in a loop inside of its cell would otherwise take the next lane
// from the arena and bake whole cells of it on top of its own, which meanwhile could not end, and whatever a source or
// a ray keeps per thread between two steps of the one cell would be used by the other. Threads that have no lane may
// still help in any cell. Nothing is thrown to TBB: it would cancel the loops inside of all other cells, which then end
// silently with half of their work.
void run_lane(const std::function<cell_set()>& make_set, const take_step& take, work_list& work) {
  try {
    std::optional<cell_set> set;  // made by the first step: a lane that finds none costs no memory
    while (const auto step = work.begin_next()) {
      if (!set) set.emplace(make_set());
      work.add({step->cell, step->to, tbb::this_task_arena::isolate([&] { return take(*step, *set); })});
    }
  } catch (...) {
    work.fail(std::current_exception());
  }
}

void take_one_by_one(step_queue& queue, const std::function<cell_set()>& make_set, const take_step& take,
                     tbb::task_arena& arena, const steps_ended& ended) {
  arena.execute([&] {
    cell_set set = make_set();
    while (const auto step = queue.begin_next()) {
      stage_record record{step->cell, step->to, take(*step, set)};
      if (!ended({&record, 1}, 0)) return;
      queue.committed(*step);
    }
  });
}

}  // namespace

std::size_t worker_count(bool shared, int threads, std::size_t set_bytes) {
  if (!shared) return 1;
  const std::size_t room = memory_of_sets / std::max<std::size_t>(set_bytes, 1);
  return std::clamp<std::size_t>(room, 1, static_cast<std::size_t>(std::max(threads, 1)));
}

void take_steps(step_queue& queue, const std::function<cell_set()>& make_set, const take_step& take, std::size_t lanes,
                tbb::task_arena& arena, const steps_ended& ended) {
  lanes = std::min(lanes, queue.left());
  if (lanes <= 1) return take_one_by_one(queue, make_set, take, arena, ended);

  work_list work(queue);
  // The lanes' loop is driven by a thread of its own, which takes the calling thread's slot in the arena: so the
  // calling thread can commit steps and tell of them the moment they end, and all slots of the arena compute.
  std::jthread driver([&] {
    try {
      arena.execute([&] {
        tbb::parallel_for(
            std::size_t{0}, lanes, [&](std::size_t) { run_lane(make_set, take, work); }, tbb::simple_partitioner());
      });
    } catch (...) {
      work.fail(std::current_exception());
    }
    work.close();
  });
  std::size_t in_work = 0;
  for (auto records = work.take(in_work); !records.empty(); records = work.take(in_work)) {
    try {
      if (!ended(records, in_work)) work.stop();
      work.committed(records);
    } catch (...) {
      work.fail(std::current_exception());
    }
  }
  driver.join();
  work.rethrow();
}

}  // namespace sightcell::bake
