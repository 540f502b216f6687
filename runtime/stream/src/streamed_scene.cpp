#include "streamed_scene.h"

#include <algorithm>
#include <new>

#include "stream_view.h"

namespace runtime = sightcell::runtime;
namespace streaming = sightcell::streaming;

sightcell_status sightcell_stream::open(std::span<const std::uint8_t> front, std::uint64_t chunk_memory,
                                        const sightcell_allocator& mem, sightcell_stream** out) noexcept {
  void* const place = runtime::allocate(mem, sizeof(sightcell_stream));
  if (place == nullptr) return SIGHTCELL_ERR_MEMORY;
  auto* const made = new (place) sightcell_stream(mem);
  made->chunk_memory_ = chunk_memory;
  sightcell_status status = made->front_.read(front);
  if (status == SIGHTCELL_OK) {
    made->block_size_ = made->carve(nullptr);
    made->block_ = runtime::allocate(mem, made->block_size_);
    if (made->block_ == nullptr) status = SIGHTCELL_ERR_MEMORY;
  }
  if (status != SIGHTCELL_OK) {
    close(made);
    return status;
  }
  (void)made->carve(made->block_);
  const std::uint32_t files = made->front_.file_count(), chunks = made->front_.counts().chunks;
  std::fill_n(made->states_, files, std::uint8_t{SIGHTCELL_STREAM_ABSENT});
  std::fill_n(made->last_needed_, files, 0u);
  std::fill_n(made->chunks_, chunks, nullptr);
  std::fill_n(made->pins_, chunks, 0u);
  *out = made;
  return SIGHTCELL_OK;
}

void sightcell_stream::close(sightcell_stream* stream) noexcept {
  if (stream == nullptr) return;
  const sightcell_allocator mem = stream->mem_;
  if (stream->block_ != nullptr)
    for (std::uint32_t i = 0; i < stream->front_.counts().chunks; ++i)
      streaming::cell_chunk::destroy(mem, stream->chunks_[i]);
  runtime::release(mem, stream->block_, stream->block_size_);
  stream->~sightcell_stream();
  runtime::release(mem, stream, sizeof(sightcell_stream));
}

std::uint64_t sightcell_stream::carve(void* block) noexcept {
  runtime::carver from(block);
  chunks_ = from.take<streaming::cell_chunk*>(front_.counts().chunks);
  last_needed_ = from.take<std::uint32_t>(front_.file_count());
  pins_ = from.take<std::uint32_t>(front_.counts().chunks);
  states_ = from.take<std::uint8_t>(std::uint64_t{front_.file_count()} + 1);  // so that no block is empty
  return from.used();
}

sightcell_status sightcell_stream::check(std::uint32_t file, std::span<const std::uint8_t> bytes) const noexcept {
  const streaming::listed_file& listed = front_.files()[file];
  if (bytes.size() != listed.size) return SIGHTCELL_ERR_TRUNCATED;
  return streaming::hash_of(bytes) == listed.hash ? SIGHTCELL_OK : SIGHTCELL_ERR_CHECKSUM;
}

sightcell_status sightcell_stream::deliver(std::uint32_t file, std::span<const std::uint8_t> bytes) noexcept {
  if (const sightcell_status status = check(file, bytes); status != SIGHTCELL_OK) return status;
  if (file < front_.counts().chunks) return deliver_chunk(file, bytes);
  const runtime::latch_guard guard(latch_);
  if (states_[file] != SIGHTCELL_STREAM_PRESENT) states_[file] = SIGHTCELL_STREAM_REQUESTED;
  return SIGHTCELL_OK;
}

sightcell_status sightcell_stream::deliver_chunk(std::uint32_t number, std::span<const std::uint8_t> bytes) noexcept {
  streaming::cell_chunk* unused = nullptr;
  if (const sightcell_status status = streaming::cell_chunk::create(front_, number, bytes, mem_, &unused);
      status != SIGHTCELL_OK)
    return status;
  {
    const runtime::latch_guard guard(latch_);
    if (chunks_[number] == nullptr) {
      chunks_[number] = unused;
      chunk_bytes_ += unused->memory();
      states_[number] = SIGHTCELL_STREAM_PRESENT;
      touch(number);
      unused = nullptr;
      while (chunk_bytes_ > chunk_memory_) {
        streaming::cell_chunk* const taken = take_least_recent(number);
        if (taken == nullptr) break;
        taken->next = unused;
        unused = taken;
      }
    }
  }
  while (unused != nullptr) {
    streaming::cell_chunk* const next = unused->next;
    streaming::cell_chunk::destroy(mem_, unused);
    unused = next;
  }
  return SIGHTCELL_OK;
}

// Null if views use all but the kept one.
streaming::cell_chunk* sightcell_stream::take_least_recent(std::uint32_t kept) noexcept {
  const std::uint32_t count = front_.counts().chunks;
  std::uint32_t least = count;
  for (std::uint32_t i = 0; i < count; ++i)
    if (chunks_[i] != nullptr && pins_[i] == 0 && i != kept &&
        (least == count || last_needed_[i] < last_needed_[least]))
      least = i;
  if (least == count) return nullptr;
  streaming::cell_chunk* const out = chunks_[least];
  chunks_[least] = nullptr;
  states_[least] = SIGHTCELL_STREAM_ABSENT;
  chunk_bytes_ -= out->memory();
  return out;
}

sightcell_status sightcell_stream::set_state(std::uint32_t file, std::uint32_t state) noexcept {
  const runtime::latch_guard guard(latch_);
  if (file < front_.counts().chunks && (state == SIGHTCELL_STREAM_PRESENT || chunks_[file] != nullptr))
    return SIGHTCELL_ERR_ARGUMENT;
  states_[file] = static_cast<std::uint8_t>(state);
  return SIGHTCELL_OK;
}

std::uint32_t sightcell_stream::state(std::uint32_t file) const noexcept {
  const runtime::latch_guard guard(latch_);
  return states_[file];
}

void sightcell_stream::touch_image(std::uint32_t image) noexcept {
  for (std::uint32_t file = front_.files_begin(image); file < front_.files_begin(image + 1); ++file) touch(file);
}

void sightcell_stream::touch_files_of(const streaming::chunk_cell& cell) noexcept {
  for (const streaming::listed_page& page : cell.pages) touch(front_.file_of_page(page.page));
  for (const streaming::listed_image& image : cell.images) touch_image(image.image);
}

bool sightcell_stream::is_settled(std::uint32_t image) const noexcept {
  bool all_failed = true;
  for (std::uint32_t file = front_.files_begin(image); file < front_.files_begin(image + 1); ++file) {
    if (states_[file] == SIGHTCELL_STREAM_PRESENT) return true;
    all_failed = all_failed && states_[file] == SIGHTCELL_STREAM_FAILED;
  }
  return all_failed;
}

std::size_t sightcell_stream::list_removable(std::span<std::uint32_t> dst) noexcept {
  const runtime::latch_guard guard(latch_);
  const std::uint32_t now = advance();
  for (const sightcell_stream_view* view = views_; view != nullptr; view = view->next)
    view->for_each_held([this](const streaming::chunk_cell& cell) { touch_files_of(cell); });
  for (const std::uint32_t page : front_.pages_everywhere()) touch(front_.file_of_page(page));
  for (const std::uint32_t image : front_.images_everywhere()) touch_image(image);

  // A heap of the files that were needed least recently so far, the most recent of them on top.
  const auto earlier = [this](std::uint32_t a, std::uint32_t b) {
    return last_needed_[a] != last_needed_[b] ? last_needed_[a] < last_needed_[b] : a < b;
  };
  std::size_t count = 0;
  for (std::uint32_t file = front_.counts().chunks; file < front_.file_count() && !dst.empty(); ++file) {
    if (states_[file] != SIGHTCELL_STREAM_PRESENT || last_needed_[file] == now) continue;
    if (count == dst.size()) {
      if (!earlier(file, dst.front())) continue;
      std::pop_heap(dst.begin(), dst.end(), earlier);
      --count;
    }
    dst[count++] = file;
    std::push_heap(dst.begin(), dst.begin() + static_cast<std::ptrdiff_t>(count), earlier);
  }
  std::sort_heap(dst.begin(), dst.begin() + static_cast<std::ptrdiff_t>(count), earlier);
  return count;
}

void sightcell_stream::add(sightcell_stream_view& view) noexcept {
  const runtime::latch_guard guard(latch_);
  view.next = views_;
  views_ = &view;
}

void sightcell_stream::remove(sightcell_stream_view& view) noexcept {
  const runtime::latch_guard guard(latch_);
  sightcell_stream_view** link = &views_;
  while (*link != &view) link = &(*link)->next;
  *link = view.next;
}
