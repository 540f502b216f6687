#pragma once
// What is in memory, and what is removed where it is short.
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "doorbell.h"
#include "owners.h"

namespace stream_client {

// Bytes are those on the device. A file that is being loaded counts with an estimate.
class resident_files {
 public:
  // limit: bytes.
  // stream: must outlive this.
  // remove: called for each file that is removed.
  resident_files(sightcell_stream* stream, std::uint64_t limit, std::function<void(std::uint32_t file)> remove)
      : stream_(stream), limit_(limit), remove_(std::move(remove)) {}

  // A file is being loaded; replaces what was known of it.
  void expect(std::uint32_t file, std::uint64_t bytes);

  // A file is there.
  void add(std::uint32_t file, std::uint64_t bytes);

  // A file is not loaded after all.
  void forget(std::uint32_t file);

  // Removes files that no view needs, those first that were needed least recently, until `bytes` more fit.
  // older: files that have been there for less are kept: what was loaded ahead would else be removed for what is loaded
  //   ahead.
  // Returns whether they fit.
  bool make_room(std::uint64_t bytes, std::chrono::seconds older);

  std::uint64_t peak() const { return peak_; }
  std::uint64_t removed() const { return removed_; }

 private:
  struct entry {
    std::uint64_t bytes = 0;
    clock::time_point since{};
  };
  void set(std::uint32_t file, std::uint64_t bytes);

  sightcell_stream* stream_;
  std::uint64_t limit_;
  std::function<void(std::uint32_t)> remove_;
  std::unordered_map<std::uint32_t, entry> files_;
  std::vector<std::uint32_t> removable_;
  std::uint64_t bytes_ = 0, peak_ = 0, removed_ = 0;
};

}  // namespace stream_client
