#include "cluster_map.h"

#include <algorithm>
#include <array>
#include <bit>
#include <new>

using namespace sightcell::runtime;
namespace format = sightcell::format;

namespace {

constexpr std::uint32_t small_block = 16;        // polygons; the polygons at the ends of a run are taken one by one
constexpr std::uint32_t fewest_for_blocks = 32;  // polygons of a run: shorter ones are taken one by one
constexpr std::uint32_t large_block = 128;       // polygons: for long runs
constexpr std::uint32_t bits_per_word = 32;

// The words that the clusters of one block are in.
class block_words {
 public:
  void clear() noexcept { count_ = 0; }
  void add(std::uint32_t cluster) noexcept {
    const std::uint32_t word = cluster / bits_per_word;
    std::uint32_t at = 0;
    while (at < count_ && words_[at].word != word) ++at;
    if (at == count_) words_[count_++] = {word, 0};
    words_[at].bits |= 1u << cluster % bits_per_word;
  }
  [[nodiscard]] std::span<const cluster_bits> words() const noexcept { return std::span(words_).first(count_); }

 private:
  std::array<cluster_bits, large_block> words_;
  std::uint32_t count_ = 0;
};

// Calls take(stored polygon, cluster) for all polygons in stored order, until it returns false.
template <class Take>
bool for_each_stored(const sightcell_db& db, std::span<const std::uint32_t> cluster_of_source, const Take& take) {
  const std::span<const std::uint32_t> borders = db.range_borders();
  std::uint32_t stored = 0;
  for (std::uint32_t draw = 0; draw + 1 < borders.size(); ++draw) {
    const std::uint32_t first = db.first_source(draw);
    for (const std::uint32_t polygon : db.sources_in(draw, 0, borders[draw + 1] - borders[draw])) {
      // The bytes of the file may have changed while it was opened.
      if (first + polygon >= cluster_of_source.size()) return false;
      if (!take(stored++, cluster_of_source[first + polygon])) return false;
    }
  }
  return true;
}

// Fills the blocks, or counts the words that they take if out has no room. The blocks are fed all polygons in order.
class block_builder {
 public:
  block_builder(std::uint32_t polygons_per_block, cluster_blocks out) noexcept : size_(polygons_per_block), out_(out) {}

  void add(std::uint32_t stored, std::uint32_t cluster) noexcept {
    if (cluster != SIGHTCELL_NO_CLUSTER) block_.add(cluster);
    if ((stored + 1) % size_ != 0) return;
    const std::span<const cluster_bits> words = block_.words();
    if (!out_.begins.empty()) {
      std::copy(words.begin(), words.end(), out_.bits.begin() + static_cast<std::ptrdiff_t>(count_));
      out_.begins[(stored + 1) / size_] = static_cast<std::uint32_t>(count_ + words.size());
    }
    count_ += words.size();
    block_.clear();
  }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

 private:
  std::uint32_t size_;
  cluster_blocks out_;
  block_words block_;
  std::uint64_t count_ = 0;  // at most one per polygon
};

void mark_blocks(const cluster_blocks& blocks, std::uint32_t first, std::uint32_t end, std::uint32_t* row) noexcept {
  const std::uint32_t begin = blocks.begins[first];
  for (const cluster_bits& b : blocks.bits.subspan(begin, blocks.begins[end] - begin)) row[b.word] |= b.bits;
}

// n / d, rounded up.
std::uint32_t whole_parts(std::uint32_t n, std::uint32_t d) noexcept {
  return n / d + (n % d != 0 ? 1 : 0);
}

// Gives a span its size, for carve.
template <class T>
void plan_room(std::span<T>& target, std::uint64_t count) noexcept {
  target = {static_cast<T*>(nullptr), static_cast<std::size_t>(count)};
}

}  // namespace

// The sizes of the spans are set before.
std::uint64_t sightcell_cluster_map::carve(void* block) noexcept {
  carver space(block);
  space.take<sightcell_cluster_map>(1);
  const auto give = [&]<class T>(std::span<T>& target) {
    T* first = space.take<T>(target.size());
    if (first == nullptr) return;
    sightcell::runtime::construct(first, target.size());
    target = {first, target.size()};
  };
  of_file_.carve(space);
  give(host_of_file_);
  give(windows_);
  give(cluster_of_stored_);
  for (cluster_blocks* blocks : {&small_, &large_}) {
    give(blocks->begins);
    give(blocks->bits);
  }
  return space.used();
}

sightcell_status sightcell_cluster_map::create(const sightcell_db& db, std::span<const std::uint32_t> cluster_of_source,
                                               std::uint32_t cluster_count, sightcell_cluster_map** out) noexcept {
  if (cluster_of_source.size() != db.polygon_count()) return SIGHTCELL_ERR_ARGUMENT;
  for (const std::uint32_t cluster : cluster_of_source) {
    if (cluster >= cluster_count && cluster != SIGHTCELL_NO_CLUSTER) return SIGHTCELL_ERR_ARGUMENT;
  }
  if (db.file().cluster_count() > 0) {
    sightcell_cluster_map plan;
    plan.db_ = &db;
    plan.words_ = whole_parts(cluster_count, bits_per_word);
    plan.of_file_.measure(db);
    plan_room(plan.host_of_file_, db.file().cluster_count());
    if (const sightcell_status s = make(plan, out); s != SIGHTCELL_OK) return s;
    if ((*out)->take_file_clusters(cluster_of_source)) return SIGHTCELL_OK;
    destroy(*out);
    *out = nullptr;
  }
  block_builder small(small_block, {});
  block_builder large(large_block, {});
  window_builder windows({});
  const bool counted = for_each_stored(db, cluster_of_source, [&](std::uint32_t stored, std::uint32_t cluster) {
    small.add(stored, cluster);
    large.add(stored, cluster);
    windows.add(cluster);
    return true;
  });
  windows.finish();
  if (!counted) return SIGHTCELL_ERR_CORRUPT;

  sightcell_cluster_map plan;
  plan.db_ = &db;
  plan.words_ = whole_parts(cluster_count, bits_per_word);
  plan_room(plan.windows_, windows.count());
  plan_room(plan.cluster_of_stored_, db.polygon_count());
  plan_room(plan.small_.begins, std::uint64_t{db.polygon_count() / small_block} + 1);
  plan_room(plan.small_.bits, small.count());
  plan_room(plan.large_.begins, std::uint64_t{db.polygon_count() / large_block} + 1);
  plan_room(plan.large_.bits, large.count());
  sightcell_cluster_map* map = nullptr;
  if (const sightcell_status s = make(plan, &map); s != SIGHTCELL_OK) return s;
  map->fill(cluster_of_source);
  *out = map;
  return SIGHTCELL_OK;
}

void sightcell_cluster_map::fill(std::span<const std::uint32_t> cluster_of_source) noexcept {
  window_builder windows(windows_);
  block_builder small(small_block, small_);
  block_builder large(large_block, large_);
  static_cast<void>(for_each_stored(*db_, cluster_of_source, [&](std::uint32_t stored, std::uint32_t cluster) {
    small.add(stored, cluster);
    large.add(stored, cluster);
    windows.add(cluster);
    return true;
  }));
  windows.finish();
  std::size_t window = 0;
  static_cast<void>(for_each_stored(*db_, cluster_of_source, [&](std::uint32_t stored, std::uint32_t cluster) {
    if (stored == windows_[window].end) ++window;
    cluster_of_stored_[stored] = cluster_in_window(windows_[window], cluster);
    return true;
  }));
}

// plan: with the sizes of its tables.
sightcell_status sightcell_cluster_map::make(const sightcell_cluster_map& plan, sightcell_cluster_map** out) noexcept {
  sightcell_cluster_map sized(plan);
  const std::uint64_t size = sized.carve(nullptr);
  void* block = allocate(plan.db_->allocator(), size);
  if (block == nullptr) return SIGHTCELL_ERR_MEMORY;
  auto* map = new (block) sightcell_cluster_map(plan);
  map->block_size_ = size;
  static_cast<void>(map->carve(block));
  map->of_file_.fill(*plan.db_);
  *out = map;
  return SIGHTCELL_OK;
}

sightcell_status sightcell_cluster_map::create_of_file(const sightcell_db& db, sightcell_cluster_map** out) noexcept {
  sightcell_cluster_map plan;
  plan.db_ = &db;
  plan.words_ = whole_parts(db.file().cluster_count(), bits_per_word);
  plan.of_file_.measure(db);
  return make(plan, out);
}

// False if polygons of one cluster of the file are in different ones of the host.
bool sightcell_cluster_map::take_file_clusters(std::span<const std::uint32_t> cluster_of_source) noexcept {
  std::uint32_t cluster = 0;
  return for_each_stored(*db_, cluster_of_source, [&](std::uint32_t stored, std::uint32_t of_host) {
    if (stored == of_file_.begin(cluster)) host_of_file_[cluster] = of_host;
    if (host_of_file_[cluster] != of_host) return false;
    if (stored + 1 == of_file_.begin(cluster + 1)) ++cluster;
    return true;
  });
}

void sightcell_cluster_map::mark_file_clusters(std::span<const format::run> set,
                                               std::span<std::uint32_t> row) const noexcept {
  for (const format::run& r : set) {
    const std::uint32_t first = of_file_.at(r.first);
    const std::uint32_t end = of_file_.at(r.first + r.count);
    if (host_of_file_.empty()) {
      set_bits(row, first, end);
      continue;
    }
    for (const std::uint32_t cluster : host_of_file_.subspan(first, end - first)) {
      if (cluster != SIGHTCELL_NO_CLUSTER) row[cluster / bits_per_word] |= 1u << cluster % bits_per_word;
    }
  }
}

void sightcell_cluster_map::destroy(sightcell_cluster_map* map) noexcept {
  if (map != nullptr) release(map->db_->allocator(), map, map->block_size_);
}

void sightcell_cluster_map::mark(std::span<const format::run> set, std::span<std::uint32_t> row) const noexcept {
  if (of_file_.exist()) return mark_file_clusters(set, row);
  constexpr std::uint32_t small_in_large = large_block / small_block;
  std::uint32_t* const words = row.data();
  cluster_collector ends(windows_, cluster_of_stored_, row);
  for (const format::run& r : set) {
    const std::uint32_t end = r.first + r.count;
    if (r.count < fewest_for_blocks) {
      ends.add(r.first, end);
      continue;
    }
    const std::uint32_t from = whole_parts(r.first, small_block);  // in small blocks
    const std::uint32_t to = end / small_block;
    const std::uint32_t from_large = whole_parts(from, small_in_large);
    const std::uint32_t to_large = to / small_in_large;
    ends.add(r.first, from * small_block);
    if (from_large < to_large) {
      mark_blocks(small_, from, from_large * small_in_large, words);
      mark_blocks(large_, from_large, to_large, words);
      mark_blocks(small_, to_large * small_in_large, to, words);
    } else {
      mark_blocks(small_, from, to, words);
    }
    ends.add(to * small_block, end);
  }
  ends.finish();
}

namespace sightcell::runtime {

std::uint64_t list_clusters(std::span<const std::uint32_t> row, std::span<std::uint32_t> dst) noexcept {
  std::uint64_t count = 0;
  for (std::size_t word = 0; word < row.size(); ++word) {
    for (std::uint32_t left = row[word]; left != 0; left &= left - 1, ++count) {
      if (count < dst.size()) {
        dst[static_cast<std::size_t>(count)] =
            static_cast<std::uint32_t>(word) * bits_per_word + static_cast<std::uint32_t>(std::countr_zero(left));
      }
    }
  }
  return count;
}

std::uint64_t list_changes(std::span<const std::uint32_t> before, std::span<const std::uint32_t> now,
                           std::span<sightcell_cluster_word> dst) noexcept {
  std::uint64_t count = 0;
  for (std::size_t word = 0; word < now.size(); ++word) {
    if (before[word] == now[word]) continue;
    if (count < dst.size()) dst[static_cast<std::size_t>(count)] = {static_cast<std::uint32_t>(word), now[word]};
    ++count;
  }
  return count;
}

}  // namespace sightcell::runtime
