#pragma once
// An unfinished bake on the disk where it is worked on, and its copy beside the output where that is another disk.
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "checkpoint/checkpoint.h"

namespace sightcell::bake {

class work_file {
 public:
  // target: what the bake writes in the end; the unfinished bake is target + ".bake". With scratch it is worked on in
  // that folder, from the copy beside the target where that is newer than what scratch has. The rest as checkpoint.
  work_file(const std::filesystem::path& target, const std::filesystem::path& scratch, const std::string& key,
            bool fresh, std::string_view plan = {}, const stale_key_test& judge = {});

  checkpoint& records() { return *records_; }
  const std::filesystem::path& path() const { return path_; }

  // With scratch: leaves a copy beside the target, so that any machine can go on from there.
  void copy();
  // The same, when the last one is some minutes old.
  void copy_if_due();
  // The bake is done: nothing of it is left.
  void remove();

 private:
  using clock = std::chrono::steady_clock;

  std::filesystem::path beside_, path_;
  std::optional<checkpoint> records_;
  clock::time_point copied_ = clock::now();
};

}  // namespace sightcell::bake
