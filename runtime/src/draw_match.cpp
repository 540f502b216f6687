#include "draw_match.h"

#include <algorithm>
#include <cstddef>

#include "memory.h"
#include "sightcell/format/geometry_hash.h"

namespace sightcell::runtime {
namespace {

// A draw of the file or of the host.
struct known_draw {
  std::uint64_t hash = 0;
  std::uint64_t name = 0;   // a hash; 0: none
  std::uint32_t order = 0;  // in source order, as far as it is known
  std::uint32_t number = 0;
};

bool comes_before(const known_draw& a, const known_draw& b) noexcept {
  if (a.hash != b.hash) return a.hash < b.hash;
  return a.name != b.name ? a.name < b.name : a.order < b.order;
}

bool is_alike(const known_draw& a, const known_draw& b) noexcept {
  return a.hash == b.hash && a.name == b.name;
}

std::uint64_t hash_of_name(std::string_view name) noexcept {
  std::uint64_t hash = name.empty() ? 0 : name.size();
  for (const char c : name) hash = format::mixed(hash ^ static_cast<unsigned char>(c));
  return hash;
}

// The draws of both sides that are not matched yet.
struct unmatched {
  std::span<known_draw> file, host;
};

// The draws from `begin` on that are alike.
std::size_t alike(std::span<const known_draw> sorted, std::size_t begin) noexcept {
  std::size_t end = begin;
  while (end < sorted.size() && is_alike(sorted[begin], sorted[end])) ++end;
  return end - begin;
}

// Matches draws that are alike, in their order, and keeps the others.
void match_alike(unmatched& left, std::span<std::uint32_t> draw_of_host, sightcell_draw_match& out) noexcept {
  std::sort(left.file.begin(), left.file.end(), comes_before);
  std::sort(left.host.begin(), left.host.end(), comes_before);
  std::size_t file = 0, host = 0, files_left = 0, hosts_left = 0;
  while (file < left.file.size() || host < left.host.size()) {
    const std::size_t of_file = alike(left.file, file);
    const std::size_t of_host = alike(left.host, host);
    const bool both = of_file > 0 && of_host > 0 && is_alike(left.file[file], left.host[host]);
    const bool file_first = of_host == 0 || (of_file > 0 && (both || comes_before(left.file[file], left.host[host])));
    const std::size_t pairs = both ? std::min(of_file, of_host) : 0;
    for (std::size_t i = 0; i < pairs; ++i) draw_of_host[left.host[host + i].number] = left.file[file + i].number;
    out.matched += static_cast<std::uint32_t>(pairs);
    if (both && (of_file > 1 || of_host > 1)) out.by_order += static_cast<std::uint32_t>(pairs);
    if (file_first) {
      for (std::size_t i = pairs; i < of_file; ++i) left.file[files_left++] = left.file[file + i];
      file += of_file;
    }
    if (both || !file_first) {
      for (std::size_t i = pairs; i < of_host; ++i) left.host[hosts_left++] = left.host[host + i];
      host += of_host;
    }
  }
  left = {left.file.first(files_left), left.host.first(hosts_left)};
}

void forget_names(std::span<known_draw> draws) noexcept {
  for (known_draw& d : draws) d.name = 0;
}

// The draws of the file with polygons. names: hashes of the names of the file; empty: names are not compared.
sightcell_status read_draws(const sightcell_db& db, const format::identity_table& table,
                            std::span<const std::uint64_t> names, std::span<known_draw> out) noexcept {
  std::size_t count = 0;
  for (std::uint32_t number = 0; number < db.file().draw_count(); ++number) {
    format::draw_record d;
    if (db.file().draw(number, d) != format::status::ok) return SIGHTCELL_ERR_CORRUPT;
    if (d.polygon_count == 0) continue;
    if (count == out.size()) return SIGHTCELL_ERR_CORRUPT;
    const std::uint32_t name = names.empty() ? 0 : table.name_of_node(d.node);
    out[count++] = {0, name == 0 ? 0 : names[name - 1], d.first_source, number};
  }
  if (count < out.size()) return SIGHTCELL_ERR_CORRUPT;
  std::sort(out.begin(), out.end(), [](const known_draw& a, const known_draw& b) { return a.order < b.order; });
  for (std::uint32_t place = 0; place < out.size(); ++place) out[place].hash = table.hash(place);
  return SIGHTCELL_OK;
}

// The draws of both sides and the hashes of the names of the file, in one block.
class match_memory {
 public:
  match_memory(const sightcell_allocator& mem, std::uint64_t draw_count, std::uint64_t name_count) noexcept
      : mem_(mem) {
    const auto carve = [&](void* block) {
      carver space(block);
      names = {space.take<std::uint64_t>(name_count), static_cast<std::size_t>(name_count)};
      draws = {space.take<known_draw>(draw_count), static_cast<std::size_t>(draw_count)};
      return space.used();
    };
    bytes_ = std::max<std::uint64_t>(carve(nullptr), 1);
    block_ = allocate(mem_, bytes_);
    if (block_ == nullptr) return;
    static_cast<void>(carve(block_));
    construct(names.data(), name_count);
    construct(draws.data(), draw_count);
  }
  ~match_memory() { release(mem_, block_, bytes_); }
  match_memory(const match_memory&) = delete;
  match_memory& operator=(const match_memory&) = delete;

  [[nodiscard]] bool is_there() const noexcept { return block_ != nullptr; }

  std::span<std::uint64_t> names;
  std::span<known_draw> draws;

 private:
  const sightcell_allocator& mem_;
  std::uint64_t bytes_ = 0;
  void* block_ = nullptr;
};

// Without draws of the hash 0.
std::span<known_draw> with_triangles(std::span<known_draw> draws) noexcept {
  const auto end = std::remove_if(draws.begin(), draws.end(), [](const known_draw& d) { return d.hash == 0; });
  return draws.first(static_cast<std::size_t>(end - draws.begin()));
}

std::uint32_t first_of(std::span<const known_draw> left) noexcept {
  const auto first = std::min_element(left.begin(), left.end(),
                                      [](const known_draw& a, const known_draw& b) { return a.order < b.order; });
  return first == left.end() ? SIGHTCELL_NO_DRAW : first->number;
}

}  // namespace

sightcell_status match_draws(const sightcell_db& db, const format::identity_table& table,
                             std::span<const std::uint64_t> hashes, const char* const* names,
                             std::span<std::uint32_t> draw_of_host, sightcell_draw_match& out) noexcept {
  const std::size_t drawn = table.draw_count();
  const match_memory memory(db.allocator(), std::uint64_t{drawn} + hashes.size(),
                            names == nullptr ? 0 : table.name_count());
  if (!memory.is_there()) return SIGHTCELL_ERR_MEMORY;
  format::name_walk walk = table.names();
  for (std::uint64_t& name : memory.names) {
    if (!walk.next()) return SIGHTCELL_ERR_CORRUPT;
    name = hash_of_name(walk.name());
  }
  unmatched left{memory.draws.first(drawn), memory.draws.subspan(drawn)};
  if (const sightcell_status s = read_draws(db, table, memory.names, left.file); s != SIGHTCELL_OK) return s;
  for (std::uint32_t i = 0; i < hashes.size(); ++i) {
    const bool named = names != nullptr && names[i] != nullptr;
    left.host[i] = {hashes[i], named ? hash_of_name(names[i]) : 0, i, i};
    draw_of_host[i] = SIGHTCELL_NO_DRAW;
  }
  left = {with_triangles(left.file), with_triangles(left.host)};
  out.matched = out.by_order = 0;
  match_alike(left, draw_of_host, out);
  forget_names(left.file);
  forget_names(left.host);
  match_alike(left, draw_of_host, out);
  out.missing = static_cast<std::uint32_t>(left.file.size());
  out.extra = static_cast<std::uint32_t>(left.host.size());
  out.first_missing = first_of(left.file);
  out.first_extra = first_of(left.host);
  return out.missing + out.extra == 0 ? SIGHTCELL_OK : SIGHTCELL_ERR_OTHER_SCENE;
}

sightcell_status place_in_source(const sightcell_db& db, const format::draw_record& draw, std::uint32_t& out) noexcept {
  out = 0;
  for (std::uint32_t number = 0; number < db.file().draw_count(); ++number) {
    format::draw_record other;
    if (db.file().draw(number, other) != format::status::ok) return SIGHTCELL_ERR_CORRUPT;
    out += other.polygon_count > 0 && other.first_source < draw.first_source ? 1 : 0;
  }
  return SIGHTCELL_OK;
}

}  // namespace sightcell::runtime
