#include "checkpoint/work_file.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <optional>
#include <system_error>

#include "sightcell/base/disk.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

constexpr std::chrono::minutes copy_interval{5};

std::filesystem::path with_suffix(std::filesystem::path path, const char* suffix) {
  path += suffix;
  return path;
}

// The name has a hash of the whole path, because bakes of different folders may share one scratch folder.
std::filesystem::path in_scratch(const std::filesystem::path& scratch, const std::filesystem::path& beside) {
  const std::string whole = std::filesystem::absolute(beside).lexically_normal().string();
  return scratch / fmt::format("{:016x}-{}", XXH3_64bits(whole.data(), whole.size()), beside.filename().string());
}

// Returns the time of the last write to a checkpoint. Before the checkpoint is opened again, its newest records may be
// in the log alone.
std::optional<std::filesystem::file_time_type> last_written(const std::filesystem::path& bake) {
  std::optional<std::filesystem::file_time_type> last;
  for (const char* part : {"", "-journal", "-wal"}) {
    std::error_code none;
    const auto written = std::filesystem::last_write_time(with_suffix(bake, part), none);
    if (!none && (!last || written > *last)) last = written;
  }
  return last;
}

// Returns whether the copy is newer than the local file, because another machine continued the bake. To be called
// before the local file is opened: opening moves its log into it, after which it appears new.
bool is_newer(const std::filesystem::path& copy, const std::filesystem::path& here) {
  const auto copied = last_written(copy), worked = last_written(here);
  return copied && (!worked || *worked < *copied);
}

void take_over(const std::filesystem::path& copy, const std::filesystem::path& here) {
  const std::filesystem::path partial = with_suffix(here, ".partial");
  try {
    std::filesystem::copy_file(copy, partial, std::filesystem::copy_options::overwrite_existing);
    // SQLite must not apply a log of the older file to the newer one.
    for (const char* log : {"-journal", "-wal", "-shm"}) std::filesystem::remove(with_suffix(here, log));
    publish(partial, here);
  } catch (const std::filesystem::filesystem_error& e) {
    throw error(error_kind::failed, "checkpoint.not-writable", here.string(),
                "cannot be created or written: " + e.code().message(), "choose a --scratch that exists and has room");
  }
}

}  // namespace

work_file::work_file(const std::filesystem::path& target, const std::filesystem::path& scratch, const std::string& key,
                     bool fresh, std::string_view plan, std::string_view cells, const stale_key_test& take_over_test)
    : beside_(with_suffix(target, ".bake")), path_(scratch.empty() ? beside_ : in_scratch(scratch, beside_)) {
  if (!scratch.empty() && !fresh) {
    // Opening the file in scratch fails if another bake uses it. Its file must not be replaced meanwhile.
    std::error_code ignored;
    const bool copy_is_newer = is_newer(beside_, path_);
    if (std::filesystem::exists(path_, ignored)) checkpoint(path_, key, false, plan, cells, take_over_test);
    if (copy_is_newer) take_over(beside_, path_);
  }
  records_.emplace(path_, key, fresh, plan, cells, take_over_test);
  if (!scratch.empty() && fresh) {
    std::error_code ignored;
    std::filesystem::remove(beside_, ignored);
  }
}

std::string work_file::stored_cells(const std::filesystem::path& target, const std::filesystem::path& scratch) {
  const std::filesystem::path beside = with_suffix(target, ".bake");
  if (scratch.empty()) return checkpoint::cells_in(beside);
  const std::filesystem::path here = in_scratch(scratch, beside);
  if (!is_newer(beside, here)) return checkpoint::cells_in(here);
  // Read without a lock, because a lock would change the times by which the constructor finds the newer file. A file
  // that cannot be read so is opened by the constructor, which reports why.
  try {
    return checkpoint::open_to_read(beside).cells();
  } catch (const error&) {
    return {};
  }
}

void work_file::copy() {
  if (path_ == beside_) return;
  records_->copy_to(beside_);
  copied_ = clock::now();
}

void work_file::copy_if_due() {
  if (path_ != beside_ && clock::now() - copied_ >= copy_interval) copy();
}

void work_file::remove() {
  records_->remove();
  std::error_code ignored;
  if (path_ != beside_) std::filesystem::remove(beside_, ignored);
  std::filesystem::remove(with_suffix(beside_, ".partial"), ignored);  // left by a copy that was killed
}

}  // namespace sightcell::bake
