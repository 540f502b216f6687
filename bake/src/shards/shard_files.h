#pragma once
// Reads the files of several shards like one.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "checkpoint/checkpoint.h"
#include "shards/bake_plan.h"

namespace sightcell::bake {

// The records of several shards. The files stay open.
class shard_files {
 public:
  // key: of the bake; without one, the key of the first file. Throws sightcell::error "shard.other-bake" if a file is
  // of another bake.
  shard_files(std::span<const std::filesystem::path> files, const std::optional<std::string>& key);

  std::size_t count() const { return files_.size(); }
  const std::filesystem::path& path_of(std::size_t file) const { return paths_[file]; }
  bake_plan plan() const;  // of the first file

  // Returns the index of the file with the record; nothing if it is in no file.
  std::optional<std::size_t> file_with(std::uint32_t cell, cell_stage stage) const;
  // Returns the record. May be called from any thread. Throws sightcell::error if it is in no file.
  cell_record load(std::uint32_t cell, cell_stage stage) const;
  // Calls visit for each finished cell that is in two files.
  void for_each_double(const std::function<void(std::uint32_t cell, std::size_t, std::size_t)>& visit) const;
  // Returns the record in one file. Throws sightcell::error if it is damaged.
  cell_record load_from(std::size_t file, std::uint32_t cell, cell_stage stage) const;

 private:
  // Returns the entry of a cell: 1 + the index of the first file that has its record; 0: none.
  std::uint32_t& entry(std::uint32_t cell, cell_stage stage);

  std::vector<std::filesystem::path> paths_;
  std::vector<checkpoint> files_;
  std::vector<std::uint32_t> entries_[3];
};

// Throws an error with the names of blocks whose records are missing: "block 3,-1 (...), block 4,-1 (...) and 12
// more".
[[noreturn]] void refuse_missing(const std::vector<std::string>& blocks, const std::filesystem::path& output,
                                 const std::string& cause, const std::string& remedy);

}  // namespace sightcell::bake
