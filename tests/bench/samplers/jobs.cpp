#include "bench/samplers/jobs.h"

#include <algorithm>
#include <variant>

#include "sightcell/bake/sampler_options.h"
#include "sightcell/base/error.h"

namespace sightcell::bench {
namespace {

[[noreturn]] void refuse(const std::string& subject, const std::string& cause, const std::string& remedy) {
  throw error(error_kind::wrong_use, "bench.jobs", subject, cause, remedy);
}

std::string key_of(const bake::sampler_option& option) {
  std::string key = option.name + 2;  // without its dashes
  std::replace(key.begin(), key.end(), '-', '_');
  return key;
}

// The option of this name that the sampler has.
const bake::sampler_option* find_option(std::string key, const std::string& sampler) {
  std::replace(key.begin(), key.end(), '-', '_');
  for (const bake::sampler_option& option : bake::sampler_options())
    if (key_of(option) == key && option.of(sampler)) return &option;
  return nullptr;
}

// True where the key is one of those that every sampler has.
bool take_common(const std::string& key, const json& value, bake::settings& how) {
  if (key == "sampler")
    how.sampler = value.get<std::string>();
  else if (key == "resolution")
    how.resolution = value.get<std::uint32_t>();
  else if (key == "seed")
    how.seed = value.get<std::uint64_t>();
  else if (key == "source")
    how.source = value.get<std::string>();
  else if (key == "max_pixel_error")
    how.max_pixel_error = value.get<double>();
  else if (key == "margin")
    how.margin = value.get<float>();
  else if (key == "player_radius")
    how.player_radius = value.get<float>();
  else if (key == "smallest_gap")
    how.smallest_gap = value.get<float>();
  else
    return false;
  return true;
}

json text_of(const bake::settings& how) {
  json text{{"sampler", how.sampler}};
  for (const bake::sampler_option& option : bake::sampler_options())
    if (option.of(how.sampler)) std::visit([&](auto member) { text[key_of(option)] = how.*member; }, option.value);
  text["resolution"] = how.resolution;
  text["seed"] = how.seed;
  text["source"] = how.source;
  text["margin"] = how.margin;
  text["player_radius"] = how.player_radius;
  text["smallest_gap"] = how.smallest_gap;
  if (how.max_pixel_error > 0.0) text["max_pixel_error"] = how.max_pixel_error;
  return text;
}

job read_job(const json& one, const std::string& subject) {
  job made{one.at("label").get<std::string>(), one.value("code", ""),        {}, {},
           one.value("of_all", false),         one.value("importance", true)};
  const std::string where = subject + ", job \"" + made.label + "\"";
  made.how.source = "cpu";
  made.how.max_pixel_error = 0.0;
  const json& given = one.at("settings");
  if (const auto sampler = given.find("sampler"); sampler != given.end())
    made.how.sampler = sampler->get<std::string>();
  for (const auto& [key, value] : given.items()) {
    if (take_common(key, value, made.how)) continue;
    const bake::sampler_option* option = find_option(key, made.how.sampler);
    if (option == nullptr)
      refuse(where, "\"" + key + "\" is no setting of " + made.how.sampler, "see sightcell samplers");
    const json& told = value;
    std::visit([&](auto member) { made.how.*member = told.get<std::decay_t<decltype(made.how.*member)>>(); },
               option->value);
  }
  bake::validate(made.how);
  made.settings = text_of(made.how);
  if (!made.importance) made.settings["importance"] = false;
  made.of_all = made.of_all || made.how.sampler == "agvs";
  return made;
}

}  // namespace

job_list parse_jobs(const json& text, const std::string& subject) {
  job_list list;
  try {
    for (const json& one : text.at("jobs")) list.jobs.push_back(read_job(one, subject));
    if (const auto truth = text.find("truth"); truth != text.end()) {
      list.truth.interval = truth->value("interval", list.truth.interval);
      // 4e7 is no integer to JSON.
      list.truth.first_rays = static_cast<std::uint64_t>(truth->value("first_rays", 1e6));
      list.truth.max_rays = static_cast<std::uint64_t>(truth->value("max_rays", 4e7));
    }
  } catch (const nlohmann::json::exception& e) {
    refuse(subject, e.what(), R"(write {"jobs":[{"label":"","code":"","settings":{}}]})");
  }
  if (list.jobs.empty()) refuse(subject, "has no job", "write one");
  for (const job& one : list.jobs)
    if (one.rules() != list.jobs.front().rules())
      refuse(subject + ", job \"" + one.label + "\"",
             "differs from the first job in margin, player_radius or smallest_gap", "measure it in a run of its own");
  if (!(list.truth.interval > 0.0) || list.truth.first_rays == 0 || list.truth.max_rays > 2'000'000'000)
    refuse(subject, "asks for a truth that cannot be", "interval above 0, 1 to 2e9 rays");
  list.truth.max_rays = std::max(list.truth.max_rays, list.truth.first_rays);
  return list;
}

job_list read_jobs(const std::filesystem::path& path) {
  const auto text = read_json(path);
  if (!text) refuse(path.string(), "is not there or no JSON", "name a file of jobs");
  return parse_jobs(*text, path.string());
}

}  // namespace sightcell::bench
