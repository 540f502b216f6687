#pragma once
// What the benchmark of hemicubes keeps between runs, by what it is made of: towns, poses, results.
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace sightcell::bench {

using json = nlohmann::ordered_json;

// $SIGHTCELL_CACHE/bench_hemicube, by default build/cache/bench_hemicube; made when it is not there.
std::filesystem::path cache_folder();

std::string hash_of_text(const std::string& text);
// Throws sightcell::error where the file cannot be read.
std::string hash_of_file(const std::filesystem::path& path);

std::optional<json> read_json(const std::filesystem::path& path);
// Under another name first, so that a file that is there is whole.
void write_json(const std::filesystem::path& path, const json& value);

// One line on standard error.
void say(const std::string& line);

}  // namespace sightcell::bench
