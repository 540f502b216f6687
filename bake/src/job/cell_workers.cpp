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

#include "sightcell/base/process_time.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t memory_of_sets = std::size_t{1} << 30;
// Workers wait while this many records are not committed yet: a slow disk must not fill the memory.
constexpr std::size_t ended_limit = 64;

// State that the workers and the calling thread share.
class work_list {
 public:
  work_list(step_queue& queue, std::size_t workers) : queue_(queue), single_(workers == 1) {}

  // Returns the next step; nothing if there is none. Waits while all steps that are left depend on others.
  std::optional<cell_step> begin_next() {
    std::unique_lock lock(mutex_);
    for (;;) {
      if (stopped_ || queue_.left() == 0) return std::nullopt;
      if (single_ ? not_committed_ == 0 : ended_.size() < ended_limit) {
        if (auto step = queue_.begin_next()) {
          in_work_.push_back({step->cell, work_clock::now()});
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
    std::erase_if(in_work_, [&](const step_in_work& step) { return step.cell == one.cell; });
    ended_.push_back(std::move(one));
    ++not_committed_;
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
  // Waits for steps to end, at most for the pause, and moves their records to ended.
  // Returns false if there are none and all workers have ended.
  bool take(std::chrono::milliseconds pause, std::vector<stage_record>& ended, std::vector<step_in_work>& in_work) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, pause, [&] { return closed_ || !ended_.empty(); });
    in_work = in_work_;
    ended = std::exchange(ended_, {});
    return !closed_ || !ended.empty();
  }
  void committed(std::span<const stage_record> records) {
    const std::scoped_lock lock(mutex_);
    for (const stage_record& one : records) queue_.committed({one.cell, one.stage});
    not_committed_ -= records.size();
    room_.notify_all();
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  step_queue& queue_;
  const bool single_;
  std::mutex mutex_;
  std::condition_variable changed_, room_;
  std::vector<stage_record> ended_;
  std::vector<step_in_work> in_work_;
  std::size_t not_committed_ = 0;
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
      const double began = thread_cpu_seconds();
      cell_record record = tbb::this_task_arena::isolate([&] { return take(*step, *set); });
      work.add({step->cell, step->to, std::move(record), thread_cpu_seconds() - began});
    }
  } catch (const step_stopped&) {
    // The list is stopped already.
  } catch (...) {
    work.fail(std::current_exception());
  }
}

}  // namespace

std::size_t worker_count(int threads, std::size_t set_bytes) {
  const std::size_t room = memory_of_sets / std::max<std::size_t>(set_bytes, 1);
  return std::clamp<std::size_t>(room, 1, static_cast<std::size_t>(std::max(threads, 1)));
}

void take_steps(step_queue& queue, const std::function<cell_set()>& make_set, const take_step& take,
                const worker_pool& pool, const steps_ended& ended) {
  if (queue.left() == 0) return;

  const std::size_t workers = std::clamp<std::size_t>(pool.workers, 1, queue.left());
  work_list work(queue, workers);
  // A thread of its own drives the loop of the workers and takes the calling thread's slot in the arena. So all slots
  // of the arena compute, and the calling thread can commit and report each step at once. A single worker is driven
  // likewise: its cells are those of the largest scenes, of which the user waits longest for a report.
  std::jthread driver([&] {
    try {
      pool.arena.execute([&] {
        tbb::parallel_for(
            std::size_t{0}, workers, [&](std::size_t) { run_worker(make_set, take, work); }, tbb::simple_partitioner());
      });
    } catch (...) {
      work.fail(std::current_exception());
    }
    work.close();
  });
  std::vector<stage_record> records;
  std::vector<step_in_work> in_work;
  while (work.take(pool.pause, records, in_work)) {
    if (records.empty() && in_work.empty()) continue;  // the first worker makes its set
    try {
      if (!ended(records, in_work)) {
        work.stop();
        pool.stop.ask();
      }
      work.committed(records);
    } catch (...) {
      work.fail(std::current_exception());
      pool.stop.ask();
    }
  }
  driver.join();
  work.rethrow();
}

}  // namespace sightcell::bake
