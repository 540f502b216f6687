#pragma once
// The checkpoint of a bake: an SQLite file beside the output with one committed record per cell and stage.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cell_set/cell_record.h"

namespace sightcell::bake {

// Returns whether a record is stale: it is in the checkpoint that a bake takes over and does not belong to the bake.
using stale_record = std::function<bool(std::uint32_t cell, cell_stage)>;
// Decides whether a bake may take over a checkpoint with another key. Returns the test for stale records if it may,
// else nothing.
using stale_key_test = std::function<std::optional<stale_record>(const std::string& stored)>;

struct stage_record {
  std::uint32_t cell = 0;
  cell_stage stage = cell_stage::finished;
  cell_record record;
  double seconds = 0.0;  // that the step took: CPU time of its thread, or wall-clock time with a device. Not stored
};

class checkpoint {
 public:
  // Opens a checkpoint or creates it, and locks it.
  // key: names scene, settings, cells, device and version.
  // fresh: discards existing contents.
  // plan: stored with the key when the file is created (shards.h).
  // cells: the bytes of the cells of the bake (decided_cells.h), stored with the key.
  // take_over_test: called if the stored key differs. If it returns a test for stale records, the file takes this key
  //   and plan and loses its stale records.
  // Throws sightcell::error: "checkpoint.other-bake" if the key differs, "checkpoint.in-use" if another bake uses the
  // file, "checkpoint.damaged" if SQLite finds damage. A damaged file is never discarded without `fresh`.
  checkpoint(const std::filesystem::path& path, const std::string& key, bool fresh, std::string_view plan = {},
             std::string_view cells = {}, const stale_key_test& take_over_test = {});
  // Opens a file that no process writes any more, for reading and without a lock.
  static checkpoint open_to_read(const std::filesystem::path& path);
  // Returns the cells in the checkpoint of an unfinished bake, of any key: a bake needs its cells before it has a key.
  // Empty if there is no file, if it is of another version, or if its cells are damaged. Locks the file meanwhile.
  // Throws sightcell::error, as the constructor does, but not "checkpoint.other-bake".
  static std::string cells_in(const std::filesystem::path& path);
  ~checkpoint();
  checkpoint(checkpoint&&) noexcept;
  checkpoint(const checkpoint&) = delete;
  checkpoint& operator=(const checkpoint&) = delete;

  // Returns the key and the plan that are stored in the file.
  const std::string& key() const;
  std::string plan() const;
  // Returns the cells that are stored in the file; empty if there are none, or if they are damaged.
  std::string cells() const;

  // Reads all records and calls visit for each. Damaged records are dropped, so that the bake repeats their cells.
  // Returns the number of dropped records.
  std::uint32_t survey(const std::function<void(std::uint32_t cell, cell_stage, const cell_summary&)>& visit);

  // Returns a record, nothing if there is none. May be called from any thread, also while another thread is in store().
  std::optional<cell_record> load(std::uint32_t cell, cell_stage stage) const;
  // Stores records in one transaction, which is durable when the function returns.
  // forget: cells whose sampled records are deleted in the same transaction.
  // Throws sightcell::error, for example on a full disk. Then nothing is stored.
  void store(std::span<const stage_record> records, std::span<const std::uint32_t> forget = {});
  // Returns the number of records of a stage.
  std::uint32_t count(cell_stage stage) const;
  // Calls visit for all records without reading their contents. visit must not use this checkpoint.
  void list(const std::function<void(std::uint32_t cell, cell_stage)>& visit) const;

  // Writes a copy of everything that is committed. The copy is written under another name, flushed and renamed, so that
  // it is complete or absent.
  void copy_to(const std::filesystem::path& path) const;
  void remove();  // closes and deletes the file after the end of the bake

 private:
  struct state;
  explicit checkpoint(std::unique_ptr<state> opened);
  std::unique_ptr<state> state_;
};

// Returns the names of the settings in which two keys differ, for messages: "player_radius, samples". A key is text
// (scene, cells) followed by the settings as a JSON object. Returns an empty text if a key has another form.
std::string differing_names(const std::string& key, const std::string& other);

}  // namespace sightcell::bake
