#include "bench/hemicube/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace sightcell::bench {
namespace {

const json* result_at(const measured& all, const std::string& scene, const std::string& height) {
  for (const json& r : all.results)
    if (r.at("scene") == scene && r.at("height") == height) return &r;
  return nullptr;
}

std::optional<double> ms_of(const json& result, const std::string& source) {
  const json& sources = result.at("sources");
  if (!sources.contains(source)) return std::nullopt;
  return sources.at(source).at("ms").get<double>();
}

std::optional<double> ms_at(const measured& all, const std::string& scene, const std::string& height,
                            const std::string& source) {
  const json* r = result_at(all, scene, height);
  return r == nullptr ? std::nullopt : ms_of(*r, source);
}

std::optional<double> ratio(std::optional<double> a, std::optional<double> b) {
  if (!a || !b || *b <= 0.0) return std::nullopt;
  return *a / *b;
}

std::string grouped(std::uint64_t value) {
  return value < 1000 ? std::to_string(value) : fmt::format("{},{:03}", grouped(value / 1000), value % 1000);
}

std::string grouped(double value) {
  return grouped(static_cast<std::uint64_t>(std::llround(value)));
}

std::string times(std::optional<double> value) {
  return value ? fmt::format("{:.2f}", *value) : "-";
}

std::string cost_text(const json& source) {
  std::string text = fmt::format("{:.2f}", source.at("ms").get<double>());
  if (!source.at("draw_ms").is_null())
    text += fmt::format(" ({:.2f} + {:.2f} + {:.2f})", source.at("draw_ms").get<double>(),
                        source.at("gather_ms").get<double>(), source.at("statistics_ms").get<double>());
  return text;
}

double geometric_mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += std::log(v);
  return std::exp(sum / static_cast<double>(values.size()));
}

void print_means(const measured& all) {
  fmt::print(
      "\n| geometric means over scenes | scenes | cpu, ms | gpu / cpu | rays / cpu | rays / gpu | cpu / floor |\n"
      "|---|---|---|---|---|---|---|\n");
  std::vector<std::string> heights;
  for (const json& r : all.results) {
    const auto height = r.at("height").get<std::string>();
    if (std::find(heights.begin(), heights.end(), height) == heights.end()) heights.push_back(height);
  }
  for (const std::string& height : heights) {
    std::vector<double> cpu, gpu, rays, rays_gpu, floor;
    std::size_t scenes = 0;
    for (const json& r : all.results) {
      if (r.at("height") != height) continue;
      ++scenes;
      const auto keep = [](std::vector<double>& list, std::optional<double> value) {
        if (value) list.push_back(*value);
      };
      keep(cpu, ms_of(r, "cpu"));
      keep(gpu, ratio(ms_of(r, "gpu"), ms_of(r, "cpu")));
      keep(rays, ratio(ms_of(r, "rays"), ms_of(r, "cpu")));
      keep(rays_gpu, ratio(ms_of(r, "rays"), ms_of(r, "gpu")));
      keep(floor, ratio(ms_of(r, "cpu"), ms_of(r, "floor")));
    }
    fmt::print("| {} | {} |", height, scenes);
    for (const auto* list : {&cpu, &gpu, &rays, &rays_gpu, &floor})
      fmt::print(" {} |", list->empty() ? "-" : fmt::format("{:.2f}", geometric_mean(*list)));
    fmt::print("\n");
  }
}

void print_memory(const measured& all) {
  if (all.memory.empty()) return;
  fmt::print(
      "\n| scene | source | scene alone, MiB | peak, MiB | the source's own, MiB | peak while loading, MiB |\n"
      "|---|---|---|---|---|---|\n");
  for (const auto& [scene, sources] : all.memory.items())
    for (const auto& [source, m] : sources.items()) {
      const auto mib = [&m = m](const char* key) { return m.at(key).get<double>() / 1048576.0; };
      fmt::print("| {} | {} | {:.0f} | {:.0f} | {:.0f}{} | {:.0f} |\n", scene, source, mib("before"), mib("peak"),
                 mib("own"), m.at("own_is_exact").get<bool>() ? "" : " (loading included)", mib("loading_peak"));
    }
}

// How the cost grows with the scene: the same style of town at two sizes.
void print_growth(const measured& all) {
  std::string rows;
  for (const json& large : all.results) {
    if (large.at("scene") != "vienna8m") continue;
    const auto height = large.at("height").get<std::string>();
    const json* small = result_at(all, "vienna800k", height);
    if (small == nullptr) continue;
    for (const auto& [source, s] : large.at("sources").items())
      if (const auto by = ratio(ms_of(large, source), ms_of(*small, source)))
        rows += fmt::format("| {} | {} | {:.2f} | {:.2f} | {:.2f} |\n", height, source, *ms_of(*small, source),
                            *ms_of(large, source), *by);
  }
  if (rows.empty()) return;
  fmt::print(
      "\n| height | source | vienna800k, ms | vienna8m, ms | growth from 0.87 to 7.9 M polygons |\n"
      "|---|---|---|---|---|\n{}",
      rows);
}

// How the gpu source was set, and what else was tried.
void print_gpu_settings(const measured& all) {
  for (const auto& [scene, sources] : all.memory.items()) {
    if (!sources.contains("gpu") || !sources.at("gpu").at("software").get<bool>()) continue;
    const json& gpu = sources.at("gpu");
    std::string tried;
    for (const auto& [setting, ms] : gpu.at("ms_by_setting").items())
      tried += fmt::format("{}{}: {:.2f} ms", tried.empty() ? "" : "; ", setting, ms.get<double>());
    fmt::print("\n{}: gpu with {} ({}).\n", scene, gpu.at("setting").get<std::string>(), tried);
  }
}

// What a hardware GPU did, with its name; else which device drew.
std::string hardware_text(const measured& all) {
  std::string text, device = "none";
  bool software = false;
  for (const json& r : all.results) {
    const json& sources = r.at("sources");
    if (!sources.contains("gpu")) continue;
    const json& gpu = sources.at("gpu");
    device = gpu.at("device").get<std::string>();
    software = gpu.at("software").get<bool>();
    if (gpu.contains("samples_per_second"))
      text += fmt::format("{}{} {} {:.0f}/s (plain draws of everything {:.0f}/s)", text.empty() ? "" : ", ",
                          r.at("scene").get<std::string>(), r.at("height").get<std::string>(),
                          gpu.at("samples_per_second").get<double>(), gpu.at("plain_draws_per_second").get<double>());
  }
  if (software && !text.empty()) text += " (a software rasteriser: no hardware GPU at hand)";
  return text.empty() ? "no hardware GPU at hand; device: " + device : device + ": " + text;
}

// One target: measured against a limit, smaller or larger being better.
class target_list {
 public:
  void at_most(const std::string& text, std::optional<double> value, double limit, const char* unit) {
    add(text, value, unit, value && *value <= limit);
  }
  void at_least(const std::string& text, std::optional<double> value, double limit, const char* unit) {
    add(text, value, unit, value && *value >= limit);
  }
  // The same against rays, with what their tracing alone would give.
  void quicker_than_rays(const std::string& text, const json* result, double limit) {
    const auto whole = result == nullptr ? std::nullopt : ratio(ms_of(*result, "rays"), ms_of(*result, "cpu"));
    if (!whole) return not_here(text, "not measured in this run");
    const json& draw = result->at("sources").at("rays").at("draw_ms");
    const auto traced = draw.is_null() ? std::nullopt : ratio(draw.get<double>(), ms_of(*result, "cpu"));
    add(text, whole, traced ? fmt::format("x ({:.2f}x of tracing alone)", *traced) : "x", *whole >= limit);
  }
  void not_here(const std::string& text, const std::string& why) {
    list_.push_back({{"target", text}, {"measured", why}, {"reached", nullptr}});
  }
  json list() const { return list_; }

 private:
  void add(const std::string& text, std::optional<double> value, const std::string& unit, bool reached) {
    if (!value) return not_here(text, "not measured in this run");
    list_.push_back({{"target", text}, {"measured", fmt::format("{:.2f}{}", *value, unit)}, {"reached", reached}});
  }
  json list_ = json::array();
};

}  // namespace

void print_tables(const measured& all) {
  std::vector<std::string> names;
  for (const json& r : all.results)
    for (const auto& [name, s] : r.at("sources").items())
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  fmt::print(
      "CPU ms of one core per sample; in brackets draw + gather + statistics, where the source can tell.\n\n"
      "| scene | height | pixels seen | polygons seen |");
  for (const std::string& name : names) fmt::print(" {} |", name);
  fmt::print(" gpu / cpu | rays / cpu | cpu / floor |\n|---|---|---|---|");
  for (std::size_t i = 0; i < names.size() + 3; ++i) fmt::print("---|");
  fmt::print("\n");
  for (const json& r : all.results) {
    const json& first = r.at("sources").front();
    fmt::print("| {} | {} | {} | {} |", r.at("scene").get<std::string>(), r.at("height").get<std::string>(),
               grouped(first.at("pixels_seen").get<double>()), grouped(first.at("polygons_seen").get<double>()));
    for (const std::string& name : names)
      fmt::print(" {} |", r.at("sources").contains(name) ? cost_text(r.at("sources").at(name)) : "-");
    const auto cpu = ms_of(r, "cpu");
    fmt::print(" {} | {} | {} |\n", times(ratio(ms_of(r, "gpu"), cpu)), times(ratio(ms_of(r, "rays"), cpu)),
               times(ratio(cpu, ms_of(r, "floor"))));
  }
  print_means(all);
  print_growth(all);
  print_memory(all);
  print_gpu_settings(all);
}

json targets(const measured& all) {
  target_list list;
  const auto ms = [&](const char* scene, const char* height, const char* source) {
    return ms_at(all, scene, height, source);
  };
  const auto small = ms("vienna800k", "street", "cpu"), large = ms("vienna8m", "street", "cpu");
  list.at_most("cpu, 865,979 polygons, street: at most 8 ms (ambition 5)", small, 8.0, " ms");
  list.at_most("cpu, 7,928,519 polygons, street: at most 15 ms (ambition 10)", large, 15.0, " ms");
  const json* street = result_at(all, "vienna800k", "street");
  list.quicker_than_rays("865,979 polygons, street: at least 6x quicker than rays", street, 6.0);
  const bool llvmpipe = street != nullptr && street->at("sources").contains("gpu") &&
                        street->at("sources").at("gpu").at("software").get<bool>();
  list.at_least("865,979 polygons, street: at least 15x quicker than llvmpipe",
                llvmpipe ? ratio(ms("vienna800k", "street", "gpu"), small) : std::nullopt, 15.0, "x");
  list.at_most("cpu, street, from 0.87 to 7.9 M polygons: growth at most 2.5x", ratio(large, small), 2.5, "x");
  list.at_most("7,928,519 polygons, 200 m: cpu no slower than rays",
               ratio(ms("vienna8m", "200", "cpu"), ms("vienna8m", "200", "rays")), 1.0, "x of rays");
  std::vector<double> found;
  for (const char* scene : {"intel_castle", "candela_city", "oacmpctf3", "denhaag_01"}) {
    const auto quicker = ratio(ms(scene, "street", "rays"), ms(scene, "street", "cpu"));
    list.quicker_than_rays(fmt::format("{}, walkable places: at least 3.5x quicker than rays", scene),
                           result_at(all, scene, "street"), 3.5);
    if (quicker) found.push_back(*quicker);
  }
  list.at_least("these four, geometric mean: at least 6x quicker than rays",
                found.size() == 4 ? std::optional(geometric_mean(found)) : std::nullopt, 6.0, "x");
  const bool threads = !all.threads.is_null();
  const auto of_threads = [&](const char* key) { return all.threads.at(key).get<double>(); };
  list.at_most("cpu, hemicubes of one call: CPU seconds with 2 threads at most 1.12x of one",
               threads ? ratio(of_threads("cpu_2"), of_threads("cpu_1")) : std::nullopt, 1.12, "x");
  list.at_least("cpu, hemicubes of one call: at least 95 % of the CPU seconds in parallel sections",
                threads ? std::optional(of_threads("parallel_percent")) : std::nullopt, 95.0, " %");
  list.not_here("cpu against rays: at most 1e-5 of the pixels differ", "bench_agreement measures it");
  list.not_here("gpu (llvmpipe) against rays: at most 1e-4 of the pixels differ", "bench_agreement measures it");
  list.not_here("a hardware GPU: samples per second on the presets", hardware_text(all));
  return list.list();
}

void print_targets(const json& list) {
  fmt::print("\n| target | measured | reached |\n|---|---|---|\n");
  for (const json& t : list)
    fmt::print("| {} | {} | {} |\n", t.at("target").get<std::string>(), t.at("measured").get<std::string>(),
               t.at("reached").is_null()     ? "-"
               : t.at("reached").get<bool>() ? "yes"
                                             : "NO");
}

}  // namespace sightcell::bench
