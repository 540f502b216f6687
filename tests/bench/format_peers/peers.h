#pragma once
// What else cell sets could be stored as: CRoaring bitmaps and runs as varints, with zstd and without. Rows have no
// offsets: what finds a cell's row is not counted.
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/format_peers/corpus.h"

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;
struct ZSTD_DDict_s;

namespace sightcell::bench {

using byte_rows = std::vector<std::string>;  // one per cell
std::uint64_t size_of(const byte_rows& rows);

// Run-optimized, portable serialization.
std::string pack_roaring(std::span<const id_run> runs);
// The ids of such a row, into dst; how many. Checks the row as CRoaring does where it is not trusted.
std::size_t unpack_roaring(const char* row, std::size_t size, std::uint32_t* dst);

// For each run what is left out before it and its length less one, 7 bits per byte.
std::string pack_varints(std::span<const id_run> runs);
// The runs of such a row, into dst; how many. Checks nothing.
std::size_t unpack_varints(const char* row, std::size_t size, id_run* dst);

struct free_zstd {
  void operator()(ZSTD_CCtx_s* context) const;
  void operator()(ZSTD_DCtx_s* context) const;
  void operator()(ZSTD_DDict_s* dictionary) const;
};

// Level 19. Frames have no magic number and no dictionary's number: 4 bytes each that a file of many rows does not
// need.
class zstd_packer {
 public:
  enum class window { usual, whole_file, whole_file_long };  // whole_file: 2^27 bytes; long: long distance matching
  explicit zstd_packer(const std::string& dictionary = {}, window size = window::usual);
  std::string pack(const std::string& bytes);

 private:
  std::unique_ptr<ZSTD_CCtx_s, free_zstd> context_;
};

class zstd_unpacker {
 public:
  explicit zstd_unpacker(const std::string& dictionary = {});
  std::size_t unpack(const std::string& frame, char* dst, std::size_t capacity);

 private:
  std::unique_ptr<ZSTD_DCtx_s, free_zstd> context_;
  std::unique_ptr<ZSTD_DDict_s, free_zstd> dictionary_;
};

struct dictionary_try {
  std::size_t dictionary;  // bytes; 0: none
  std::uint64_t rows;      // bytes of all rows with it
};

struct whole_file {
  std::uint64_t bytes = 0;
  bool long_distance = false;  // was smaller with it
};

// All of them over a corpus.
struct peer_rows {
  byte_rows roaring, roaring_zstd, varint, varint_dictionary;
  std::string dictionary;  // that with which it and the rows are smallest together; may be none
  std::vector<dictionary_try> tries;
  whole_file varint_whole, roaring_whole;
};

// Packs, unpacks again and compares: throws std::runtime_error with the name of a peer that gives other ids.
peer_rows pack_peers(const corpus& of);

}  // namespace sightcell::bench
