#include "resident_files.h"

#include <algorithm>
#include <string>

#include "sightcell/base/error.h"

namespace stream_client {

void require(sightcell_status status, const char* call) {
  if (status == SIGHTCELL_OK) return;
  throw sightcell::error(sightcell::error_kind::failed, "client.stream", call, sightcell_status_text(status),
                         "report this");
}

void resident_files::set(std::uint32_t file, std::uint64_t bytes) {
  entry& e = files_[file];
  bytes_ = bytes_ - e.bytes + bytes;
  e = {bytes, clock::now()};
  peak_ = std::max(peak_, bytes_);
}

void resident_files::expect(std::uint32_t file, std::uint64_t bytes) {
  set(file, bytes);
}

void resident_files::add(std::uint32_t file, std::uint64_t bytes) {
  set(file, bytes);
}

void resident_files::forget(std::uint32_t file) {
  const auto found = files_.find(file);
  if (found == files_.end()) return;
  bytes_ -= found->second.bytes;
  files_.erase(found);
}

bool resident_files::make_room(std::uint64_t bytes, std::chrono::seconds older) {
  constexpr std::size_t batch = 256;
  if (bytes_ + bytes <= limit_) return true;
  removable_.resize(batch);
  std::size_t count = 0;
  require(sightcell_stream_removable(stream_, removable_.data(), removable_.size(), &count),
          "sightcell_stream_removable");
  const clock::time_point now = clock::now();
  for (std::size_t i = 0; i < count && bytes_ + bytes > limit_; ++i) {
    const auto found = files_.find(removable_[i]);
    if (found != files_.end() && now - found->second.since < older) continue;
    require(sightcell_stream_set_state(stream_, removable_[i], SIGHTCELL_STREAM_ABSENT), "sightcell_stream_set_state");
    forget(removable_[i]);
    remove_(removable_[i]);
    ++removed_;
  }
  return bytes_ + bytes <= limit_;
}

}  // namespace stream_client
