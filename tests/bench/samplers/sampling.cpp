#include "bench/samplers/sampling.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include "bench/hemicube/cache.h"
#include "bench/samplers/bytes.h"
#include "sightcell/base/error.h"
#include "sightcell/base/process_time.h"

namespace sightcell::bench {
namespace {

constexpr int sampling_version = 2;          // raised when what is kept would be measured otherwise
thread_local double sampling_seconds = 0.0;  // of the last cell of this thread

std::string encode(const sampled_figures& f, const std::vector<std::uint32_t>& set) {
  byte_writer out;
  out.put(f.samples);
  out.put(f.rays);
  out.put(f.cpu_seconds);
  out.put(f.upper_bound);
  out.put(static_cast<std::uint32_t>(set.size()));
  std::uint32_t before = 0;
  for (const std::uint32_t polygon : set) {
    out.put_small(polygon - before);
    before = polygon;
  }
  return out.bytes();
}

bool decode(const std::string& bytes, std::uint32_t polygons, sampled_figures& f, std::vector<std::uint32_t>& set) {
  byte_reader in(bytes);
  f.samples = in.get<std::uint32_t>();
  f.rays = in.get<std::uint64_t>();
  f.cpu_seconds = in.get<double>();
  f.upper_bound = in.get<double>();
  f.set_size = in.get<std::uint32_t>();
  set.clear();
  std::uint64_t polygon = 0;
  for (std::uint32_t i = 0; i < f.set_size && !in.failed(); ++i) {
    polygon += in.get_small();
    set.push_back(static_cast<std::uint32_t>(polygon));
  }
  return in.ended() && polygon < polygons;
}

}  // namespace

namespace {

// Sees all that another sees, and no gaps.
class without_importance final : public bake::hemicube_source {
 public:
  explicit without_importance(bake::hemicube_source& behind) : behind_(behind) {}
  using hemicube_source::render;
  void render(std::span<const bake::pose> poses, std::span<bake::hemicube_view> views) override {
    behind_.render(poses, views);
    for (bake::hemicube_view& view : views) view.importance.fill(0.0);
  }
  void render_image(const bake::pose& where, bake::hemicube_image& image) override {
    behind_.render_image(where, image);
  }
  std::optional<double> device_seconds() const override { return behind_.device_seconds(); }
  std::uint32_t resolution() const override { return behind_.resolution(); }
  std::string device() const override { return behind_.device(); }

 private:
  bake::hemicube_source& behind_;
};

}  // namespace

// What the baker asks, so that sampling is timed and nothing else: not the search for free points, nor what touches the
// cell, which are the same for all samplers.
struct sampling_bench::clocked_sampler final : bake::cell_sampler {
  bake::sampling_effort sample(const bake::sampled_cell& cell, bake::cell_set& set) const override {
    const double began = seconds();
    const bake::sampling_effort effort = inner->sample(cell, set);
    sampling_seconds = seconds() - began;
    return effort;
  }
  std::optional<bake::search_views> later_views(const bake::sampled_cell& cell, std::uint32_t taken) const override {
    return inner->later_views(cell, taken);
  }
  double seconds() const { return by_process ? bake::process_cpu_seconds() : bake::thread_cpu_seconds(); }

  std::unique_ptr<bake::cell_sampler> inner;
  bool by_process = false;
};

sampling_bench::sampling_bench(const ground& g, const kept_files& kept, unsigned threads)
    : ground_(g), kept_(kept), threads_(std::max(threads, 1u)), sampler_(std::make_unique<clocked_sampler>()) {}

sampling_bench::~sampling_bench() = default;

std::string sampling_bench::key_of(const job& what, std::size_t cell) const {
  std::string text = fmt::format("sampled {} {} settings {} code {}", sampling_version, ground_.text_of(cell),
                                 what.settings.dump(), what.code);
  if (what.of_all)
    for (std::size_t other = 0; other < ground_.cells.size(); ++other) text += " beside " + ground_.text_of(other);
  return hash_of_text(text);
}

sampled_figures sampling_bench::kept_figures(const job& what, std::size_t cell) const {
  sampled_figures f;
  std::vector<std::uint32_t> set;
  const std::string key = key_of(what, cell);
  const auto bytes = kept_.read(key, "sampled");
  if (!bytes || !decode(*bytes, ground_.polygons(), f, set)) return {.key = key};
  f.key = key;
  f.from_cache = true;
  return f;
}

std::size_t sampling_bench::missing(const job& what) const {
  std::size_t count = 0;
  for (std::size_t cell = 0; cell < ground_.cells.size(); ++cell)
    if (!kept_figures(what, cell).from_cache) ++count;
  return count;
}

bake::hemicube_source& sampling_bench::source_of(const bake::settings& how) {
  const std::string wanted = fmt::format("{} {}", how.source, how.resolution);
  if (eyes_for_ != wanted) {
    eyes_.source.reset();  // before the context that it was made with
    eyes_ = {};
    eyes_ = bake::choose_source(how, ground_.geometry, ground_.rays);
    eyes_for_ = wanted;
  }
  return *eyes_.source;
}

// Of the scene, as its ray tree is: no sampler's time.
const bake::near_polygons* sampling_bench::neighbors() {
  if ((how_.sampler == "guided" || how_.max_pixel_error > 0.0) && !neighbors_) neighbors_.emplace(ground_.rays);
  return neighbors_ ? &*neighbors_ : nullptr;
}

std::vector<sampled_figures> sampling_bench::run(const job& what,
                                                 const std::function<void(std::size_t cell)>& measured) {
  std::vector<sampled_figures> figures;
  std::vector<std::size_t> cells;
  for (std::size_t cell = 0; cell < ground_.cells.size(); ++cell) {
    figures.push_back(kept_figures(what, cell));
    if (!figures.back().from_cache) cells.push_back(cell);
  }
  if (!cells.empty()) measure(what, cells, figures, measured);
  return figures;
}

sampled_figures sampling_bench::run_cell(const job& what, std::size_t cell) {
  std::vector<sampled_figures> figures(ground_.cells.size());
  figures[cell] = kept_figures(what, cell);
  if (!figures[cell].from_cache) measure(what, {cell}, figures, nullptr);
  return figures[cell];
}

void sampling_bench::measure(const job& what, const std::vector<std::size_t>& cells,
                             std::vector<sampled_figures>& figures,
                             const std::function<void(std::size_t cell)>& measured) {
  how_ = what.how;
  bake::hemicube_source& eyes = source_of(how_);
  without_importance flat(eyes);
  bake::hemicube_source& source = what.importance ? eyes : flat;
  sampler_->by_process = source.device_seconds().has_value();
  sampler_->inner = bake::make_cell_sampler(how_, {ground_.rays, source, &ground_.colors, ground_.cells, neighbors()});
  const double began = bake::process_cpu_seconds();
  sampler_->inner->prepare([](double) { return true; });
  baker_.emplace(how_, none_, ground_.rays, neighbors(), ground_.duplicates, *sampler_);
  const double prepared = (bake::process_cpu_seconds() - began) / static_cast<double>(ground_.cells.size());

  std::atomic<std::size_t> next{0};
  std::mutex one_at_a_time;
  std::exception_ptr failure;
  const auto work = [&] {
    tbb::task_arena alone(1);
    alone.execute([&] {
      try {
        bake::cell_set set = baker_->make_set();
        for (std::size_t i; (i = next++) < cells.size();) {
          sampled_figures& f = figures[cells[i]];
          sampling_seconds = 0.0;
          const bool bounded = how_.max_pixel_error > 0.0;
          const double start = sampler_->seconds();
          const bake::view_cell& cell = ground_.cells[cells[i]];
          const bake::cell_record found = bounded ? baker_->sample_and_finish(cell, set) : baker_->sample(cell, set);
          f.samples = found.samples;
          f.rays = found.rays_spent;
          f.upper_bound = found.upper_bound;
          f.cpu_seconds = prepared + (bounded ? sampler_->seconds() - start : sampling_seconds);
          f.set_size = static_cast<std::uint32_t>(found.set.size());
          kept_.write(f.key, "sampled", encode(f, found.set));
          const std::lock_guard lock(one_at_a_time);
          if (measured) measured(cells[i]);
        }
      } catch (...) {
        const std::lock_guard lock(one_at_a_time);
        failure = std::current_exception();
        next = cells.size();
      }
    });
  };
  std::vector<std::thread> others;
  for (unsigned i = 0; i < std::min<std::size_t>(threads_, cells.size()); ++i) others.emplace_back(work);
  for (std::thread& other : others) other.join();
  sampler_->inner.reset();
  if (failure) std::rethrow_exception(failure);
}

std::vector<std::uint32_t> sampling_bench::set_of(const sampled_figures& figures) const {
  const auto bytes = kept_.read(figures.key, "sampled");
  sampled_figures again;
  std::vector<std::uint32_t> set;
  if (!bytes || !decode(*bytes, ground_.polygons(), again, set))
    throw error(error_kind::failed, "bench.kept", figures.key, "is no longer kept", "leave the cache alone, run again");
  return set;
}

}  // namespace sightcell::bench
