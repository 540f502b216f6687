#include "bench/samplers/kept_files.h"

#include <unistd.h>

#include <fstream>
#include <iterator>
#include <utility>

#include "bench/hemicube/cache.h"
#include "sightcell/base/error.h"

namespace sightcell::bench {
namespace {

constexpr std::size_t checksum_length = 32;  // characters of hash_of_text

}  // namespace

kept_files::kept_files(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::filesystem::create_directories(folder_);
}

std::filesystem::path kept_files::path_of(const std::string& key, const char* kind) const {
  return folder_ / key.substr(0, 2) / (key + "." + kind);
}

std::optional<std::string> kept_files::read(const std::string& key, const char* kind) const {
  std::ifstream in(path_of(key, kind), std::ios::binary);
  if (!in) return std::nullopt;
  std::string bytes(std::istreambuf_iterator<char>(in), {});
  if (bytes.size() < checksum_length) return std::nullopt;
  const std::string checksum = bytes.substr(bytes.size() - checksum_length);
  bytes.resize(bytes.size() - checksum_length);
  if (hash_of_text(key + bytes) != checksum) return std::nullopt;
  return bytes;
}

void kept_files::write(const std::string& key, const char* kind, const std::string& bytes) const {
  const auto path = path_of(key, kind);
  std::filesystem::create_directories(path.parent_path());
  const std::filesystem::path part = path.string() + "." + std::to_string(getpid()) + ".part";
  std::ofstream out(part, std::ios::binary);
  out << bytes << hash_of_text(key + bytes);
  out.close();
  if (!out)
    throw error(error_kind::failed, "bench.file", part.string(), "cannot be written", "make room or name another path");
  std::filesystem::rename(part, path);
}

}  // namespace sightcell::bench
