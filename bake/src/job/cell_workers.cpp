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
// Workers wait while this many records are not committed yet: a slow disk must not fill the memory.
constexpr std::size_t ended_limit = 64;

// State that the workers and the calling thread share.
class work_list {
 public:
  explicit work_list(step_queue& queue) : queue_(queue) {}

  // Returns the next step; nothing if there is none. Waits while all steps that are left depend on others.
  std::optional<cell_step> begin_next() {
    std::unique_lock lock(mutex_);
    for (;;) {
      if (stopped_ || queue_.left() == 0) return std::nullopt;
      if (ended_.size() < ended_limit) {
        if (auto step = queue_.begin_next()) {
          ++in_work_;
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
    --in_work_;
    ended_.push_back(std::move(one));
    changed_.notify_one();
  }
  // Stops all workers. The first exception is the one that the user sees.
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
  // Waits for steps to end, and returns their records. Empty if all workers have ended.
  std::vector<stage_record> take(std::size_t& in_work) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || !ended_.empty(); });
    in_work = in_work_;
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
  std::size_t in_work_ = 0;
  bool stopped_ = false, closed_ = false;
  std::exception_ptr failure_;
};

// Takes one step after another. Each step is isolated: a thread that waits in a loop inside its cell would otherwise
// start another worker and bake whole cells inside the first one. The first cell could not end meanwhile, and the two
// cells would share what a source or a ray keeps per thread. Threads without a worker may still help in any cell.
// No exception reaches TBB: it would cancel the loops inside all other cells, which then end silently with half of
// their work.
void run_worker(const std::function<cell_set()>& make_set, const take_step& take, work_list& work) {
  try {
    std::optional<cell_set> set;  // made by the first step: a worker without steps costs no memory
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

void take_steps(step_queue& queue, const std::function<cell_set()>& make_set, const take_step& take,
                std::size_t workers, tbb::task_arena& arena, const steps_ended& ended) {
  workers = std::min(workers, queue.left());
  if (workers <= 1) return take_one_by_one(queue, make_set, take, arena, ended);

  work_list work(queue);
  // A thread of its own drives the loop of the workers and takes the calling thread's slot in the arena. So all slots
  // of the arena compute, and the calling thread can commit and report each step at once.
  std::jthread driver([&] {
    try {
      arena.execute([&] {
        tbb::parallel_for(
            std::size_t{0}, workers, [&](std::size_t) { run_worker(make_set, take, work); }, tbb::simple_partitioner());
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
