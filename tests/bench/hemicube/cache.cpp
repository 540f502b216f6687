#include "bench/hemicube/cache.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <vector>

#include "bench/hemicube/child.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"

namespace sightcell::bench {
namespace {

std::string text_of(const XXH128_hash_t& hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

std::filesystem::path cache_folder() {
  const char* given = std::getenv("SIGHTCELL_CACHE");
  const auto folder = std::filesystem::absolute(given != nullptr ? given : "build/cache") / "bench_hemicube";
  std::filesystem::create_directories(folder);
  return folder;
}

std::string hash_of_text(const std::string& text) {
  return text_of(XXH3_128bits(text.data(), text.size()));
}

std::string hash_of_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw error(error_kind::bad_input, "bench.file", path.string(), "cannot be read", "name a file that is there");
  XXH3_state_t* state = XXH3_createState();
  XXH3_128bits_reset(state);
  std::vector<char> block(1u << 22);
  while (in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    XXH3_128bits_update(state, block.data(), static_cast<std::size_t>(in.gcount()));
  }
  const XXH128_hash_t hash = XXH3_128bits_digest(state);
  XXH3_freeState(state);
  return text_of(hash);
}

std::optional<json> read_json(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) return std::nullopt;
  json value = scene::parse_json(std::string(std::istreambuf_iterator<char>(in), {}), false);
  if (value.is_discarded()) return std::nullopt;
  return value;
}

void write_json(const std::filesystem::path& path, const json& value) {
  const std::filesystem::path part = path.string() + ".part";
  std::ofstream out(part);
  out << value.dump(1) << '\n';
  out.close();
  if (!out)
    throw error(error_kind::failed, "bench.file", part.string(), "cannot be written", "make room or name another path");
  std::filesystem::rename(part, path);
}

void say(const std::string& line) {
  std::cerr << own_program().filename().string() + ": " + line + "\n";
}

}  // namespace sightcell::bench
