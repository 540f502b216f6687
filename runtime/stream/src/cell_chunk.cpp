#include "cell_chunk.h"

#include <array>
#include <bit>
#include <new>

#include "payload_reader.h"

namespace sightcell::streaming {
namespace {

// The lists of cells have their lengths in columns between other columns, so a first pass adds up the lengths.
struct list_totals {
  std::uint64_t pages = 0, runs = 0, images = 0;
};

// Skips n varints and returns their sum.
std::uint64_t sum_of(payload_reader& in, std::uint64_t n) noexcept {
  std::uint64_t sum = 0;
  for (std::uint64_t i = 0; i < n && in.ok(); ++i) sum += in.varint();
  return sum;
}

// False for bytes that are no chunk.
bool add_up(payload_reader in, std::uint32_t cells, list_totals& out) noexcept {
  (void)sum_of(in, cells);  // numbers
  (void)in.bytes(std::uint64_t{28} * cells);
  out.pages = sum_of(in, cells);
  (void)sum_of(in, out.pages);
  (void)in.bytes(2 * out.pages);
  out.runs = sum_of(in, cells);
  (void)sum_of(in, 2 * out.runs);
  out.images = sum_of(in, cells);
  (void)sum_of(in, out.images);
  (void)in.bytes(out.images);
  return in.is_finished();
}

// Divides `all` into the lists of the cells.
template <class Item>
void take_lists(payload_reader& in, std::span<chunk_cell> cells, std::span<Item> chunk_cell::*list,
                Item* all) noexcept {
  in.varints(static_cast<std::uint32_t>(cells.size()), [&](std::uint32_t i, std::uint32_t count) {
    cells[i].*list = {all, count};
    all += count;
  });
}

}  // namespace

sightcell_status cell_chunk::create(const front& scene, std::uint32_t chunk, std::span<const std::uint8_t> file,
                                    const sightcell_allocator& mem, cell_chunk** out) noexcept {
  *out = nullptr;
  if (file.size() < 4) return SIGHTCELL_ERR_CORRUPT;
  inflated payload(mem);
  const sightcell_status status = payload.read(file.subspan(4), u32_at(file, 0));
  if (status != SIGHTCELL_OK) return status;
  payload_reader in(payload.bytes());
  const std::uint32_t cells = in.varint();
  list_totals totals;
  if (!in.ok() || cells != scene.chunks()[chunk].cells || !add_up(in, cells, totals)) return SIGHTCELL_ERR_CORRUPT;

  cell_chunk made;
  made.size_ = made.carve(nullptr, cells, totals.pages, totals.runs, totals.images);
  void* const block = runtime::allocate(mem, made.size_);
  if (block == nullptr) return SIGHTCELL_ERR_MEMORY;
  auto* const placed = new (block) cell_chunk(made);
  (void)placed->carve(block, cells, totals.pages, totals.runs, totals.images);
  placed->number_ = chunk;
  placed->fill(scene, in);
  if (!in.is_finished()) {
    destroy(mem, placed);
    return SIGHTCELL_ERR_CORRUPT;
  }
  *out = placed;
  return SIGHTCELL_OK;
}

void cell_chunk::destroy(const sightcell_allocator& mem, cell_chunk* chunk) noexcept {
  if (chunk != nullptr) runtime::release(mem, chunk, chunk->size_);
}

std::uint64_t cell_chunk::carve(void* block, std::uint32_t cells, std::uint64_t pages, std::uint64_t runs,
                                std::uint64_t images) noexcept {
  runtime::carver from(block);
  (void)from.take<cell_chunk>(1);
  auto* const list = from.take<chunk_cell>(cells);
  pages_ = from.take<listed_page>(pages);
  runs_ = from.take<draw_run>(runs);
  images_ = from.take<listed_image>(images);
  if (block != nullptr) {
    cells_ = {list, cells};
    for (chunk_cell& cell : cells_) new (&cell) chunk_cell();
  }
  return from.used();
}

void cell_chunk::fill(const front& scene, payload_reader& in) noexcept {
  const front_counts& counts = scene.counts();
  const auto n = static_cast<std::uint32_t>(cells_.size());
  const auto length = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
  in.deltas(n, std::uint64_t{1} << 32, [this](std::uint32_t i, std::uint32_t value) { cells_[i].number = value; });
  for (std::size_t k = 0; k < 6; ++k)
    in.floats(n, [this, k](std::uint32_t i, float value) {
      (k < 3 ? cells_[i].box.min[k] : cells_[i].box.max[k - 3]) = value;
    });
  for (const chunk_cell& cell : cells_)
    for (std::size_t axis = 0; axis < 3; ++axis) in.require(cell.box.min[axis] <= cell.box.max[axis]);
  in.floats(n, [&](std::uint32_t i, float value) {
    in.require(value >= 0.0f);
    cells_[i].weight = value;
  });

  take_lists(in, cells_, &chunk_cell::pages, pages_);
  for (chunk_cell& cell : cells_)
    in.gaps(length(cell.pages), counts.pages, [&](std::uint32_t i, std::uint32_t v) { cell.pages[i].page = v; });
  for (chunk_cell& cell : cells_)
    for (listed_page& page : cell.pages) page.share = in.byte();
  for (chunk_cell& cell : cells_)
    for (listed_page& page : cell.pages) page.headings = in.byte();

  take_lists(in, cells_, &chunk_cell::runs, runs_);
  for (chunk_cell& cell : cells_) {
    std::uint64_t end = 0;
    for (draw_run& run : cell.runs) {
      const std::uint64_t first = end + in.varint();
      end = first + in.varint() + 1;
      in.require(end <= counts.draws);
      if (in.ok()) run = {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end - first)};
    }
  }

  take_lists(in, cells_, &chunk_cell::images, images_);
  for (chunk_cell& cell : cells_)
    in.gaps(length(cell.images), counts.images, [&](std::uint32_t i, std::uint32_t v) { cell.images[i].image = v; });
  for (chunk_cell& cell : cells_)
    for (listed_image& image : cell.images) image.share = in.byte();
}

float weight_of(float whole, std::uint8_t share) noexcept {
  // 2^(-k / 8). A table, because exp2 of C libraries differs in the last bits and orders must not.
  constexpr std::array<float, 8> eighths = {1.0f,         0.917004043f, 0.840896415f, 0.771105413f,
                                            0.707106781f, 0.648419777f, 0.594603558f, 0.545253866f};
  const float halves = std::bit_cast<float>(std::uint32_t{127u - share / 8u} << 23);
  return whole * eighths[share % 8u] * halves;
}

}  // namespace sightcell::streaming
