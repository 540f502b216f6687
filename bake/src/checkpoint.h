#pragma once
// The resumable state of a bake: a SQLite file beside the output, one committed record per finished cell.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace sightcell::bake {

// All that is known of a finished cell.
struct cell_record {
  std::vector<std::uint32_t> set;  // ascending source ids
  bool stored = true;              // false: no free point was found, the cell is left out of the file
  std::uint64_t rays = 0;          // certificate: of the last fresh batch
  std::uint64_t misses = 0;
  double upper_bound = 1.0;
  double confidence = 0.0;
  std::uint64_t rays_spent = 0;  // of all ray work
  std::uint32_t samples = 0;     // hemicubes rendered
  bool bound_met = true;
  double seconds = 0.0;  // wall clock; several cells may have been in work at once; report only
  bool operator==(const cell_record&) const = default;
};

class checkpoint {
 public:
  // Opens or creates path. key names scene, settings, cells, device and version: a file with another key is refused
  // with sightcell::error "checkpoint.other-bake" (says what to do: --fresh or another output), a file that is in use
  // by another bake with "checkpoint.in-use". fresh: what is there is thrown away. A file that SQLite finds damaged is
  // refused by name, never silently dropped.
  checkpoint(const std::filesystem::path& path, const std::string& key, bool fresh);
  ~checkpoint();
  checkpoint(const checkpoint&) = delete;
  checkpoint& operator=(const checkpoint&) = delete;

  std::optional<cell_record> load(std::uint32_t cell) const;
  // One transaction, durable when it returns. Throws sightcell::error on a full disk.
  void store(std::uint32_t cell, const cell_record& record);
  std::uint32_t finished() const;  // number of records
  void remove();                   // closes and deletes the file; the bake is done

 private:
  struct state;
  std::unique_ptr<state> state_;
};

}  // namespace sightcell::bake
