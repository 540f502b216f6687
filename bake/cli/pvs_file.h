#pragma once
// A .pvs file held in memory, with errors that name it.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/scene/animated_as.h"

namespace sightcell::cli {

class pvs_file {
 public:
  // Nothing when the file does not begin like a .pvs file and is not called one. Throws sightcell::error (bad_input)
  // when it cannot be read or is damaged.
  static std::optional<pvs_file> open_if_pvs(const std::filesystem::path& path);
  // Throws as well when it is no .pvs file.
  static pvs_file open(const std::filesystem::path& path);
  // The same; of a .glb or .gltf the .pvs file that it contains or names (bake --embed). For commands that only read.
  // Throws as well when it has none.
  static pvs_file open_or_embedded(const std::filesystem::path& path);

  // Of bytes that are in memory. path: for messages.
  static pvs_file of_bytes(const std::filesystem::path& path, std::vector<std::byte> bytes);

  const format::reader& content() const { return reader_; }
  std::span<const std::byte> bytes() const { return bytes_; }
  std::uint64_t size() const { return bytes_.size(); }
  format::row_statistics statistics() const;
  format::set_reader sets() const;                 // views the file
  format::box cell_box(std::uint32_t cell) const;  // of a cell that there is
  scene::animated_as animated() const;             // what it was baked with
  std::string_view metric() const;                 // of what error its bounds are, as --metric has it
  // The bound that the bake was asked for; that of the default quality where the settings text has none.
  double requested_bound() const;
  int scene() const;  // the glTF scene that it was baked from; -1: the default one
  std::vector<std::uint32_t> cell_set(std::uint32_t cell) const;  // ascending source ids

  // Throws where something that was asked of the file is not ok.
  void check(format::status status) const;

 private:
  pvs_file(std::filesystem::path path, std::vector<std::byte> bytes);

  std::filesystem::path path_;
  std::vector<std::byte> bytes_;  // heap memory: the reader's views stay valid when the object moves
  format::reader reader_;
};

}  // namespace sightcell::cli
