#include "cell_lanes.h"

#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace sightcell::bake {
namespace {

constexpr std::size_t memory_of_sets = std::size_t{1} << 30;
// Lanes wait while so many cells lie there to be committed: a slow disk must not fill the memory.
constexpr std::size_t ended_limit = 64;

struct ended_cell {
  std::uint32_t which = 0;
  baked_cell cell;
};

// What lanes and the calling thread share.
class work_list {
 public:
  explicit work_list(std::span<const std::uint32_t> wanted) : wanted_(wanted) {}

  std::optional<std::uint32_t> begin_next() {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [&] { return stopped_ || ended_.size() < ended_limit; });
    if (stopped_ || begun_ == wanted_.size()) return std::nullopt;
    return wanted_[begun_++];
  }
  void stop() {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
    room_.notify_all();
  }
  void add(ended_cell one) {
    const std::scoped_lock lock(mutex_);
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
  // Waits for the next cell to end; nothing when all lanes have.
  std::optional<ended_cell> take(std::size_t& in_work) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return closed_ || !ended_.empty(); });
    if (ended_.empty()) return std::nullopt;
    ended_cell one = std::move(ended_.front());
    ended_.pop_front();
    room_.notify_one();
    in_work = begun_ - ++taken_ - ended_.size();
    return one;
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::span<const std::uint32_t> wanted_;
  std::mutex mutex_;
  std::condition_variable changed_, room_;
  std::deque<ended_cell> ended_;
  std::size_t begun_ = 0, taken_ = 0;
  bool stopped_ = false, closed_ = false;
  std::exception_ptr failure_;
};

// One cell after another. Isolated: a thread that waits in a loop inside of its cell would otherwise take the next lane
// from the arena and bake whole cells of it on top of its own, which meanwhile could not end, and whatever a source or
// a ray keeps per thread between two steps of the one cell would be used by the other. Threads that have no lane may
// still help in any cell. Nothing is thrown to TBB: it would cancel the loops inside of all other cells, which then end
// silently with half of their work.
void run_lane(const cell_baker& baker, std::span<const view_cell> cells, work_list& work) {
  try {
    std::optional<cell_set> set;  // made by the first cell: a lane that finds none costs no memory
    while (const auto which = work.begin_next()) {
      if (!set) set.emplace(baker.make_set());
      work.add({*which, tbb::this_task_arena::isolate([&] { return baker.bake(cells[*which], *set); })});
    }
  } catch (...) {
    work.fail(std::current_exception());
  }
}

void bake_one_by_one(const cell_baker& baker, std::span<const view_cell> cells, std::span<const std::uint32_t> wanted,
                     tbb::task_arena& arena, const cell_ended& ended) {
  arena.execute([&] {
    cell_set set = baker.make_set();
    for (const std::uint32_t which : wanted) {
      baked_cell cell = baker.bake(cells[which], set);
      if (!ended(which, cell, 0)) return;
    }
  });
}

}  // namespace

std::size_t lane_count(bool shared, int threads, std::size_t set_bytes) {
  if (!shared) return 1;
  const std::size_t room = memory_of_sets / std::max<std::size_t>(set_bytes, 1);
  return std::clamp<std::size_t>(room, 1, static_cast<std::size_t>(std::max(threads, 1)));
}

void bake_cells(const cell_baker& baker, std::span<const view_cell> cells, std::span<const std::uint32_t> wanted,
                std::size_t lanes, tbb::task_arena& arena, const cell_ended& ended) {
  lanes = std::min(lanes, wanted.size());
  if (lanes <= 1) return bake_one_by_one(baker, cells, wanted, arena, ended);

  work_list work(wanted);
  // The lanes' loop is driven by a thread of its own, which takes the calling thread's slot in the arena: so the
  // calling thread can commit a cell and tell of it the moment it ends, and all slots of the arena compute.
  std::jthread driver([&] {
    try {
      arena.execute([&] {
        tbb::parallel_for(
            std::size_t{0}, lanes, [&](std::size_t) { run_lane(baker, cells, work); }, tbb::simple_partitioner());
      });
    } catch (...) {
      work.fail(std::current_exception());
    }
    work.close();
  });
  std::size_t in_work = 0;
  while (auto one = work.take(in_work)) {
    try {
      if (!ended(one->which, one->cell, in_work)) work.stop();
    } catch (...) {
      work.fail(std::current_exception());
    }
  }
  driver.join();
  work.rethrow();
}

}  // namespace sightcell::bake
