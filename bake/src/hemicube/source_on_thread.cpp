#include "hemicube/source_on_thread.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

namespace sightcell::bake {
namespace {

// What a caller waits for; lives on its stack.
struct request {
  std::span<const pose> poses{};
  std::span<hemicube_view> views{};
  hemicube_image* image = nullptr;  // if not null, the pixels of poses[0] are wanted instead of the views
  bool done = false;
  std::exception_ptr failure{};
  std::condition_variable changed{};
};

class source_on_thread final : public hemicube_source {
 public:
  explicit source_on_thread(std::function<std::unique_ptr<hemicube_source>()> make) {
    request started;
    thread_ = std::thread([this, &started, make = std::move(make)]() mutable { run(std::move(make), started); });
    try {
      wait_for(started);
    } catch (...) {
      thread_.join();
      throw;
    }
  }
  ~source_on_thread() override {
    {
      const std::scoped_lock lock(mutex_);
      closed_ = true;
    }
    waiting_changed_.notify_one();
    thread_.join();
  }

  using hemicube_source::render;
  void render(std::span<const pose> poses, std::span<hemicube_view> views) override {
    if (poses.empty()) return;
    request one{.poses = poses, .views = views};
    serve(one);
  }
  void render_image(const pose& where, hemicube_image& image) override {
    request one{.poses = {&where, 1}, .image = &image};
    serve(one);
  }
  std::optional<double> device_seconds() const override { return busy_seconds_; }
  std::uint32_t resolution() const override { return resolution_; }
  std::string device() const override { return device_; }

 private:
  void serve(request& one) {
    {
      const std::scoped_lock lock(mutex_);
      waiting_.push_back(&one);
    }
    waiting_changed_.notify_one();
    wait_for(one);
  }
  void wait_for(request& one) {
    std::unique_lock lock(mutex_);
    one.changed.wait(lock, [&] { return one.done; });
    if (one.failure) std::rethrow_exception(one.failure);
  }
  // The request may be gone when the lock is released.
  void answer(std::span<request* const> requests, const std::exception_ptr& failure) {
    const std::scoped_lock lock(mutex_);
    for (request* one : requests) {
      one->failure = failure;
      one->done = true;
      one->changed.notify_one();
    }
  }

  void run(std::function<std::unique_ptr<hemicube_source>()> make, request& started) {
    std::unique_ptr<hemicube_source> source;
    std::exception_ptr failure;
    try {
      source = make();
      resolution_ = source->resolution();
      device_ = source->device();
    } catch (...) {
      failure = std::current_exception();
      make = nullptr;
    }
    request* const first = &started;
    answer({&first, 1}, failure);
    if (failure) return;
    for (std::vector<request*> requests; take(requests);) render_all(*source, requests);
  }
  bool take(std::vector<request*>& requests) {
    std::unique_lock lock(mutex_);
    waiting_changed_.wait(lock, [&] { return closed_ || !waiting_.empty(); });
    requests = std::exchange(waiting_, {});
    return !requests.empty();
  }

  void render_all(hemicube_source& source, std::vector<request*>& requests) {
    const auto began = std::chrono::steady_clock::now();
    const auto first_image = std::stable_partition(requests.begin(), requests.end(),
                                                   [](const request* one) { return one->image == nullptr; });
    std::exception_ptr failure;
    try {
      render_views(source, {requests.begin(), first_image});
    } catch (...) {
      failure = std::current_exception();
    }
    busy_seconds_ = busy_seconds_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    answer({requests.begin(), first_image}, failure);
    for (auto one = first_image; one != requests.end(); ++one) {
      failure = nullptr;
      try {
        source.render_image((*one)->poses.front(), *(*one)->image);
      } catch (...) {
        failure = std::current_exception();
      }
      answer({one, one + 1}, failure);
    }
  }
  void render_views(hemicube_source& source, std::span<request* const> requests) {
    if (requests.empty()) return;
    if (requests.size() == 1) return source.render(requests[0]->poses, requests[0]->views);
    poses_.clear();
    for (const request* one : requests) poses_.insert(poses_.end(), one->poses.begin(), one->poses.end());
    if (views_.size() < poses_.size()) views_.resize(poses_.size());
    // The callers' views lend their memory.
    const auto exchange = [&] {
      auto view = views_.begin();
      for (const request* one : requests)
        for (hemicube_view& own : one->views) std::swap(own, *view++);
    };
    exchange();
    try {
      source.render(poses_, std::span(views_).first(poses_.size()));
    } catch (...) {
      exchange();
      throw;
    }
    exchange();
  }

  std::uint32_t resolution_ = 0;
  std::string device_;
  std::atomic<double> busy_seconds_{0.0};
  std::mutex mutex_;
  std::condition_variable waiting_changed_;
  std::vector<request*> waiting_;
  bool closed_ = false;
  // Of the new thread.
  std::vector<pose> poses_;
  std::vector<hemicube_view> views_;
  std::thread thread_;
};

}  // namespace

std::unique_ptr<hemicube_source> make_source_on_thread(std::function<std::unique_ptr<hemicube_source>()> make) {
  return std::make_unique<source_on_thread>(std::move(make));
}

}  // namespace sightcell::bake
