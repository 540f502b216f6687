#include "front.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "payload_reader.h"

namespace sightcell::streaming {
namespace {

constexpr std::size_t head_size = 16;
constexpr std::array<std::uint8_t, 8> magic = {'S', 'I', 'G', 'H', 'T', 'F', 'R', 'T'};
constexpr std::uint32_t version = 1;
constexpr std::uint32_t no_limit = 0xFFFFFFFFu;
constexpr std::uint8_t image_types = 5;

// The least bytes of one element over all columns of its table: a front with larger counts is damaged.
constexpr std::uint32_t geometry_bytes = 1, draw_bytes = 9 + 48, page_bytes = 1 + 8 + 6, image_bytes = 1,
                        image_file_bytes = 3 + 1 + 8, chunk_bytes = 2 + 8 + 24;

}  // namespace

sightcell_status front::read(std::span<const std::uint8_t> file) noexcept {
  if (file.size() < magic.size() || !std::equal(magic.begin(), magic.end(), file.begin()))
    return SIGHTCELL_ERR_NOT_OURS;
  if (file.size() < head_size) return SIGHTCELL_ERR_TRUNCATED;
  if (u32_at(file, magic.size()) != version) return SIGHTCELL_ERR_VERSION;
  inflated payload(mem_);
  const sightcell_status status = payload.read(file.subspan(head_size), u32_at(file, magic.size() + 4));
  if (status != SIGHTCELL_OK) return status;

  payload_reader in(payload.bytes());
  const std::span<const std::uint8_t> fingerprint = in.bytes(fingerprint_.size());
  std::copy(fingerprint.begin(), fingerprint.end(), fingerprint_.begin());
  counts_.polygons = in.varint();
  counts_.geometries = in.count_of(in.varint(), geometry_bytes);
  counts_.draws = in.count_of(in.varint(), draw_bytes);
  counts_.pages = in.count_of(in.varint(), page_bytes);
  counts_.images = in.count_of(in.varint(), image_bytes);
  counts_.image_files = in.count_of(in.varint(), image_file_bytes);
  counts_.chunks = in.count_of(in.varint(), chunk_bytes);
  counts_.cells = in.varint();
  counts_.json = in.count_of(in.varint(), 1);
  if (!in.ok()) return SIGHTCELL_ERR_CORRUPT;
  block_size_ = carve(nullptr);
  block_ = runtime::allocate(mem_, block_size_);
  if (block_ == nullptr) return SIGHTCELL_ERR_MEMORY;
  (void)carve(block_);
  fill(in);
  return in.is_finished() ? SIGHTCELL_OK : SIGHTCELL_ERR_CORRUPT;
}

std::uint64_t front::carve(void* block) noexcept {
  runtime::carver from(block);
  chunks_ = from.take<listed_chunk>(counts_.chunks);
  draws_ = from.take<sightcell_stream_draw>(counts_.draws);
  geometries_ = from.take<std::uint32_t>(counts_.geometries);
  files_ = from.take<listed_file>(file_count());
  image_files_ = from.take<listed_image_file>(counts_.image_files);
  image_begins_ = from.take<std::uint32_t>(std::uint64_t{counts_.images} + 1);
  pages_everywhere_ = from.take<std::uint32_t>(counts_.pages);
  images_everywhere_ = from.take<std::uint32_t>(counts_.images);
  page_boxes_ = from.take<std::array<std::uint8_t, 6>>(counts_.pages);
  json_ = from.take<std::uint8_t>(counts_.json);
  return from.used();
}

void front::fill(payload_reader& in) noexcept {
  in.floats(6, [this](std::uint32_t i, float value) { box_[i] = value; });
  for (std::size_t axis = 0; axis < 3; ++axis) in.require(box_[axis] <= box_[3 + axis]);
  const std::span<const std::uint8_t> json = in.bytes(counts_.json);
  std::copy(json.begin(), json.end(), json_);
  in.varints(counts_.geometries, [this](std::uint32_t i, std::uint32_t value) { geometries_[i] = value; });
  fill_draws(in);
  fill_pages(in);
  fill_images(in);
  fill_chunks(in);
  fill_everywhere(in);
}

void front::fill_draws(payload_reader& in) noexcept {
  const std::uint32_t count = counts_.draws;
  std::fill_n(draws_, count, sightcell_stream_draw{});
  const auto store = [this](std::uint32_t sightcell_stream_draw::*member, std::uint32_t less = 0) {
    return [this, member, less](std::uint32_t i, std::uint32_t value) { draws_[i].*member = value - less; };
  };
  in.deltas(count, counts_.geometries, store(&sightcell_stream_draw::geometry));
  in.varints(count, store(&sightcell_stream_draw::material, 1));  // 0, the default material, becomes 0xFFFFFFFF
  in.varints(count, store(&sightcell_stream_draw::flags));
  in.varints(count, store(&sightcell_stream_draw::object, 1));
  in.varints(count, store(&sightcell_stream_draw::level));
  in.deltas(count, std::uint64_t{no_limit} + 1, store(&sightcell_stream_draw::node));
  in.deltas(count, std::uint64_t{no_limit} + 1, store(&sightcell_stream_draw::mesh));
  in.deltas(count, std::uint64_t{no_limit} + 1, store(&sightcell_stream_draw::instance));
  in.varints(count, store(&sightcell_stream_draw::primitive));
  for (std::size_t k = 0; k < 12; ++k)
    in.floats(count, [this, k](std::uint32_t i, float value) { draws_[i].matrix[k] = value; });
  std::uint64_t polygons = 0;
  for (std::uint32_t i = 0; i < count && in.ok(); ++i) {
    constexpr std::uint32_t both = SIGHTCELL_STREAM_ALWAYS | SIGHTCELL_STREAM_HOST_SHOWS;
    in.require(draws_[i].flags < 8 && (draws_[i].flags & both) != both);
    polygons += geometries_[draws_[i].geometry];
  }
  in.require(polygons == counts_.polygons);
}

void front::fill_hashes(payload_reader& in, std::uint32_t first, std::uint32_t count) noexcept {
  const std::span<const std::uint8_t> hashes = in.bytes(std::uint64_t{8} * count);
  for (std::size_t i = 0; i < hashes.size() / 8; ++i)
    std::copy_n(hashes.begin() + static_cast<std::ptrdiff_t>(8 * i), 8, files_[first + i].hash.begin());
}

void front::fill_pages(payload_reader& in) noexcept {
  const std::uint32_t count = counts_.pages, first = file_of_page(0);
  in.varints(count, [this, first](std::uint32_t i, std::uint32_t value) { files_[first + i].size = value; });
  fill_hashes(in, first, count);
  for (std::size_t k = 0; k < 6; ++k) {
    const std::span<const std::uint8_t> column = in.bytes(count);
    for (std::size_t i = 0; i < column.size(); ++i) page_boxes_[i][k] = column[i];
  }
  for (std::uint32_t i = 0; i < count && in.ok(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) in.require(page_boxes_[i][axis] <= page_boxes_[i][3 + axis]);
}

void front::fill_images(payload_reader& in) noexcept {
  const std::uint32_t count = counts_.image_files, first = first_image_file();
  std::uint64_t files = 0;
  image_begins_[0] = 0;
  in.varints(counts_.images, [&](std::uint32_t i, std::uint32_t value) {
    files += value;
    in.require(files <= count);
    if (!in.ok()) return;
    image_begins_[i + 1] = static_cast<std::uint32_t>(files);
    for (std::uint32_t f = image_begins_[i]; f < image_begins_[i + 1]; ++f) image_files_[f].image = i;
  });
  in.require(files == count);
  in.varints(count, [this](std::uint32_t i, std::uint32_t value) { image_files_[i].width = value; });
  in.varints(count, [this](std::uint32_t i, std::uint32_t value) { image_files_[i].height = value; });
  in.varints(count, [this, first](std::uint32_t i, std::uint32_t value) { files_[first + i].size = value; });
  const std::span<const std::uint8_t> types = in.bytes(count);
  for (std::size_t i = 0; i < types.size(); ++i) {
    image_files_[i].type = types[i];
    in.require(types[i] < image_types);
  }
  fill_hashes(in, first, count);
}

void front::fill_chunks(payload_reader& in) noexcept {
  const std::uint32_t count = counts_.chunks;
  std::fill_n(chunks_, count, listed_chunk{});
  in.varints(count, [this](std::uint32_t i, std::uint32_t value) { files_[i].size = value; });
  std::uint64_t cells = 0;
  in.varints(count, [&](std::uint32_t i, std::uint32_t value) {
    in.require(value > 0 && cells + value <= counts_.cells);
    chunks_[i].first_cell = static_cast<std::uint32_t>(cells);
    chunks_[i].cells = value;
    cells += value;
  });
  in.require(cells == counts_.cells);
  fill_hashes(in, 0, count);
  for (std::size_t k = 0; k < 6; ++k)
    in.floats(count, [this, k](std::uint32_t i, float value) {
      (k < 3 ? chunks_[i].box.min[k] : chunks_[i].box.max[k - 3]) = static_cast<double>(value);
    });
  for (std::uint32_t i = 0; i < count && in.ok(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) in.require(chunks_[i].box.min[axis] <= chunks_[i].box.max[axis]);
}

void front::fill_everywhere(payload_reader& in) noexcept {
  const auto list = [&in](std::uint32_t limit, std::uint32_t* out) {
    const std::uint32_t count = in.varint();
    in.require(count <= limit);
    if (!in.ok()) return std::uint32_t{0};
    in.gaps(count, limit, [out](std::uint32_t i, std::uint32_t value) { out[i] = value; });
    return in.ok() ? count : 0;
  };
  page_everywhere_count_ = list(counts_.pages, pages_everywhere_);
  image_everywhere_count_ = list(counts_.images, images_everywhere_);
}

runtime::wide_box front::box_of_page(std::uint32_t page) const noexcept {
  runtime::wide_box out;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double min = static_cast<double>(box_[axis]);
    const double step = (static_cast<double>(box_[3 + axis]) - min) / 255.0;
    out.min[axis] = min + step * page_boxes_[page][axis];
    out.max[axis] = min + step * page_boxes_[page][3 + axis];
  }
  return out;
}

}  // namespace sightcell::streaming
