#pragma once
// The files that a view needs next (docs/streaming.md, "What a client does"). While the view holds the latch of its
// scene.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "streamed_scene.h"

namespace sightcell::streaming {

// Returns the chunk whose box is nearest, or the number of chunks if there is none. Chunks that have FAILED do not
// count.
[[nodiscard]] std::uint32_t nearest_chunk(const sightcell_stream& stream, const runtime::point& eye) noexcept;

// The part of space that a view shows.
class view_region {
 public:
  explicit view_region(const sightcell_stream_pose& pose) noexcept;
  // False if a plane of the frustum has the whole box behind it.
  [[nodiscard]] bool may_show(const runtime::wide_box& box) const noexcept;
  // Returns how much of these sectors of headings is in the view, 0 to 64. headings: those of listed_page.
  [[nodiscard]] std::uint32_t share_of(std::uint8_t headings) const noexcept;

 private:
  static constexpr std::uint8_t whole = 8;

  void look_around(const runtime::point& forward) noexcept;

  runtime::point eye_{};
  std::array<runtime::point, 5> planes_{};  // normals, inward
  bool has_direction_ = false;
  std::array<std::uint8_t, 8> sectors_{};  // how much of each is in the view, in eighths
};

class request_list {
 public:
  // listed_at: by file; a file with the number of this list is in it.
  request_list(sightcell_stream& stream, const sightcell_stream_pose& pose, std::span<std::uint32_t> listed_at,
               std::uint32_t number, std::span<sightcell_stream_request> dst) noexcept;

  // Chunks whose box contains the eye; is_lost: also the nearest one.
  void add_lookup(bool is_lost) noexcept;
  void add_everywhere() noexcept;
  void add_cell(const chunk_cell& cell) noexcept;
  void add_next(double seconds) noexcept;
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  void begin_part(std::uint32_t reason) noexcept;
  void end_part() noexcept;
  void add(std::uint32_t file, float weight, std::uint32_t ahead) noexcept;
  void add_pages(const chunk_cell& cell) noexcept;
  void add_first_image(std::uint32_t image, float weight) noexcept;
  void add_larger_image(std::uint32_t image, float weight) noexcept;
  [[nodiscard]] double priority_of(const sightcell_stream_request& request) const noexcept;
  [[nodiscard]] bool is_before(const sightcell_stream_request& a, const sightcell_stream_request& b) const noexcept;

  sightcell_stream& stream_;
  const sightcell_stream_pose& pose_;
  const view_region region_;
  std::span<std::uint32_t> listed_at_;
  std::uint32_t number_;
  std::span<sightcell_stream_request> dst_;
  std::size_t part_begin_ = 0;  // requests before this one are in order
  std::size_t size_ = 0;
  std::uint32_t reason_ = 0;
};

}  // namespace sightcell::streaming
