#define ZSTD_STATIC_LINKING_ONLY  // for frames without a magic number
#include "bench/format_peers/peers.h"

#include <roaring/roaring.h>
#include <zdict.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <functional>
#include <stdexcept>

namespace sightcell::bench {
namespace {

constexpr int level = 19;

std::size_t good(std::size_t code) {
  if (ZSTD_isError(code) != 0) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(code));
  return code;
}

byte_rows pack_all(const byte_rows& rows, const std::string& dictionary = {}) {
  zstd_packer packer(dictionary);
  byte_rows packed;
  packed.reserve(rows.size());
  for (const std::string& row : rows) packed.push_back(packer.pack(row));
  return packed;
}

std::size_t longest(const byte_rows& rows) {
  std::size_t most = 0;
  for (const std::string& row : rows) most = std::max(most, row.size());
  return most;
}

std::string joined(const byte_rows& rows) {
  std::string all;
  all.reserve(size_of(rows));
  for (const std::string& row : rows) all += row;
  return all;
}

// None where there are too few rows to learn from. What training picks is completed once more for our level, which
// makes rows about 1 % smaller.
std::string train(const std::string& all, const std::vector<std::size_t>& sizes, std::size_t capacity) {
  const auto count = static_cast<unsigned>(sizes.size());
  std::string trained(capacity, 0), dictionary(capacity, 0);
  const std::size_t got = ZDICT_trainFromBuffer(trained.data(), capacity, all.data(), sizes.data(), count);
  if (ZDICT_isError(got) != 0) return {};
  const std::size_t head = ZDICT_getDictHeaderSize(trained.data(), got);
  ZDICT_params_t how{};
  how.compressionLevel = level;
  const std::size_t size = ZDICT_finalizeDictionary(dictionary.data(), capacity, trained.data() + head, got - head,
                                                    all.data(), sizes.data(), count, how);
  if (ZDICT_isError(size) != 0) return {};
  dictionary.resize(size);
  return dictionary;
}

void pack_with_best_dictionary(peer_rows& peers) {
  const std::string all = joined(peers.varint);
  std::vector<std::size_t> sizes;
  for (const std::string& row : peers.varint) sizes.push_back(row.size());
  for (const std::size_t kib : {0, 16, 64, 112, 256, 1024}) {
    std::string dictionary;
    if (kib != 0) {
      dictionary = train(all, sizes, kib << 10);
      if (dictionary.empty()) continue;
    }
    byte_rows rows = pack_all(peers.varint, dictionary);
    peers.tries.push_back({dictionary.size(), size_of(rows)});
    if (kib == 0 || size_of(rows) + dictionary.size() < size_of(peers.varint_dictionary) + peers.dictionary.size()) {
      peers.varint_dictionary = std::move(rows);
      peers.dictionary = std::move(dictionary);
    }
  }
}

whole_file pack_whole(const byte_rows& rows, const char* name) {
  const std::string all = joined(rows);
  whole_file best;
  std::string back(all.size(), 0);
  for (const bool far : {false, true}) {
    zstd_packer packer({}, far ? zstd_packer::window::whole_file_long : zstd_packer::window::whole_file);
    const std::string packed = packer.pack(all);
    zstd_unpacker unpacker;
    back.assign(all.size(), 0);
    if (unpacker.unpack(packed, back.data(), back.size()) != all.size() || back != all)
      throw std::runtime_error(std::string(name) + ": comes back different");
    if (best.bytes == 0 || packed.size() < best.bytes) best = {packed.size(), far};
  }
  return best;
}

void check(const corpus& of, const char* peer,
           const std::function<void(std::size_t cell, std::vector<std::uint32_t>& ids)>& ids_of) {
  std::vector<std::uint32_t> expected, ids;
  for (std::size_t cell = 0; cell < of.runs.size(); ++cell) {
    expand(of.runs[cell], expected);
    ids.assign(of.most_polygons, 0);
    ids_of(cell, ids);
    if (ids != expected) throw std::runtime_error(std::string(peer) + ": cell " + std::to_string(cell) + " differs");
  }
}

void check_all(const corpus& of, const peer_rows& peers) {
  std::string room(std::max(longest(peers.roaring), longest(peers.varint)) + 1, 0);
  std::vector<id_run> runs(of.most_polygons);
  const auto roaring = [](const char* row, std::size_t size, std::vector<std::uint32_t>& ids) {
    ids.resize(unpack_roaring(row, size, ids.data()));
  };
  const auto varint = [&](const char* row, std::size_t size, std::vector<std::uint32_t>& ids) {
    expand({runs.data(), unpack_varints(row, size, runs.data())}, ids);
  };
  check(of, "roaring",
        [&](std::size_t cell, auto& ids) { roaring(peers.roaring[cell].data(), peers.roaring[cell].size(), ids); });
  zstd_unpacker plain, with_dictionary(peers.dictionary);
  check(of, "roaring_zstd", [&](std::size_t cell, auto& ids) {
    roaring(room.data(), plain.unpack(peers.roaring_zstd[cell], room.data(), room.size()), ids);
  });
  check(of, "varint",
        [&](std::size_t cell, auto& ids) { varint(peers.varint[cell].data(), peers.varint[cell].size(), ids); });
  check(of, "varint_zstd_dictionary", [&](std::size_t cell, auto& ids) {
    varint(room.data(), with_dictionary.unpack(peers.varint_dictionary[cell], room.data(), room.size()), ids);
  });
}

void put_varint(std::string& bytes, std::uint32_t value) {
  for (; value >= 128; value >>= 7) bytes.push_back(static_cast<char>(value | 128));
  bytes.push_back(static_cast<char>(value));
}

inline std::uint32_t take_varint(const unsigned char*& at) {
  std::uint32_t value = *at++;
  if (value < 128) return value;
  value &= 127;
  for (unsigned shift = 7;; shift += 7) {
    const std::uint32_t next = *at++;
    value |= (next & 127) << shift;
    if (next < 128) return value;
  }
}

}  // namespace

std::uint64_t size_of(const byte_rows& rows) {
  std::uint64_t sum = 0;
  for (const std::string& row : rows) sum += row.size();
  return sum;
}

std::string pack_roaring(std::span<const id_run> runs) {
  const std::unique_ptr<roaring_bitmap_t, void (*)(roaring_bitmap_t*)> bitmap(
      roaring_bitmap_create(), [](roaring_bitmap_t* of) { roaring_bitmap_free(of); });
  for (const id_run& run : runs)
    roaring_bitmap_add_range(bitmap.get(), run.first, std::uint64_t{run.first} + run.count);
  roaring_bitmap_run_optimize(bitmap.get());
  std::string row(roaring_bitmap_portable_size_in_bytes(bitmap.get()), 0);
  roaring_bitmap_portable_serialize(bitmap.get(), row.data());
  return row;
}

std::size_t unpack_roaring(const char* row, std::size_t size, std::uint32_t* dst) {
  roaring_bitmap_t* bitmap = roaring_bitmap_portable_deserialize_safe(row, size);
  if (bitmap == nullptr) throw std::runtime_error("CRoaring refuses its own bytes");
  const std::size_t count = roaring_bitmap_get_cardinality(bitmap);
  roaring_bitmap_to_uint32_array(bitmap, dst);
  roaring_bitmap_free(bitmap);
  return count;
}

std::string pack_varints(std::span<const id_run> runs) {
  std::string row;
  std::uint32_t end = 0;
  for (const id_run& run : runs) {
    put_varint(row, run.first - end);
    put_varint(row, run.count - 1);
    end = run.first + run.count;
  }
  return row;
}

std::size_t unpack_varints(const char* row, std::size_t size, id_run* dst) {
  const auto* at = reinterpret_cast<const unsigned char*>(row);
  const auto* const end = at + size;
  id_run* const begin = dst;
  for (std::uint32_t next = 0; at < end; ++dst) {
    const std::uint32_t first = next + take_varint(at);
    const std::uint32_t count = take_varint(at) + 1;
    *dst = {first, count};
    next = first + count;
  }
  return static_cast<std::size_t>(dst - begin);
}

void free_zstd::operator()(ZSTD_CCtx_s* context) const {
  ZSTD_freeCCtx(context);
}
void free_zstd::operator()(ZSTD_DCtx_s* context) const {
  ZSTD_freeDCtx(context);
}
void free_zstd::operator()(ZSTD_DDict_s* dictionary) const {
  ZSTD_freeDDict(dictionary);
}

zstd_packer::zstd_packer(const std::string& dictionary, window size) : context_(ZSTD_createCCtx()) {
  const auto set = [this](ZSTD_cParameter what, int value) {
    good(ZSTD_CCtx_setParameter(context_.get(), what, value));
  };
  set(ZSTD_c_compressionLevel, level);
  set(ZSTD_c_format, ZSTD_f_zstd1_magicless);
  set(ZSTD_c_dictIDFlag, 0);
  if (size != window::usual) set(ZSTD_c_windowLog, 27);
  if (size == window::whole_file_long) set(ZSTD_c_enableLongDistanceMatching, 1);
  if (!dictionary.empty()) good(ZSTD_CCtx_loadDictionary(context_.get(), dictionary.data(), dictionary.size()));
}

std::string zstd_packer::pack(const std::string& bytes) {
  std::string frame(ZSTD_compressBound(bytes.size()), 0);
  frame.resize(good(ZSTD_compress2(context_.get(), frame.data(), frame.size(), bytes.data(), bytes.size())));
  frame.shrink_to_fit();
  return frame;
}

zstd_unpacker::zstd_unpacker(const std::string& dictionary) : context_(ZSTD_createDCtx()) {
  good(ZSTD_DCtx_setParameter(context_.get(), ZSTD_d_format, ZSTD_f_zstd1_magicless));
  if (dictionary.empty()) return;
  dictionary_.reset(ZSTD_createDDict(dictionary.data(), dictionary.size()));
  good(ZSTD_DCtx_refDDict(context_.get(), dictionary_.get()));
}

std::size_t zstd_unpacker::unpack(const std::string& frame, char* dst, std::size_t capacity) {
  return good(ZSTD_decompressDCtx(context_.get(), dst, capacity, frame.data(), frame.size()));
}

peer_rows pack_peers(const corpus& of) {
  peer_rows peers;
  for (const std::vector<id_run>& runs : of.runs) {
    peers.roaring.push_back(pack_roaring(runs));
    peers.varint.push_back(pack_varints(runs));
  }
  peers.roaring_zstd = pack_all(peers.roaring);
  pack_with_best_dictionary(peers);
  check_all(of, peers);
  peers.varint_whole = pack_whole(peers.varint, "varint_zstd_whole");
  peers.roaring_whole = pack_whole(peers.roaring, "roaring_zstd_whole");
  return peers;
}

}  // namespace sightcell::bench
