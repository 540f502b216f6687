#include "bench/hemicube/measure.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <numeric>

#include "bench/hemicube/plain_draw.h"
#include "bench/hemicube/poses.h"
#include "bench/hemicube/world.h"
#include "sightcell/base/error.h"
#include "sightcell/base/process_time.h"

namespace sightcell::bench {
namespace {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

struct cost {
  double cpu = 0.0, wall = 0.0;  // seconds
};

template <class Work>
cost cost_of(const Work& work) {
  const double wall = wall_seconds(), cpu = bake::process_cpu_seconds();
  work();
  const double cpu_after = bake::process_cpu_seconds();
  return {cpu_after - cpu, wall_seconds() - wall};
}

// Keeps the compiler from leaving out loops whose results nobody reads.
template <class T>
void use(const T* values) {
  asm volatile("" : : "r"(values) : "memory");
}

// What no source can do without: every pixel written, the corners of the seen polygons read.
class memory_floor {
 public:
  explicit memory_floor(std::uint32_t resolution)
      : ids_(3 * std::size_t{resolution} * resolution), depths_(ids_.size()) {}

  void run(const scene::world_geometry& geometry, std::span<const bake::seen_polygon> seen) {
    const auto id = static_cast<std::uint32_t>(seen.size());
    const auto depth = static_cast<float>(id);
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      ids_[i] = id;
      depths_[i] = depth;
    }
    use(ids_.data());
    use(depths_.data());
    glm::vec3 sum{0.0f};
    for (const bake::seen_polygon& polygon : seen)
      for (std::size_t k = 0; k < 3; ++k) sum += geometry.positions[geometry.indices[3 * std::size_t{polygon.id} + k]];
    use(&sum);
  }

 private:
  std::vector<std::uint32_t> ids_;
  std::vector<float> depths_;
};

// All rounds of one source: seconds by pose, then by round.
struct track {
  std::vector<std::vector<double>> cpu, wall, draw, gather, statistics;
  std::vector<std::uint32_t> polygons;
  std::vector<std::uint64_t> pixels;
  bool steady = true;  // each pose gave the same counts in every round

  explicit track(std::size_t poses)
      : cpu(poses), wall(poses), draw(poses), gather(poses), statistics(poses), polygons(poses), pixels(poses) {}

  void count(std::size_t pose, bool first, const bake::hemicube_view& view) {
    const auto seen = static_cast<std::uint32_t>(view.seen.size());
    std::uint64_t sum = 0;
    for (const bake::seen_polygon& p : view.seen) sum += p.pixels;
    if (!first) steady = steady && polygons[pose] == seen && pixels[pose] == sum;
    polygons[pose] = seen;
    pixels[pose] = sum;
  }
};

std::vector<double> of_poses(const std::vector<std::vector<double>>& rounds) {
  std::vector<double> values;
  for (const auto& one : rounds) values.push_back(1e3 * median(one));
  return values;
}

double mean(const auto& values) {
  double sum = 0.0;
  for (const auto value : values) sum += static_cast<double>(value);
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

json result_of(const track& t) {
  const auto cpu = of_poses(t.cpu);
  json out{{"ms", median(cpu)},
           {"ms_mean", mean(cpu)},
           {"ms_largest", *std::max_element(cpu.begin(), cpu.end())},
           {"wall_ms", median(of_poses(t.wall))}};
  const bool split = !t.draw.front().empty();
  out["draw_ms"] = split ? json(median(of_poses(t.draw))) : json();
  out["gather_ms"] = split ? json(median(of_poses(t.gather))) : json();
  out["statistics_ms"] = split ? json(median(of_poses(t.statistics))) : json();
  out["pixels_seen"] = mean(t.pixels);
  out["polygons_seen"] = mean(t.polygons);
  out["steady"] = t.steady;
  out["ms_of_poses"] = cpu;
  out["polygons_of_poses"] = t.polygons;
  return out;
}

// Rounds of all sources over all poses; the last one asks for the parts.
void run_rounds(const json& job, const json& part, const world& w, std::span<const bake::pose> poses,
                std::vector<named_source>& sources, std::vector<track>& tracks) {
  const auto rounds = job.at("rounds").get<std::size_t>();
  memory_floor floor(job.at("resolution").get<std::uint32_t>());
  track& floor_track = tracks.back();
  std::vector<bake::hemicube_view> views(sources.size());
  for (std::size_t round = 0; round <= rounds + 1; ++round) {
    const bool warm_up = round == 0, parts = round == rounds + 1;
    for (std::size_t p = 0; p < poses.size(); ++p) {
      for (std::size_t i = 0; i < sources.size(); ++i) {
        const std::size_t s = (i + p + round) % sources.size();
        bake::hemicube_source& source = *sources[s].source;
        track& t = tracks[s];
        if (parts) {
          const auto split = source.render_split(poses[p], views[s]);
          if (!split) continue;
          t.draw[p].push_back(split->draw);
          t.gather[p].push_back(split->gather);
          t.statistics[p].push_back(split->statistics);
        } else {
          const cost c = cost_of([&] { source.render(poses[p], views[s]); });
          if (!warm_up) {
            t.cpu[p].push_back(c.cpu);
            t.wall[p].push_back(c.wall);
          }
        }
        t.count(p, warm_up, views[s]);
      }
      if (parts) continue;
      const cost c = cost_of([&] { floor.run(w.geometry, views.front().seen); });
      floor_track.count(p, warm_up, views.front());
      if (warm_up) continue;
      floor_track.cpu[p].push_back(c.cpu);
      floor_track.wall[p].push_back(c.wall);
    }
    std::string line = fmt::format("{}: round {} of {}", part.at("label").get<std::string>(), round, rounds + 1);
    if (!warm_up)
      for (std::size_t s = 0; s < sources.size(); ++s)
        line += fmt::format(", {} {:.2f} ms", sources[s].name, median(of_poses(tracks[s].cpu)));
    say(line);
  }
}

// A device's own pace: all poses in one call, wall time, the median of the rounds. Against drawing everything.
void add_pace(const world& w, std::span<const bake::pose> poses, std::size_t rounds, named_source& gpu, json& out) {
  plain_draw plain(w, gpu.source->resolution());
  std::vector<bake::hemicube_view> views(poses.size());
  std::vector<double> source_seconds, plain_seconds;
  for (std::size_t round = 0; round <= rounds; ++round) {
    const cost c = cost_of([&] { gpu.source->render(poses, views); });
    const cost p = cost_of([&] { plain.render(poses); });
    if (round == 0) continue;
    source_seconds.push_back(c.wall);
    plain_seconds.push_back(p.wall);
  }
  const auto count = static_cast<double>(poses.size());
  out["samples_per_second"] = count / median(source_seconds);
  out["plain_draws_per_second"] = count / median(plain_seconds);
}

std::size_t memory_field(const char* name) {
  std::ifstream in("/proc/self/status");
  std::string word;
  std::size_t kilobytes = 0;
  while (in >> word)
    if (word == name && in >> kilobytes) return kilobytes * 1024;
  return 0;
}

}  // namespace

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

json measure_time(const json& job) {
  const world w(job.at("scene").get<std::string>());
  std::vector<named_source> sources;
  for (const json& name : job.at("sources")) {
    sources.push_back(make_source(name.get<std::string>(), w, job.at("resolution").get<std::uint32_t>(),
                                  job.at("culling").get<std::string>()));
    say(fmt::format("{}: {}: {}", w.name, sources.back().name, sources.back().source->device()));
  }
  for (const json& part : job.at("parts")) {
    const auto poses = read_poses(part.at("poses"));
    std::vector<track> tracks(sources.size() + 1, track(poses.size()));
    tbb::task_arena one_thread(1);
    one_thread.execute([&] { run_rounds(job, part, w, poses, sources, tracks); });
    json result = part.at("facts");
    result["polygons"] = w.polygons();
    result["poses"] = poses.size();
    for (std::size_t s = 0; s < sources.size(); ++s) {
      json& of_source = result["sources"][sources[s].name] = result_of(tracks[s]);
      of_source["device"] = sources[s].source->device();
      of_source["software"] = sources[s].software();
      if (sources[s].context && (!sources[s].software() || job.at("pace").get<bool>()))
        add_pace(w, poses, job.at("rounds").get<std::size_t>(), sources[s], of_source);
    }
    result["sources"]["floor"] = result_of(tracks.back());
    write_json(part.at("result").get<std::string>(), result);
  }
  return json::object();
}

json probe(const json& job) {
  try {
    // The smallest scene there is: one polygon.
    world w;
    w.geometry.positions = {{-1, -1, -2}, {1, -1, -2}, {0, 1, -2}};
    w.geometry.indices = {0, 1, 2};
    w.geometry.kinds.resize(1);
    w.geometry.min = {-1, -1, -2};
    w.geometry.max = {1, 1, -2};
    w.far_plane = 3.0f;
    const named_source made = make_source(job.at("source").get<std::string>(), w, 16);
    return {{"ok", true}, {"what", made.source->device()}};
  } catch (const error& e) {
    return {{"ok", false}, {"what", e.what()}};
  }
}

json measure_memory(const json& job) {
  const world w(job.at("scene").get<std::string>());
  const std::size_t before = memory_field("VmRSS:"), loading = memory_field("VmHWM:");
  // From here on the peak is the source's, not that of loading the scene.
  bool reset = false;
  {
    std::ofstream clear("/proc/self/clear_refs");
    clear << "5" << std::flush;
    reset = clear.good();
  }
  named_source made = make_source(job.at("source").get<std::string>(), w, job.at("resolution").get<std::uint32_t>(),
                                  job.at("culling").get<std::string>());
  const auto poses = read_poses(job.at("poses"));
  bake::hemicube_view view;
  std::vector<bake::hemicube_view> views(poses.size());
  std::vector<double> cpu, together;
  tbb::task_arena one_thread(1);
  one_thread.execute([&] {
    for (int round = 0; round < 3; ++round) {
      for (const bake::pose& where : poses) {
        const cost c = cost_of([&] { made.source->render(where, view); });
        if (round > 0) cpu.push_back(c.cpu);
      }
      const cost c = cost_of([&] { made.source->render(poses, views); });
      if (round > 0) together.push_back(c.cpu / static_cast<double>(poses.size()));
    }
  });
  const std::size_t peak = memory_field("VmHWM:");
  return {{"before", before},
          {"loading_peak", loading},
          {"peak", peak},
          {"own", peak > before ? peak - before : 0},
          {"own_is_exact", reset},
          {"ms", 1e3 * median(cpu)},
          {"ms_mean", 1e3 * mean(cpu)},
          {"ms_mean_together", 1e3 * mean(together)},
          {"software", made.software()},
          {"device", made.source->device()}};
}

json measure_threads(const json& job) {
  const world w(job.at("scene").get<std::string>());
  named_source made = make_source("cpu", w, job.at("resolution").get<std::uint32_t>());
  const auto once = read_poses(job.at("poses"));
  std::vector<bake::pose> poses;  // so many that the last hemicube, drawn while the other thread idles, does not matter
  while (poses.size() < 200) poses.insert(poses.end(), once.begin(), once.end());
  const auto rounds = job.at("rounds").get<std::size_t>();
  std::vector<bake::hemicube_view> views(poses.size());
  tbb::task_arena one(1), two(2);
  std::vector<double> cpu[2], ahead;
  for (std::size_t round = 0; round <= rounds; ++round)
    for (std::size_t k = 0; k < 2; ++k) {
      const double own = bake::thread_cpu_seconds();
      const cost c = cost_of([&] { (k == 0 ? one : two).execute([&] { made.source->render(poses, views); }); });
      const double first = bake::thread_cpu_seconds() - own, second = c.cpu - first;
      if (round == 0) continue;
      cpu[k].push_back(c.cpu);
      if (k == 1) ahead.push_back((first - second) / c.cpu);
    }
  return {{"cpu_1", median(cpu[0])},
          {"cpu_2", median(cpu[1])},
          {"parallel_percent", 100.0 * (1.0 - std::clamp(median(ahead), 0.0, 1.0))}};
}

}  // namespace sightcell::bench
