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

void print_threads(const measured& all) {
  if (all.threads.is_null()) return;
  const auto of = [&](const char* key) { return all.threads.at(key).get<double>(); };
  fmt::print(
      "\ncpu, hemicubes of one call: {:.2f} times the CPU seconds with two threads, {:.2f} % of them in parallel "
      "sections.\n",
      of("cpu_2") / of("cpu_1"), of("parallel_percent"));
}

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
  print_threads(all);
}

}  // namespace sightcell::bench
