// bench_hemicube: what a hemicube costs: CPU time of one core per sample, by scene, height and source, against the
// floor of writing the pixels and reading the seen polygons; memory by source.
// It judges nothing: it prints.
//
// The program plans, prints and keeps results; what is measured runs in workers: itself with --worker JOB.json.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>

#include "bench/hemicube/child.h"
#include "bench/hemicube/measure.h"
#include "bench/hemicube/poses.h"
#include "bench/hemicube/report.h"
#include "bench/hemicube/scenes.h"
#include "bench/hemicube/world.h"
#include "sightcell/base/error.h"

namespace {

using namespace sightcell::bench;

struct options {
  std::vector<std::string> scenes = scene_names(), heights{std::begin(all_heights), std::end(all_heights)};
  std::vector<std::string> sources = source_names();
  std::size_t poses = 24, rounds = 3;
  std::uint32_t resolution = 1024;
  std::uint64_t seed = 1;
  bool quick = false, fresh = false, no_memory = false, pace = false;
  std::string commit, json_file, worker;
};

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

int work(const std::string& file) {
  const json job = read_json(file).value();
  const auto kind = job.at("job").get<std::string>();
  json answer;
  if (kind == "poses") answer = make_poses(job);
  if (kind == "probe") answer = probe(job);
  if (kind == "time") answer = measure_time(job);
  if (kind == "memory") answer = measure_memory(job);
  if (kind == "threads") answer = measure_threads(job);
  write_json(job.at("answer").get<std::string>(), answer);
  return 0;
}

// How the gpu source is set: what is best differs by scene, so it is tried.
struct gpu_setting {
  std::string threads, culling;  // LP_NUM_THREADS of llvmpipe, empty: not set; culling by name, empty: as in a bake
  std::string text() const {
    return fmt::format("LP_NUM_THREADS {}, {} culling", threads.empty() ? "not set" : threads,
                       culling.empty() ? "a bake's" : culling);
  }
  std::vector<std::string> environment() const {
    if (threads.empty()) return {};
    return {"LP_NUM_THREADS=" + threads};
  }
};

class bench {
 public:
  explicit bench(const options& how) : how_(how), code_(how.commit), processor_(processor()) {
    if (code_.empty()) code_ = "program " + hash_of_file(own_program()).substr(0, 16);
  }

  void measure(const bench_scene& scene) {
    const json poses =
        remembered(key("poses", {scene.hash, std::to_string(poses_version), count(how_.poses), count(how_.seed)}), [&] {
          say(scene.name + ": choosing poses");
          return run_job({{"job", "poses"},
                          {"scene", scene.file.string()},
                          {"cells", scene.cells.string()},
                          {"poses", how_.poses},
                          {"seed", how_.seed}});
        });
    say(fmt::format("{}: {} poses, {}", scene.name, poses.at("heights").at("street").size(),
                    poses.at("cells").get<std::string>()));
    const gpu_setting gpu = how_.no_memory ? gpu_setting{"0", ""} : measure_memory_of(scene, poses);
    measure_time_of(scene, poses, gpu);
    if (scene.name == how_.scenes.front() && asked("cpu")) measure_threads_of(scene, poses);
  }

  const measured& all() const { return all_; }
  json facts() const {
    return {{"code", code_},
            {"processor", processor_},
            {"resolution", how_.resolution},
            {"rounds", how_.rounds},
            {"seed", how_.seed}};
  }

 private:
  static std::string count(std::uint64_t value) { return std::to_string(value); }

  std::filesystem::path key(const std::string& kind, const std::vector<std::string>& parts) const {
    std::string text = kind;
    for (const std::string& part : parts) text += '\n' + part;
    return cache_folder() / (kind + "-" + hash_of_text(text) + ".json");
  }

  json remembered(const std::filesystem::path& path, const std::function<json()>& measure) const {
    if (auto known = read_json(path); known && !how_.fresh) return *known;
    json value = measure();
    write_json(path, value);
    return value;
  }

  bool asked(const std::string& source) const {
    return std::find(how_.sources.begin(), how_.sources.end(), source) != how_.sources.end();
  }

  // A process per source. Gives the setting of gpu that costs the least CPU time in the street; on hardware it is left
  // as in a bake.
  gpu_setting measure_memory_of(const bench_scene& scene, const json& poses) {
    gpu_setting best;
    for (const std::string& source : how_.sources) {
      std::vector<gpu_setting> settings{{"", ""}};
      if (source == "gpu") settings = {{"", ""}, {"0", "frustum"}, {"1", "frustum"}, {"0", "occlusion"}};
      json chosen, tried = json::object();
      for (const gpu_setting& setting : settings) {
        const json found = memory_of(scene, poses, source, setting);
        tried[setting.text()] = found.at("ms");
        if (chosen.is_null() || found.at("ms") < chosen.at("ms")) {
          chosen = found;
          if (source == "gpu") best = setting;
        }
        if (!found.at("software").get<bool>()) break;
      }
      if (source == "gpu") {
        chosen["setting"] = best.text();
        chosen["ms_by_setting"] = tried;
      }
      all_.memory[scene.name][source] = chosen;
    }
    return best;
  }

  json memory_of(const bench_scene& scene, const json& poses, const std::string& source, const gpu_setting& setting) {
    return remembered(
        key("memory", {scene.hash, code_, processor_, source, setting.threads, setting.culling, count(how_.resolution),
                       count(how_.poses), count(how_.seed)}),
        [&] {
          say(fmt::format("{}: memory of {}{}", scene.name, source, source == "gpu" ? ", " + setting.text() : ""));
          json some = json::array();
          const json& street = poses.at("heights").at("street");
          for (std::size_t i = 0; i < std::min<std::size_t>(street.size(), 6); ++i) some.push_back(street[i]);
          return run_job({{"job", "memory"},
                          {"scene", scene.file.string()},
                          {"source", source},
                          {"culling", setting.culling},
                          {"poses", some},
                          {"resolution", how_.resolution}},
                         setting.environment());
        });
  }

  // How CPU seconds grow with threads, on the first of the scenes.
  void measure_threads_of(const bench_scene& scene, const json& poses) {
    all_.threads = remembered(key("threads", {scene.hash, code_, processor_, count(how_.resolution), count(how_.poses),
                                              count(how_.rounds), count(how_.seed)}),
                              [&] {
                                say(scene.name + ": cpu with one and with two threads");
                                return run_job({{"job", "threads"},
                                                {"scene", scene.file.string()},
                                                {"poses", poses.at("heights").at("street")},
                                                {"rounds", how_.rounds},
                                                {"resolution", how_.resolution}});
                              });
  }

  void measure_time_of(const bench_scene& scene, const json& poses, const gpu_setting& gpu) {
    std::vector<std::filesystem::path> paths;
    json parts = json::array();
    for (const std::string& height : how_.heights) {
      std::vector<std::string> of{scene.hash,
                                  code_,
                                  processor_,
                                  height,
                                  gpu.text(),
                                  count(how_.resolution),
                                  count(how_.poses),
                                  count(how_.rounds),
                                  count(how_.seed),
                                  std::to_string(poses_version),
                                  how_.pace ? "pace" : ""};
      of.insert(of.end(), how_.sources.begin(), how_.sources.end());
      paths.push_back(key("time", of));
      if (std::filesystem::exists(paths.back()) && !how_.fresh) continue;
      parts.push_back({{"label", scene.name + " " + height},
                       {"poses", poses.at("heights").at(height)},
                       {"facts", {{"scene", scene.name}, {"height", height}, {"gpu_setting", gpu.text()}}},
                       {"result", paths.back().string()}});
    }
    if (!parts.empty())
      run_job({{"job", "time"},
               {"scene", scene.file.string()},
               {"sources", how_.sources},
               {"culling", gpu.culling},
               {"resolution", how_.resolution},
               {"rounds", how_.rounds},
               {"pace", how_.pace},
               {"parts", parts}},
              gpu.environment());
    for (const auto& path : paths) all_.results.push_back(read_json(path).value());
  }

  const options& how_;
  std::string code_, processor_;
  measured all_;
};

void declare(CLI::App& app, options& how) {
  const std::vector<std::string> known(std::begin(all_heights), std::end(all_heights));
  std::vector<std::string> known_sources = kernel_names();
  known_sources.insert(known_sources.end(), source_names().begin(), source_names().end());
  app.add_option("--scenes,--scene", how.scenes, "names or files");
  app.add_option("--heights", how.heights, "street, or meters above the street: 20, 70, 200")
      ->check(CLI::IsMember(known));
  app.add_option("--sources", how.sources,
                 "cpu, gpu, rays; cpu-avx2 and so on: the rasterizer with that instruction set")
      ->check(CLI::IsMember(known_sources));
  app.add_option("--poses", how.poses, "per scene and height")->check(CLI::Range(1, 10000))->capture_default_str();
  app.add_option("--rounds", how.rounds, "over all poses, beside the warm-up")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--resolution", how.resolution, "pixels along a face")
      ->check(CLI::Range(16, 4096))
      ->check([](const std::string& text) { return std::stoul(text) % 2 == 0 ? "" : text + " is not even"; }, "even")
      ->capture_default_str();
  app.add_option("--seed", how.seed, "of the poses")->capture_default_str();
  app.add_flag("--quick", how.quick,
               "a small town, street and 20 m, 256 pixels, 3 poses, 1 round, if not said otherwise");
  app.add_flag("--fresh", how.fresh, "measure again what is kept");
  app.add_flag("--no-memory", how.no_memory, "no processes of their own for memory; llvmpipe draws without threads");
  app.add_flag("--pace", how.pace, "samples per second of gpu against plain draws of everything on software too");
  app.add_option("--commit", how.commit, "name results by it; else by the bytes of this program");
  app.add_option("--json-file", how.json_file, "everything that was measured");
  app.add_option("--worker", how.worker, "")->group("");
}

void make_quick(const CLI::App& app, options& how) {
  const auto unsaid = [&](const char* name) { return app.count(name) == 0; };
  if (unsaid("--scenes")) how.scenes = {small_town};
  if (unsaid("--heights")) how.heights = {"street", "20"};
  if (unsaid("--resolution")) how.resolution = 256;
  if (unsaid("--poses")) how.poses = 3;
  if (unsaid("--rounds")) how.rounds = 1;
}

int run(options& how) {
  if (!how.worker.empty()) return work(how.worker);
  std::vector<std::string> there;
  for (const std::string& source : how.sources) {
    const json found = run_job({{"job", "probe"}, {"source", source}});
    say(source + ": " + found.at("what").get<std::string>());
    if (found.at("ok").get<bool>()) there.push_back(source);
  }
  how.sources = there;
  if (there.empty())
    throw sightcell::error(sightcell::error_kind::failed, "bench.nothing", "this machine",
                           "has no source of hemicubes that was asked for", "see the messages above");
  bench all(how);
  for (const std::string& name : how.scenes)
    if (const auto scene = find_scene(name)) all.measure(*scene);
  if (all.all().results.empty())
    throw sightcell::error(sightcell::error_kind::failed, "bench.nothing", "scenes", "none was there",
                           "set SIGHTCELL_DATA or name a file with --scene");
  const json facts = all.facts();
  fmt::print("{}; {}; {} pixels along a face, {} poses, {} rounds\n\n", facts.at("code").get<std::string>(),
             facts.at("processor").get<std::string>(), how.resolution, how.poses, how.rounds);
  print_tables(all.all());
  if (!how.json_file.empty())
    write_json(how.json_file, {{"facts", facts},
                               {"results", all.all().results},
                               {"memory", all.all().memory},
                               {"threads", all.all().threads}});
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What a hemicube costs, by scene, height and source.", "bench_hemicube");
  options how;
  declare(app, how);
  try {
    app.parse(argc, argv);
    if (how.quick) make_quick(app, how);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    return run(how);
  } catch (const std::exception& e) {
    std::cerr << "bench_hemicube: " << e.what() << '\n';
    return 1;
  }
}
