// The C functions: each checks its arguments and calls the implementation.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>

#include "sightcell/stream.h"
#include "stream_view.h"
#include "streamed_scene.h"

namespace runtime = sightcell::runtime;
namespace streaming = sightcell::streaming;

static_assert(sizeof(sightcell_stream_info) == 80 && sizeof(sightcell_stream_draw) == 84);
static_assert(sizeof(sightcell_stream_file) == 72 && sizeof(sightcell_stream_pose) == 56);
static_assert(sizeof(sightcell_stream_frame) == 64 && sizeof(sightcell_stream_request) == 16);

namespace {

std::span<const std::uint8_t> span_of(const void* bytes, std::size_t size) noexcept {
  return {static_cast<const std::uint8_t*>(bytes), size};
}

// Of a list: OK if dst has room for need elements.
sightcell_status check_room(const void* dst, std::size_t capacity, std::size_t need, std::size_t* count) noexcept {
  if (count == nullptr || (dst == nullptr && capacity > 0)) return SIGHTCELL_ERR_ARGUMENT;
  *count = need;
  return need > capacity ? SIGHTCELL_ERR_CAPACITY : SIGHTCELL_OK;
}

template <class Item>
sightcell_status copy_list(std::span<const Item> list, void* dst, std::size_t capacity, std::size_t* count) noexcept {
  const sightcell_status status = check_room(dst, capacity, list.size(), count);
  if (status == SIGHTCELL_OK && !list.empty()) std::memcpy(dst, list.data(), list.size_bytes());
  return status;
}

bool has_file(const sightcell_stream* stream, std::uint32_t file) noexcept {
  return stream != nullptr && file < stream->front().file_count();
}

void write_name(const char* folder, const streaming::content_hash& hash, std::string_view extension,
                char* out) noexcept {
  constexpr std::string_view digits = "0123456789abcdef";
  while (*folder != '\0') *out++ = *folder++;
  *out++ = '/';
  for (const std::uint8_t byte : hash) {
    *out++ = digits[byte >> 4];
    *out++ = digits[byte & 15u];
  }
  *out++ = '.';
  out = std::copy(extension.begin(), extension.end(), out);
  *out = '\0';
}

}  // namespace

extern "C" {

sightcell_status sightcell_stream_open(const void* front, std::size_t size, std::uint64_t chunk_memory,
                                       const sightcell_allocator* mem, sightcell_stream** out) {
  if (out == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  *out = nullptr;
  const sightcell_allocator from = mem == nullptr ? runtime::default_allocator() : *mem;
  if (front == nullptr || from.alloc == nullptr || from.release == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  return sightcell_stream::open(span_of(front, size), chunk_memory, from, out);
}

void sightcell_stream_close(sightcell_stream* stream) {
  sightcell_stream::close(stream);
}

sightcell_status sightcell_stream_describe(const sightcell_stream* stream, sightcell_stream_info* out) {
  if (stream == nullptr || out == nullptr || out->struct_size < sizeof(sightcell_stream_info))
    return SIGHTCELL_ERR_ARGUMENT;
  const streaming::front& front = stream->front();
  const streaming::front_counts& counts = front.counts();
  sightcell_stream_info info{};
  info.struct_size = sizeof(sightcell_stream_info);
  info.polygon_count = counts.polygons;
  info.geometry_count = counts.geometries;
  info.draw_count = counts.draws;
  info.file_count = front.file_count();
  info.chunk_count = counts.chunks;
  info.page_count = counts.pages;
  info.image_file_count = counts.image_files;
  info.image_count = counts.images;
  info.cell_count = counts.cells;
  std::copy_n(front.box().begin(), 3, info.min);
  std::copy_n(front.box().begin() + 3, 3, info.max);
  std::copy_n(front.fingerprint().begin(), front.fingerprint().size(), info.scene_fingerprint);
  *out = info;
  return SIGHTCELL_OK;
}

sightcell_status sightcell_stream_same_scene(const sightcell_stream* stream, const std::uint8_t scene_fingerprint[16]) {
  if (stream == nullptr || scene_fingerprint == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  const std::span<const std::uint8_t, 16> own = stream->front().fingerprint();
  return std::equal(own.begin(), own.end(), scene_fingerprint) ? SIGHTCELL_OK : SIGHTCELL_ERR_OTHER_SCENE;
}

sightcell_status sightcell_stream_json(const sightcell_stream* stream, char* dst, std::size_t capacity,
                                       std::size_t* count) {
  if (stream == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  return copy_list(stream->front().json(), dst, capacity, count);
}

sightcell_status sightcell_stream_draws(const sightcell_stream* stream, sightcell_stream_draw* dst,
                                        std::size_t capacity, std::size_t* count) {
  if (stream == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  return copy_list(stream->front().draws(), dst, capacity, count);
}

sightcell_status sightcell_stream_geometries(const sightcell_stream* stream, std::uint32_t* dst, std::size_t capacity,
                                             std::size_t* count) {
  if (stream == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  return copy_list(stream->front().geometries(), dst, capacity, count);
}

sightcell_status sightcell_stream_image_files(const sightcell_stream* stream, std::uint32_t image, std::uint32_t* first,
                                              std::uint32_t* count) {
  if (stream == nullptr || first == nullptr || count == nullptr || image >= stream->front().counts().images)
    return SIGHTCELL_ERR_ARGUMENT;
  *first = stream->front().files_begin(image);
  *count = stream->front().files_begin(image + 1) - *first;
  return SIGHTCELL_OK;
}

sightcell_status sightcell_stream_describe_file(const sightcell_stream* stream, std::uint32_t file,
                                                sightcell_stream_file* out) {
  if (!has_file(stream, file) || out == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  constexpr std::array<std::string_view, 5> extensions = {"png", "jpg", "webp", "ktx2", "bin"};
  const streaming::front& front = stream->front();
  const streaming::listed_file& listed = front.files()[file];
  sightcell_stream_file made{};
  made.size = listed.size;
  std::copy(listed.hash.begin(), listed.hash.end(), made.hash);
  if (file < front.counts().chunks) {
    made.kind = SIGHTCELL_STREAM_CHUNK;
    made.number = file;
    write_name("cells", listed.hash, "cells", made.name);
  } else if (file < front.first_image_file()) {
    made.kind = SIGHTCELL_STREAM_PAGE;
    made.number = file - front.counts().chunks;
    write_name("pages", listed.hash, "glb", made.name);
  } else {
    const streaming::listed_image_file& image = front.image_file(file);
    made.kind = SIGHTCELL_STREAM_IMAGE;
    made.number = image.image;
    made.width = image.width;
    made.height = image.height;
    made.image_type = image.type;
    write_name("images", listed.hash, extensions[image.type], made.name);
  }
  *out = made;
  return SIGHTCELL_OK;
}

sightcell_status sightcell_stream_check(const sightcell_stream* stream, std::uint32_t file, const void* bytes,
                                        std::size_t size) {
  if (!has_file(stream, file) || bytes == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  return stream->check(file, span_of(bytes, size));
}

sightcell_status sightcell_stream_deliver(sightcell_stream* stream, std::uint32_t file, const void* bytes,
                                          std::size_t size) {
  if (!has_file(stream, file) || bytes == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  return stream->deliver(file, span_of(bytes, size));
}

sightcell_status sightcell_stream_set_state(sightcell_stream* stream, std::uint32_t file, std::uint32_t state) {
  if (!has_file(stream, file) || state > SIGHTCELL_STREAM_FAILED) return SIGHTCELL_ERR_ARGUMENT;
  return stream->set_state(file, state);
}

std::uint32_t sightcell_stream_state(const sightcell_stream* stream, std::uint32_t file) {
  return has_file(stream, file) ? stream->state(file) : std::uint32_t{SIGHTCELL_STREAM_ABSENT};
}

sightcell_status sightcell_stream_removable(sightcell_stream* stream, std::uint32_t* dst, std::size_t capacity,
                                            std::size_t* count) {
  if (stream == nullptr || count == nullptr || (dst == nullptr && capacity > 0)) return SIGHTCELL_ERR_ARGUMENT;
  *count = stream->list_removable({dst, capacity});
  return SIGHTCELL_OK;
}

sightcell_status sightcell_stream_view_create(sightcell_stream* stream, sightcell_stream_view** out) {
  if (out == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  *out = nullptr;
  if (stream == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  return sightcell_stream_view::create(*stream, out);
}

void sightcell_stream_view_destroy(sightcell_stream_view* view) {
  sightcell_stream_view::destroy(view);
}

sightcell_status sightcell_stream_view_move(sightcell_stream_view* view, const sightcell_stream_pose* pose,
                                            sightcell_stream_frame* frame) {
  if (view == nullptr || pose == nullptr || frame == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  const auto is_finite = [](const float(&v)[3]) {
    return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
  };
  if (!is_finite(pose->eye) || !is_finite(pose->velocity) || !is_finite(pose->forward) || !is_finite(pose->up) ||
      !std::isfinite(pose->half_width) || !std::isfinite(pose->half_height))
    return SIGHTCELL_ERR_ARGUMENT;
  view->move(*pose, *frame);
  return SIGHTCELL_OK;
}

sightcell_status sightcell_stream_view_requests(sightcell_stream_view* view, float seconds,
                                                sightcell_stream_request* dst, std::size_t capacity,
                                                std::size_t* count) {
  if (view == nullptr || count == nullptr || (dst == nullptr && capacity > 0) || !std::isfinite(seconds) ||
      seconds < 0.0f)
    return SIGHTCELL_ERR_ARGUMENT;
  *count = view->list_requests(static_cast<double>(seconds), {dst, capacity});
  return SIGHTCELL_OK;
}

sightcell_status sightcell_stream_view_draws(const sightcell_stream_view* view, std::uint64_t* bits_by_draw,
                                             std::size_t words) {
  if (view == nullptr || bits_by_draw == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  if (words < (view->stream().front().draws().size() + 63) / 64) return SIGHTCELL_ERR_CAPACITY;
  std::fill_n(bits_by_draw, words, std::uint64_t{0});
  view->write_draws(bits_by_draw);
  return SIGHTCELL_OK;
}

}  // extern "C"
