#pragma once
// A streamed scene of a test's own: its front, chunks and other files as bytes.
#include <sha2.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "sightcell/stream.h"

namespace sightcell::test {

using bytes = std::vector<std::uint8_t>;

// Writes columns (docs/streaming.md, "Numbers and columns").
struct column_writer {
  bytes out;

  void varint(std::uint32_t value) {
    for (; value > 127; value >>= 7) out.push_back(static_cast<std::uint8_t>(value | 128u));
    out.push_back(static_cast<std::uint8_t>(value));
  }
  void varints(const std::vector<std::uint32_t>& values) {
    for (const std::uint32_t value : values) varint(value);
  }
  void deltas(const std::vector<std::uint32_t>& values) {
    std::int64_t before = 0;
    for (const std::uint32_t value : values) {
      const std::int64_t step = value - before;
      varint(static_cast<std::uint32_t>(step >= 0 ? 2 * step : -2 * step - 1));
      before = value;
    }
  }
  void gaps(const std::vector<std::uint32_t>& values) {
    for (std::size_t i = 0; i < values.size(); ++i) varint(i == 0 ? values[0] : values[i] - values[i - 1] - 1);
  }
  void floats(const std::vector<float>& values) {
    for (int plane = 0; plane < 4; ++plane)
      for (const float value : values)
        out.push_back(static_cast<std::uint8_t>(std::bit_cast<std::uint32_t>(value) >> (8 * plane)));
  }
  void raw(const bytes& more) { out.insert(out.end(), more.begin(), more.end()); }
};

inline void put_u32(bytes& out, std::uint32_t value) {
  for (int k = 0; k < 4; ++k) out.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
}

inline bytes deflated(const bytes& payload) {
  uLongf size = compressBound(payload.size());
  bytes out(size);
  if (compress(out.data(), &size, payload.data(), payload.size()) != Z_OK) throw std::runtime_error("zlib");
  out.resize(size);
  return out;
}

inline bytes hash_of_file(const bytes& file) {
  std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest;
  SHA2_CTX context;
  SHA256Init(&context);
  SHA256Update(&context, file.data(), file.size());
  SHA256Final(digest.data(), &context);
  return {digest.begin(), digest.begin() + 8};
}

template <class List, class Get>
auto column(const List& list, const Get& get) {
  std::vector<std::decay_t<decltype(get(list[0]))>> out;
  for (const auto& item : list) out.push_back(get(item));
  return out;
}

using box6 = std::array<float, 6>;  // min, max

struct small_page {
  std::uint32_t bytes = 100;
  std::array<std::uint8_t, 6> box{0, 0, 0, 255, 255, 255};
};

struct listed {
  std::uint32_t number = 0;
  std::uint8_t share = 0;
  std::uint8_t headings = 255;
};

struct small_cell {
  std::uint32_t number = 0;
  box6 box{};
  std::vector<listed> pages;
  std::vector<std::array<std::uint32_t, 2>> runs;  // first draw, draws
  std::vector<listed> images;
  float weight = 4.0f;
};

struct small_stream {
  std::array<std::uint8_t, 16> fingerprint{1, 2, 3};
  box6 box{0, 0, 0, 255, 255, 255};
  std::string json = R"({"asset":{"version":"2.0"}})";
  std::vector<std::uint32_t> geometries{2};  // polygons
  std::vector<sightcell_stream_draw> draws;
  std::vector<small_page> pages;
  std::vector<std::vector<std::uint32_t>> images;  // bytes of each file, the smallest version first
  std::vector<std::vector<small_cell>> chunks;
  std::vector<std::uint32_t> pages_everywhere, images_everywhere;

  void add_draw(std::uint32_t flags = 0) {
    sightcell_stream_draw d{};
    d.material = d.object = 0xFFFFFFFFu;
    d.flags = flags;
    d.matrix[0] = d.matrix[4] = d.matrix[8] = 1.0f;
    draws.push_back(d);
  }

  // The contents of files that the library does not read.
  [[nodiscard]] bytes page_file(std::size_t page) const { return filled(pages[page].bytes, 'p', page); }
  [[nodiscard]] bytes image_file(std::size_t image, std::size_t version) const {
    return filled(images[image][version], 'i', 100 * image + version);
  }
  [[nodiscard]] bytes file(std::uint32_t number) const {
    if (number < chunks.size()) return chunk_file(number);
    number -= static_cast<std::uint32_t>(chunks.size());
    if (number < pages.size()) return page_file(number);
    number -= static_cast<std::uint32_t>(pages.size());
    for (std::size_t image = 0;; number -= static_cast<std::uint32_t>(images[image++].size()))
      if (number < images[image].size()) return image_file(image, number);
  }
  [[nodiscard]] std::uint32_t page(std::uint32_t number) const {
    return static_cast<std::uint32_t>(chunks.size()) + number;
  }
  [[nodiscard]] std::uint32_t image(std::uint32_t number, std::uint32_t version = 0) const {
    std::uint32_t file = page(static_cast<std::uint32_t>(pages.size())) + version;
    for (std::uint32_t i = 0; i < number; ++i) file += static_cast<std::uint32_t>(images[i].size());
    return file;
  }

  [[nodiscard]] bytes chunk_payload(std::size_t chunk) const {
    const std::vector<small_cell>& cells = chunks[chunk];
    column_writer w;
    w.varint(static_cast<std::uint32_t>(cells.size()));
    w.deltas(column(cells, [](const small_cell& c) { return c.number; }));
    for (std::size_t k = 0; k < 6; ++k) w.floats(column(cells, [k](const small_cell& c) { return c.box[k]; }));
    w.floats(column(cells, [](const small_cell& c) { return c.weight; }));
    put_lists(w, cells, &small_cell::pages);
    for (const small_cell& cell : cells)
      for (const listed& page : cell.pages) w.out.push_back(page.headings);
    for (const small_cell& cell : cells) w.varint(static_cast<std::uint32_t>(cell.runs.size()));
    for (const small_cell& cell : cells) {
      std::uint32_t end = 0;
      for (const auto& [first, count] : cell.runs) {
        w.varint(first - end);
        w.varint(count - 1);
        end = first + count;
      }
    }
    put_lists(w, cells, &small_cell::images);
    return w.out;
  }
  [[nodiscard]] bytes chunk_file(std::size_t chunk) const { return as_chunk(chunk_payload(chunk)); }
  [[nodiscard]] static bytes as_chunk(const bytes& payload) {
    bytes out;
    put_u32(out, static_cast<std::uint32_t>(payload.size()));
    const bytes packed = deflated(payload);
    out.insert(out.end(), packed.begin(), packed.end());
    return out;
  }

  // replaced: the bytes of a chunk that differ from those of chunk_file.
  [[nodiscard]] bytes front_payload(const std::vector<bytes>& replaced = {}) const {
    column_writer w;
    w.raw({fingerprint.begin(), fingerprint.end()});
    std::uint32_t polygons = 0, image_files = 0, cells = 0;
    for (const auto& d : draws) polygons += geometries.at(d.geometry);
    for (const auto& image : images) image_files += static_cast<std::uint32_t>(image.size());
    for (const auto& chunk : chunks) cells += static_cast<std::uint32_t>(chunk.size());
    for (const std::size_t count : {std::size_t{polygons}, geometries.size(), draws.size(), pages.size(), images.size(),
                                    std::size_t{image_files}, chunks.size(), std::size_t{cells}, json.size()})
      w.varint(static_cast<std::uint32_t>(count));
    w.floats({box.begin(), box.end()});
    w.raw({json.begin(), json.end()});
    w.varints(geometries);
    put_draws(w);
    w.varints(column(pages, [](const small_page& p) { return p.bytes; }));
    for (std::size_t i = 0; i < pages.size(); ++i) w.raw(hash_of_file(page_file(i)));
    for (std::size_t k = 0; k < 6; ++k)
      for (const small_page& page : pages) w.out.push_back(page.box[k]);
    put_images(w, image_files);
    put_chunks(w, replaced);
    w.varint(static_cast<std::uint32_t>(pages_everywhere.size()));
    w.gaps(pages_everywhere);
    w.varint(static_cast<std::uint32_t>(images_everywhere.size()));
    w.gaps(images_everywhere);
    return w.out;
  }
  [[nodiscard]] bytes front(const std::vector<bytes>& replaced = {}) const { return as_front(front_payload(replaced)); }
  [[nodiscard]] static bytes as_front(const bytes& payload) {
    bytes out = {'S', 'I', 'G', 'H', 'T', 'F', 'R', 'T'};
    put_u32(out, 1);
    put_u32(out, static_cast<std::uint32_t>(payload.size()));
    const bytes packed = deflated(payload);
    out.insert(out.end(), packed.begin(), packed.end());
    return out;
  }

 private:
  static bytes filled(std::size_t size, char kind, std::size_t number) {
    bytes out(size, static_cast<std::uint8_t>(kind));
    out.at(0) = static_cast<std::uint8_t>(number);
    return out;
  }
  static void put_lists(column_writer& w, const std::vector<small_cell>& cells, std::vector<listed> small_cell::*list) {
    for (const small_cell& cell : cells) w.varint(static_cast<std::uint32_t>((cell.*list).size()));
    for (const small_cell& cell : cells) w.gaps(column(cell.*list, [](const listed& l) { return l.number; }));
    for (const small_cell& cell : cells)
      for (const listed& l : cell.*list) w.out.push_back(l.share);
  }
  void put_draws(column_writer& w) const {
    using draw = sightcell_stream_draw;
    w.deltas(column(draws, [](const draw& d) { return d.geometry; }));
    w.varints(column(draws, [](const draw& d) { return d.material + 1; }));
    w.varints(column(draws, [](const draw& d) { return d.flags; }));
    w.varints(column(draws, [](const draw& d) { return d.object + 1; }));
    w.varints(column(draws, [](const draw& d) { return d.level; }));
    w.deltas(column(draws, [](const draw& d) { return d.node; }));
    w.deltas(column(draws, [](const draw& d) { return d.mesh; }));
    w.deltas(column(draws, [](const draw& d) { return d.instance; }));
    w.varints(column(draws, [](const draw& d) { return d.primitive; }));
    for (std::size_t k = 0; k < 12; ++k) w.floats(column(draws, [k](const draw& d) { return d.matrix[k]; }));
  }
  void put_images(column_writer& w, std::uint32_t files) const {
    w.varints(column(images, [](const auto& i) { return static_cast<std::uint32_t>(i.size()); }));
    for (int side = 0; side < 2; ++side)
      for (const auto& image : images)
        for (std::uint32_t version = 0; version < image.size(); ++version) w.varint(16u << version);
    for (const auto& image : images) w.varints(image);
    w.raw(bytes(files, std::uint8_t{SIGHTCELL_STREAM_WEBP}));
    for (std::size_t i = 0; i < images.size(); ++i)
      for (std::size_t version = 0; version < images[i].size(); ++version) w.raw(hash_of_file(image_file(i, version)));
  }
  void put_chunks(column_writer& w, const std::vector<bytes>& replaced) const {
    const auto chunk = [&](std::size_t i) { return i < replaced.size() ? replaced[i] : chunk_file(i); };
    for (std::size_t i = 0; i < chunks.size(); ++i) w.varint(static_cast<std::uint32_t>(chunk(i).size()));
    for (const auto& cells : chunks) w.varint(static_cast<std::uint32_t>(cells.size()));
    for (std::size_t i = 0; i < chunks.size(); ++i) w.raw(hash_of_file(chunk(i)));
    for (std::size_t k = 0; k < 6; ++k)
      w.floats(column(chunks, [k](const auto& cells) {
        float out = cells.at(0).box[k];
        for (const small_cell& cell : cells) out = k < 3 ? std::min(out, cell.box[k]) : std::max(out, cell.box[k]);
        return out;
      }));
  }
};

// Owns a scene and one view of it.
class open_stream {
 public:
  explicit open_stream(const small_stream& content, std::uint64_t chunk_memory = 1 << 20,
                       const sightcell_allocator* mem = nullptr)
      : content_(content) {
    const bytes front = content.front();
    status = sightcell_stream_open(front.data(), front.size(), chunk_memory, mem, &stream);
    if (status == SIGHTCELL_OK) status = sightcell_stream_view_create(stream, &view);
  }
  ~open_stream() {
    sightcell_stream_view_destroy(view);
    sightcell_stream_close(stream);
  }
  open_stream(const open_stream&) = delete;
  open_stream& operator=(const open_stream&) = delete;

  sightcell_stream_frame move(float x, float y, float z) {
    pose.eye[0] = x, pose.eye[1] = y, pose.eye[2] = z;
    sightcell_stream_frame frame;
    if (sightcell_stream_view_move(view, &pose, &frame) != SIGHTCELL_OK) throw std::runtime_error("move");
    return frame;
  }
  std::vector<sightcell_stream_request> requests(float seconds = 0.0f, std::size_t capacity = 64) const {
    std::vector<sightcell_stream_request> out(capacity);
    std::size_t count = 0;
    if (sightcell_stream_view_requests(view, seconds, out.data(), capacity, &count) != SIGHTCELL_OK)
      throw std::runtime_error("requests");
    out.resize(count);
    return out;
  }
  std::vector<std::uint32_t> requested_files(float seconds = 0.0f) const {
    std::vector<std::uint32_t> out;
    for (const sightcell_stream_request& r : requests(seconds)) out.push_back(r.file);
    return out;
  }
  // Everything that a host does with a file that has arrived.
  void load(std::uint32_t file) const {
    const bytes content = content_.file(file);
    if (sightcell_stream_deliver(stream, file, content.data(), content.size()) != SIGHTCELL_OK)
      throw std::runtime_error("deliver");
    if (file >= content_.chunks.size()) set(file, SIGHTCELL_STREAM_PRESENT);
  }
  void set(std::uint32_t file, std::uint32_t state) const {
    if (sightcell_stream_set_state(stream, file, state) != SIGHTCELL_OK) throw std::runtime_error("state");
  }
  std::vector<std::uint32_t> draws() const {
    std::uint64_t words[4] = {~0ull, ~0ull, ~0ull, ~0ull};
    if (sightcell_stream_view_draws(view, words, 4) != SIGHTCELL_OK) throw std::runtime_error("draws");
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < 256; ++i)
      if ((words[i / 64] >> i % 64 & 1) != 0) out.push_back(i);
    return out;
  }
  std::vector<std::uint32_t> removable(std::size_t capacity = 64) const {
    std::vector<std::uint32_t> out(capacity);
    std::size_t count = 0;
    if (sightcell_stream_removable(stream, out.data(), capacity, &count) != SIGHTCELL_OK)
      throw std::runtime_error("removable");
    out.resize(count);
    return out;
  }

  sightcell_status status = SIGHTCELL_OK;
  sightcell_stream* stream = nullptr;
  sightcell_stream_view* view = nullptr;
  sightcell_stream_pose pose{};

 private:
  const small_stream& content_;
};

// Four rooms of 10 m in a row along x, with a page each and one more that both neighbors see; two chunks of two rooms;
// an image per chunk.
inline small_stream four_rooms() {
  small_stream s;
  s.box = {0, 0, 0, 51, 51, 51};  // so steps of page boxes are 0.2 m
  for (int i = 0; i < 5; ++i) s.add_draw();
  for (std::uint8_t i = 0; i < 4; ++i) {
    const auto x = static_cast<std::uint8_t>(50 * i);
    s.pages.push_back({100u + i, {x, 0, 0, static_cast<std::uint8_t>(x + 50), 50, 50}});
  }
  s.images = {{10, 40, 160}, {20}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    const auto x = static_cast<float>(10 * i);
    small_cell cell{i, {x, 0, 0, x + 10, 10, 10}, {{i, 0}}, {{i, 1}}, {{i / 2, 8}}};
    if (i > 0) cell.pages.insert(cell.pages.begin(), {i - 1, 16});
    if (i > 0) cell.runs = {{i - 1, 2}};
    if (i % 2 == 0) s.chunks.emplace_back();
    s.chunks.back().push_back(cell);
  }
  return s;
}

}  // namespace sightcell::test
