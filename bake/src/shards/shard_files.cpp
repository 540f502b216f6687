#include "shards/shard_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

// Limit on the cells of a plan.
constexpr std::uint32_t cell_limit = 1u << 24;

void check_key(const checkpoint& file, const std::filesystem::path& path, const std::string& key) {
  if (file.key() == key) return;
  const std::string names = differing_names(file.key(), key);
  throw error(error_kind::wrong_use, "shard.other-bake", path.string(),
              fmt::format("is of another bake: it differs in {}",
                          names.empty() ? std::string("scene, settings or version") : names),
              "bake that shard again with the same command as the others, or delete it");
}

}  // namespace

shard_files::shard_files(std::span<const std::filesystem::path> files, const std::optional<std::string>& key) {
  for (const std::filesystem::path& path : files) {
    files_.push_back(checkpoint::open_to_read(path));
    paths_.push_back(path);
    check_key(files_.back(), path, key ? *key : files_.front().key());
    const auto number = static_cast<std::uint32_t>(files_.size());
    files_.back().list([&](std::uint32_t cell, cell_stage stage) {
      if (cell >= cell_limit)
        throw error(error_kind::bad_input, "shard.damaged", path.string(), "is damaged", "bake that shard again");
      std::uint32_t& file = entry(cell, stage);
      if (file == 0) file = number;
    });
  }
}

std::uint32_t& shard_files::entry(std::uint32_t cell, cell_stage stage) {
  std::vector<std::uint32_t>& entries = entries_[static_cast<std::size_t>(stage)];
  if (entries.size() <= cell) entries.resize(std::size_t{cell} + 1);
  return entries[cell];
}

bake_plan shard_files::plan() const {
  return decode_plan(files_.front().plan(), paths_.front().string());
}

std::optional<std::size_t> shard_files::file_with(std::uint32_t cell, cell_stage stage) const {
  const std::vector<std::uint32_t>& entries = entries_[static_cast<std::size_t>(stage)];
  if (cell >= entries.size() || entries[cell] == 0) return std::nullopt;
  return entries[cell] - 1;
}

cell_record shard_files::load_from(std::size_t file, std::uint32_t cell, cell_stage stage) const {
  try {
    if (std::optional<cell_record> record = files_[file].load(cell, stage)) return std::move(*record);
  } catch (const error& e) {
    if (e.id() != "checkpoint.damaged") throw;
  }
  throw error(error_kind::bad_input, "shard.damaged", paths_[file].string(),
              fmt::format("the record of cell {} is damaged", cell), "delete it and bake that shard again");
}

cell_record shard_files::load(std::uint32_t cell, cell_stage stage) const {
  const std::optional<std::size_t> file = file_with(cell, stage);
  if (!file)
    throw error(error_kind::failed, "shard.missing-blocks", fmt::format("cell {}", cell), "is in no shard",
                "bake the missing shards");
  return load_from(*file, cell, stage);
}

void shard_files::for_each_double(
    const std::function<void(std::uint32_t cell, std::size_t, std::size_t)>& visit) const {
  for (std::size_t file = 1; file < files_.size(); ++file) {
    std::vector<std::uint32_t> cells;  // copied, because visit reads the file that is being listed
    files_[file].list([&](std::uint32_t cell, cell_stage stage) {
      if (stage == cell_stage::finished && *file_with(cell, stage) != file) cells.push_back(cell);
    });
    for (const std::uint32_t cell : cells) visit(cell, *file_with(cell, cell_stage::finished), file);
  }
}

void refuse_missing(const std::vector<std::string>& blocks, const std::filesystem::path& output,
                    const std::string& cause, const std::string& remedy) {
  constexpr std::size_t shown = 8;
  std::string names;
  for (std::size_t i = 0; i < std::min(blocks.size(), shown); ++i) names += (i == 0 ? "" : ", ") + blocks[i];
  if (blocks.size() > shown) names += fmt::format(" and {} more", blocks.size() - shown);
  throw error(error_kind::failed, "shard.missing-blocks", output.string(), cause + ": " + names, remedy);
}

}  // namespace sightcell::bake
