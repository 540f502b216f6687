#pragma once
// The checkpoint of a bake on the disk where the bake works, and its copy beside the output if that is another disk.
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "checkpoint/checkpoint.h"

namespace sightcell::bake {

class work_file {
 public:
  // Opens or creates the checkpoint, as the constructor of checkpoint does.
  // target: the output of the bake. The checkpoint beside it is target + ".bake".
  // scratch: the folder to work in; empty: beside the target. If the copy beside the target is newer than the file in
  //   scratch, the bake resumes from the copy.
  work_file(const std::filesystem::path& target, const std::filesystem::path& scratch, const std::string& key,
            bool fresh, std::string_view plan = {}, std::string_view cells = {},
            const stale_key_test& take_over_test = {});
  // Returns the cells that an unfinished bake of this target has stored, whatever its key; empty if there are none. To
  // be called before the bake opens its work file, which finds the same checkpoint then. Throws sightcell::error:
  // "checkpoint.in-use", "checkpoint.damaged" and the like.
  static std::string stored_cells(const std::filesystem::path& target, const std::filesystem::path& scratch);

  // Returns the checkpoint in work, and its path.
  checkpoint& records() { return *records_; }
  const std::filesystem::path& path() const { return path_; }

  // With scratch: writes a copy beside the target, from which any machine can resume.
  void copy();
  // As copy(), if the last copy is at least five minutes old.
  void copy_if_due();
  // Deletes the checkpoint and its copy after the end of the bake.
  void remove();

 private:
  using clock = std::chrono::steady_clock;

  std::filesystem::path beside_, path_;
  std::optional<checkpoint> records_;
  clock::time_point copied_ = clock::now();
};

}  // namespace sightcell::bake
