#pragma once
// The front of a streamed scene, checked and decoded (docs/streaming.md, "Front"). Does not change after open.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "cell_box.h"
#include "inflated.h"
#include "memory.h"
#include "sightcell/stream.h"

namespace sightcell::streaming {

struct listed_file {
  std::uint32_t size = 0;
  content_hash hash{};
};

struct listed_image_file {
  std::uint32_t image = 0, width = 0, height = 0;
  std::uint8_t type = 0;
};

struct listed_chunk {
  std::uint32_t first_cell = 0, cells = 0;
  runtime::wide_box box;
};

struct front_counts {
  std::uint32_t polygons = 0, geometries = 0, draws = 0, pages = 0, images = 0, image_files = 0, chunks = 0, cells = 0,
                json = 0;
};

class front {
 public:
  explicit front(const sightcell_allocator& mem) noexcept : mem_(mem) {}
  ~front() { runtime::release(mem_, block_, block_size_); }
  front(const front&) = delete;
  front& operator=(const front&) = delete;

  // Fails with MEMORY, NOT_OURS, VERSION, TRUNCATED, CORRUPT.
  [[nodiscard]] sightcell_status read(std::span<const std::uint8_t> file) noexcept;

  [[nodiscard]] const front_counts& counts() const noexcept { return counts_; }
  [[nodiscard]] std::span<const std::uint8_t, 16> fingerprint() const noexcept { return fingerprint_; }
  [[nodiscard]] const std::array<float, 6>& box() const noexcept { return box_; }  // min, max
  [[nodiscard]] std::span<const std::uint8_t> json() const noexcept { return {json_, counts_.json}; }
  [[nodiscard]] std::span<const std::uint32_t> geometries() const noexcept { return {geometries_, counts_.geometries}; }
  [[nodiscard]] std::span<const sightcell_stream_draw> draws() const noexcept { return {draws_, counts_.draws}; }
  [[nodiscard]] std::span<const listed_chunk> chunks() const noexcept { return {chunks_, counts_.chunks}; }
  // Chunks, pages, image files: the numbers of the C interface.
  [[nodiscard]] std::span<const listed_file> files() const noexcept { return {files_, file_count()}; }
  [[nodiscard]] std::uint32_t file_count() const noexcept {
    return counts_.chunks + counts_.pages + counts_.image_files;
  }
  [[nodiscard]] std::uint32_t file_of_page(std::uint32_t page) const noexcept { return counts_.chunks + page; }
  [[nodiscard]] std::uint32_t first_image_file() const noexcept { return counts_.chunks + counts_.pages; }
  [[nodiscard]] const listed_image_file& image_file(std::uint32_t file) const noexcept {
    return image_files_[file - first_image_file()];
  }
  // The files of an image are files_begin(image) .. files_begin(image + 1) - 1.
  [[nodiscard]] std::uint32_t files_begin(std::uint32_t image) const noexcept {
    return first_image_file() + image_begins_[image];
  }
  [[nodiscard]] runtime::wide_box box_of_page(std::uint32_t page) const noexcept;
  [[nodiscard]] std::span<const std::uint32_t> pages_everywhere() const noexcept {
    return {pages_everywhere_, page_everywhere_count_};
  }
  [[nodiscard]] std::span<const std::uint32_t> images_everywhere() const noexcept {
    return {images_everywhere_, image_everywhere_count_};
  }

 private:
  [[nodiscard]] std::uint64_t carve(void* block) noexcept;
  void fill(class payload_reader& in) noexcept;
  void fill_draws(payload_reader& in) noexcept;
  void fill_pages(payload_reader& in) noexcept;
  void fill_images(payload_reader& in) noexcept;
  void fill_chunks(payload_reader& in) noexcept;
  void fill_everywhere(payload_reader& in) noexcept;
  void fill_hashes(payload_reader& in, std::uint32_t first, std::uint32_t count) noexcept;

  const sightcell_allocator& mem_;
  void* block_ = nullptr;
  std::uint64_t block_size_ = 0;
  front_counts counts_;
  std::array<std::uint8_t, 16> fingerprint_{};
  std::array<float, 6> box_{};
  std::uint8_t* json_ = nullptr;
  std::uint32_t* geometries_ = nullptr;
  sightcell_stream_draw* draws_ = nullptr;
  listed_chunk* chunks_ = nullptr;
  listed_file* files_ = nullptr;
  listed_image_file* image_files_ = nullptr;
  std::uint32_t* image_begins_ = nullptr;
  std::array<std::uint8_t, 6>* page_boxes_ = nullptr;  // in steps of 1/255 of the box: min, max
  std::uint32_t* pages_everywhere_ = nullptr;
  std::uint32_t* images_everywhere_ = nullptr;
  std::uint32_t page_everywhere_count_ = 0, image_everywhere_count_ = 0;
};

}  // namespace sightcell::streaming
