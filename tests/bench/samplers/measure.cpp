#include "bench/samplers/measure.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "bench/samplers/commands.h"
#include "bench/samplers/judge.h"
#include "bench/samplers/sampling.h"

namespace sightcell::bench {
namespace {

using sampled_jobs = std::vector<std::vector<sampled_figures>>;  // by job, then cell
using judgements = std::vector<std::vector<judgement>>;          // likewise

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

json array_of(const glm::vec3& v) {
  return json::array({v.x, v.y, v.z});
}

// Says how far sampling is and how long the rest may take: jobs weigh as their hemicubes, or their seconds.
class sampling_progress {
 public:
  sampling_progress(const sampling_bench& bench, const job_list& list) : list_(list) {
    for (const job& one : list.jobs) {
      weights_.push_back(weight_of(one));
      left_ += weights_.back() * static_cast<double>(bench.missing(one));
    }
  }
  void cell_done(std::size_t job, const std::string& name) {
    done_ += weights_[job];
    left_ -= weights_[job];
    const double left = left_ / done_ * (seconds_now() - began_);
    say(fmt::format("job {} of {}, {}: {}, about {:.0f} s left", job + 1, list_.jobs.size(), list_.jobs[job].label,
                    name, left));
  }

 private:
  static double weight_of(const job& one) {
    if (one.how.seconds_per_cell > 0.0) return one.how.seconds_per_cell;
    const double faces = one.how.resolution / 1024.0;
    return one.how.samples * (0.002 + 0.005 * faces * faces);
  }

  const job_list& list_;
  std::vector<double> weights_;
  double done_ = 0.0, left_ = 0.0, began_ = seconds_now();
};

class truths {
 public:
  truths(const ground& g, const kept_files& kept) : kept_(kept) {
    for (std::size_t cell = 0; cell < g.cells.size(); ++cell) cells_.emplace_back(g, cell).load(kept);
  }
  void extend(std::uint64_t rays) {
    const double began = seconds_now(), cpu_before = cpu_seconds();
    std::uint64_t cast = 0;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const std::uint64_t before = cells_[i].rays();
      cells_[i].extend(rays);
      if (cells_[i].rays() == before) continue;
      cast += cells_[i].rays() - before;
      cells_[i].save(kept_);
      const double left =
          (seconds_now() - began) / static_cast<double>(i + 1) * static_cast<double>(cells_.size() - i - 1);
      say(fmt::format("truth to {} rays: cell {} of {}, about {:.0f} s left", rays, i + 1, cells_.size(), left));
    }
    if (cast > 0)
      say(fmt::format("truth: {:.0f} rays per CPU second", static_cast<double>(cast) / (cpu_seconds() - cpu_before)));
  }
  const std::vector<cell_truth>& cells() const { return cells_; }
  double cpu_seconds() const {
    return std::accumulate(cells_.begin(), cells_.end(), 0.0,
                           [](double sum, const cell_truth& one) { return sum + one.cpu_seconds(); });
  }
  std::uint64_t fewest_rays() const {
    std::uint64_t fewest = UINT64_MAX;
    for (const cell_truth& one : cells_) fewest = std::min(fewest, one.rays());
    return fewest;
  }

 private:
  const kept_files& kept_;
  std::vector<cell_truth> cells_;
};

judgements judge_all(const truths& truth, const kept_files& kept, const sampling_bench& bench,
                     const sampled_jobs& sampled, bool with_color) {
  judgements all(sampled.size(), std::vector<judgement>(truth.cells().size()));
  tbb::parallel_for(std::size_t{0}, truth.cells().size(), [&](std::size_t cell) {
    std::optional<cell_judge> judge;
    for (std::size_t i = 0; i < sampled.size(); ++i) {
      const sampled_figures& figures = sampled[i][cell];
      all[i][cell] = kept_judgement(
          kept, truth.cells()[cell], judge, figures.key, [&] { return bench.set_of(figures); }, with_color);
    }
  });
  return all;
}

// How far the interval reaches on its wider side, as a share of the error.
double reach_of(const pooled_judgement& p) {
  if (p.pixel_error <= 0.0) return INFINITY;
  return std::max(p.bounds.high - p.pixel_error, p.pixel_error - p.bounds.low) / p.pixel_error;
}

// So many independent misses have the interval that is asked for.
double misses_wanted(double interval) {
  double low = 1.0, high = 1e9;
  for (int i = 0; i < 100; ++i) {
    const double middle = std::sqrt(low * high), upper = poisson_interval(middle).high;
    (upper - middle > interval * middle ? low : high) = middle;
  }
  return high;
}

// More rays for all cells, as many as the job with the fewest misses lacks, at most four times as many at once, until
// its interval is as asked for.
void settle_truth(truths& truth, const truth_wish& wish, const kept_files& kept, const sampling_bench& bench,
                  const sampled_jobs& sampled) {
  const double wanted = misses_wanted(wish.interval);
  std::uint64_t rays = wish.first_rays;
  for (;;) {
    truth.extend(rays);
    double fewest = INFINITY;
    for (const auto& cells : judge_all(truth, kept, bench, sampled, false))
      fewest = std::min(fewest, pooled(cells).misses_effective);
    say(fmt::format("truth of {} rays: {:.0f} of {:.0f} misses for the best job", rays, fewest, wanted));
    if (fewest >= wanted || rays >= wish.max_rays) return;
    const double more = std::clamp(1.1 * wanted / std::max(fewest, 1.0), 1.2, 4.0);
    const auto held = std::max(rays, truth.fewest_rays());  // a cache may hold more than were asked for
    rays = std::min(wish.max_rays, static_cast<std::uint64_t>(more * static_cast<double>(held)));
  }
}

json cells_of(const ground& g, const truths& truth) {
  json cells = json::array();
  for (std::size_t i = 0; i < g.cells.size(); ++i) {
    const cell_truth& t = truth.cells()[i];
    cells.push_back({{"name", g.names[i]},
                     {"min", array_of(g.cells[i].min)},
                     {"max", array_of(g.cells[i].max)},
                     {"geometry_inside", static_cast<bool>(g.geometry_inside[i])},
                     {"free_share", t.valid_share()},
                     {"truth_rays", t.rays()},
                     {"truth_polygons", t.polygons().size()}});
  }
  return cells;
}

json job_text(const job& one, const std::vector<sampled_figures>& sampled, const std::vector<judgement>& judged,
              std::uint32_t polygons, double interval) {
  json cells = json::array();
  double cpu = 0.0, samples = 0.0, rays = 0.0, sets = 0.0;
  for (std::size_t i = 0; i < sampled.size(); ++i) {
    const sampled_figures& f = sampled[i];
    const judgement& j = judged[i];
    const auto [low, high] = j.bounds();
    cells.push_back({{"samples", f.samples},
                     {"rays", f.rays},
                     {"cpu_seconds", f.cpu_seconds},
                     {"upper_bound", f.upper_bound},
                     {"set", f.set_size},
                     {"pixel_error", j.pixel_error()},
                     {"low", low},
                     {"high", high},
                     {"misses", j.misses},
                     {"misses_effective", j.misses_effective()},
                     {"color_error", j.color_error()},
                     {"from_cache", f.from_cache}});
    cpu += f.cpu_seconds;
    samples += f.samples;
    rays += static_cast<double>(f.rays);
    sets += f.set_size;
  }
  const auto count = static_cast<double>(sampled.size());
  const pooled_judgement all = pooled(judged);
  json text{{"label", one.label}, {"settings", one.settings}};
  text["pooled"] = {{"pixel_error", all.pixel_error},
                    {"low", all.bounds.low},
                    {"high", all.bounds.high},
                    {"misses_effective", all.misses_effective},
                    {"interval_met", reach_of(all) <= interval},
                    {"color_error", all.color_error},
                    {"visible_percent", 100.0 * sets / count / polygons},
                    {"cpu_seconds", cpu / count},
                    {"samples", samples / count},
                    {"rays", rays / count}};
  text["cells"] = std::move(cells);
  return text;
}

}  // namespace

json measure_samplers(const ground& g, const job_list& list, const kept_files& kept, unsigned threads) {
  sampling_bench bench(g, kept, threads);
  sampling_progress progress(bench, list);
  sampled_jobs sampled;
  for (std::size_t i = 0; i < list.jobs.size(); ++i)
    sampled.push_back(bench.run(list.jobs[i], [&](std::size_t cell) { progress.cell_done(i, g.names[cell]); }));
  truths truth(g, kept);
  settle_truth(truth, list.truth, kept, bench, sampled);
  const judgements judged = judge_all(truth, kept, bench, sampled, true);

  json jobs = json::array();
  bool met = true;
  double sampling_seconds = 0.0;
  for (std::size_t i = 0; i < list.jobs.size(); ++i) {
    jobs.push_back(job_text(list.jobs[i], sampled[i], judged[i], g.polygons(), list.truth.interval));
    const json& all = jobs.back()["pooled"];
    if (!all["interval_met"].get<bool>())
      say(fmt::format("{}: the interval {:.3g} to {:.3g} of its pixel error {:.3g} is wider than asked for",
                      list.jobs[i].label, all["low"].get<double>(), all["high"].get<double>(),
                      all["pixel_error"].get<double>()));
    met = met && all["interval_met"].get<bool>();
    for (const sampled_figures& f : sampled[i]) sampling_seconds += f.cpu_seconds;
  }
  return {{"scene", g.s.name},
          {"hash", g.hash},
          {"polygons", g.polygons()},
          {"left_out", g.left_out},
          {"cells", cells_of(g, truth)},
          {"jobs", std::move(jobs)},
          {"truth",
           {{"interval", list.truth.interval},
            {"interval_met", met},
            {"rays", truth.fewest_rays()},
            {"place_rays", rays_of_place}}},
          {"truth_cpu_seconds", truth.cpu_seconds()},
          {"sampling_cpu_seconds", sampling_seconds}};
}

void run_measure(const bench_options& how) {
  const job_list list = read_jobs(how.jobs);
  const auto g = load_ground(how.scene, how.cells, how.cell_limit, list.jobs.front().rules(), how.scene_hash);
  write_json(how.out, measure_samplers(*g, list, kept_files(how.cache), how.threads));
}

}  // namespace sightcell::bench
