#include "bench/hemicube/scenes.h"

#include <cstdlib>
#include <map>

#include "bench/hemicube/child.h"

namespace sightcell::bench {
namespace {

// What sightcell-city is asked for, seed 1.
const std::map<std::string, std::vector<std::string>>& towns() {
  static const std::map<std::string, std::vector<std::string>> all{
      {"vienna800k", {"--preset", "vienna800k"}},
      {"vienna8m", {"--preset", "vienna8m"}},
      {"hongkong", {"--preset", "hongkong"}},
      {"city100k", {"--polygons", "100000"}},
      {small_town, {"--polygons", "20000"}},
  };
  return all;
}

const std::map<std::string, std::string>& real_scenes() {
  static const std::map<std::string, std::string> all{
      {"intel_castle", "city/intel_castle.glb"}, {"candela_city", "city/candela_city.glb"},
      {"denhaag_01", "city/denhaag_01.glb"},     {"accident", "levels/accident.glb"},
      {"czest3ctf", "levels/czest3ctf.glb"},     {"oacmpctf3", "levels/oacmpctf3.glb"},
  };
  return all;
}

bench_scene make_town(const std::string& name, const std::vector<std::string>& asked) {
  const auto generator = own_program().parent_path() / "sightcell-city";
  const auto stem = cache_folder() / (name + "-1-" + hash_of_file(generator).substr(0, 16));
  bench_scene town{name, stem.string() + ".glb", stem.string() + ".cells.json", ""};
  if (!std::filesystem::exists(town.file) || !std::filesystem::exists(town.cells)) {
    say("making " + name);
    const std::string part = stem.string() + ".part.glb";
    auto words = asked;
    words.insert(words.end(), {"--seed", "1", "--out", part, "--cells", town.cells.string()});
    run_program(generator, words);
    std::filesystem::rename(part, town.file);
  }
  return town;
}

}  // namespace

const std::vector<std::string>& scene_names() {
  static const std::vector<std::string> all{"vienna800k", "vienna8m", "hongkong",  "intel_castle", "candela_city",
                                            "denhaag_01", "accident", "czest3ctf", "oacmpctf3"};
  return all;
}

std::optional<bench_scene> find_scene(const std::string& name) {
  bench_scene found{name, name, {}, ""};
  if (const auto town = towns().find(name); town != towns().end()) {
    if (!std::filesystem::exists(own_program().parent_path() / "sightcell-city")) {
      say(name + " is skipped: sightcell-city is not beside this program; build it");
      return std::nullopt;
    }
    found = make_town(name, town->second);
  } else if (const auto real = real_scenes().find(name); real != real_scenes().end()) {
    const char* data = std::getenv("SIGHTCELL_DATA");
    if (data != nullptr) found.file = std::filesystem::path(data) / real->second;
    if (data == nullptr || !std::filesystem::exists(found.file)) {
      say(name +
          " is skipped: " + (data == nullptr ? "SIGHTCELL_DATA is not set" : found.file.string() + " is missing"));
      return std::nullopt;
    }
  } else if (std::filesystem::is_regular_file(name)) {
    found.name = found.file.stem().string();
  } else {
    say(name + " is skipped: it is neither a scene that is known by name nor a file");
    return std::nullopt;
  }
  found.hash = hash_of_file(found.file);
  if (!found.cells.empty()) found.hash = hash_of_text(found.hash + hash_of_file(found.cells));
  return found;
}

}  // namespace sightcell::bench
