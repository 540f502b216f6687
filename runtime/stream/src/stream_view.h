#pragma once
// A camera in a streamed scene: the cell that it is in, and the last cell whose files were all there.
#include <cstddef>
#include <cstdint>
#include <span>

#include "streamed_scene.h"

namespace sightcell::streaming {

// A cell of a chunk in memory; the view that refers to it keeps the chunk there.
struct held_cell {
  std::uint32_t chunk = 0;
  const chunk_cell* cell = nullptr;  // null: none

  friend bool operator==(const held_cell&, const held_cell&) = default;
};

}  // namespace sightcell::streaming

// In the global namespace, because the C API declares it.
struct sightcell_stream_view {
 public:
  static sightcell_status create(sightcell_stream& stream, sightcell_stream_view** out) noexcept;
  static void destroy(sightcell_stream_view* view) noexcept;

  void move(const sightcell_stream_pose& pose, sightcell_stream_frame& frame) noexcept;
  // Returns how many it has written.
  std::size_t list_requests(double seconds, std::span<sightcell_stream_request> dst) noexcept;
  // bits: (draws + 63) / 64 words.
  void write_draws(std::uint64_t* bits) const noexcept;

  [[nodiscard]] const sightcell_stream& stream() const noexcept { return stream_; }
  template <class Use>
  void for_each_held(const Use& use) const noexcept {
    if (cell_.cell != nullptr) use(*cell_.cell);
    if (complete_.cell != nullptr && complete_ != cell_) use(*complete_.cell);
  }

  sightcell_stream_view* next = nullptr;  // of all views, for the scene

 private:
  explicit sightcell_stream_view(sightcell_stream& stream) noexcept : stream_(stream) {}
  ~sightcell_stream_view() = default;
  [[nodiscard]] std::uint64_t size() const noexcept;
  void hold(sightcell::streaming::held_cell& place, const sightcell::streaming::held_cell& cell) noexcept;
  // Returns the cell that contains the eye, of the chunks in memory.
  [[nodiscard]] sightcell::streaming::held_cell find_cell(bool& may_be_elsewhere) noexcept;
  [[nodiscard]] sightcell::streaming::held_cell nearest_cell() noexcept;
  void count_files(sightcell_stream_frame& frame) const noexcept;

  sightcell_stream& stream_;
  sightcell_stream_pose pose_{};
  bool has_moved_ = false;
  sightcell::streaming::held_cell cell_, complete_;
  std::uint32_t* listed_at_ = nullptr;  // by file: the last list of requests that had it
  std::uint32_t lists_ = 0;
};
