#include "chunk_split.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "bit_reader.h"
#include "packed_columns_writer.h"

namespace sightcell::format {
namespace {

class block_splitter {
 public:
  block_splitter(std::span<const std::vector<run>> sets, const row_encoders& encoders, std::uint32_t limit,
                 std::uint64_t most_bytes, const plan_settings& how)
      : sets_(sets), encoders_(encoders), limit_(limit), most_bytes_(most_bytes), how_(how) {}

  void split(std::uint32_t first, std::uint32_t cells) {
    const auto part = sets_.subspan(first, cells);
    chunk_plan plan = plan_chunk(part, encoders_, limit_, how_);
    const std::vector<std::uint64_t> bytes = row_bytes(part, plan, encoders_);
    const std::uint64_t rows = std::accumulate(bytes.begin(), bytes.end(), std::uint64_t{0});
    const std::uint64_t table = 1 + (static_cast<std::uint64_t>(std::bit_width(rows)) * cells + 7) / 8;
    const std::uint64_t all = table + rows + bit_reader::padding;
    // The codes of the file differ a little from those that are expected.
    if (cells == 1 || all + all / 32 <= most_bytes_) {
      chunks_.push_back({first, cells, std::move(plan)});
      return;
    }
    // Rows get larger, because references are lost: so the parts are planned for three quarters of the bytes.
    const std::uint64_t parts = std::max<std::uint64_t>(2, (4 * all + 3 * most_bytes_ - 1) / (3 * most_bytes_));
    split_in(first, bytes, rows, parts);
  }

  [[nodiscard]] std::vector<planned_chunk> take() { return std::move(chunks_); }

 private:
  // Each part ends with the cell that completes its share of the bytes. A cell that has more than a share begins a
  // part: so there are two or more.
  void split_in(std::uint32_t first, std::span<const std::uint64_t> bytes, std::uint64_t all, std::uint64_t parts) {
    std::uint32_t begin = 0;
    std::uint64_t seen = 0;
    std::uint64_t done = 0;  // shares
    const auto cells = static_cast<std::uint32_t>(bytes.size());
    for (std::uint32_t cell = 0; cell < cells; ++cell) {
      if (bytes[cell] * parts >= all && cell > begin) {
        split(first + begin, cell - begin);
        begin = cell;
        done = seen * parts / all;
      }
      seen += bytes[cell];
      if (seen * parts < all * (done + 1) && cell + 1 < cells) continue;
      split(first + begin, cell + 1 - begin);
      begin = cell + 1;
      done = seen * parts / all;
    }
  }

  std::span<const std::vector<run>> sets_;
  const row_encoders& encoders_;
  std::uint32_t limit_;
  std::uint64_t most_bytes_;
  const plan_settings& how_;
  std::vector<planned_chunk> chunks_;
};

}  // namespace

std::vector<planned_chunk> split_block(std::span<const std::vector<run>> sets, const row_encoders& encoders,
                                       std::uint32_t limit, std::uint64_t most_bytes, const plan_settings& how) {
  block_splitter splitter(sets, encoders, limit, most_bytes, how);
  splitter.split(0, static_cast<std::uint32_t>(sets.size()));
  return splitter.take();
}

std::vector<std::byte> encode_borders(std::span<const std::vector<planned_chunk>> blocks) {
  std::vector<std::byte> bytes;
  std::vector<std::vector<std::uint32_t>> columns(3);
  std::uint32_t chunks = 0;
  for (const std::vector<planned_chunk>& block : blocks) {
    std::uint64_t begins = 0;
    for (const planned_chunk& chunk : block) begins |= std::uint64_t{1} << chunk.first;
    columns[0].push_back(chunks);
    columns[1].push_back(static_cast<std::uint32_t>(begins));
    columns[2].push_back(static_cast<std::uint32_t>(begins >> 32));
    chunks += static_cast<std::uint32_t>(block.size());
  }
  if (chunks > blocks.size()) put_columns(columns, bytes);
  return bytes;
}

}  // namespace sightcell::format
