#pragma once
// The resumable state of a bake: a SQLite file beside the output, one committed record per cell and stage.
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

// Is a record none of a bake's, though it is in the file that the bake goes on with?
using stale_record = std::function<bool(std::uint32_t cell, cell_stage)>;
// May a bake go on with a file of another key? Then which of its records are not the bake's; nothing: it may not.
using stale_key_test = std::function<std::optional<stale_record>(const std::string& stored)>;

struct stage_record {
  std::uint32_t cell = 0;
  cell_stage stage = cell_stage::finished;
  cell_record record;
};

class checkpoint {
 public:
  // Opens or creates path. key names scene, settings, cells, device and version: a file with another key is refused
  // with sightcell::error "checkpoint.other-bake" (says what to do: --fresh or another output), a file that is in use
  // by another bake with "checkpoint.in-use". fresh: what is there is thrown away. A file that SQLite finds damaged is
  // refused by name, never silently dropped. plan: kept with the file when it is created, see shards.h. judge: asked of
  // another key; where it says so the file becomes one of this key and plan, without the records that are stale.
  checkpoint(const std::filesystem::path& path, const std::string& key, bool fresh, std::string_view plan = {},
             const stale_key_test& judge = {});
  // Opens a file that nobody changes any more, to read it.
  static checkpoint open_to_read(const std::filesystem::path& path);
  ~checkpoint();
  checkpoint(checkpoint&&) noexcept;
  checkpoint(const checkpoint&) = delete;
  checkpoint& operator=(const checkpoint&) = delete;

  const std::string& key() const;
  std::string plan() const;

  // Reads all of it, tells of each record, and drops those that are damaged: their cells are baked again. Returns how
  // many those were.
  std::uint32_t survey(const std::function<void(std::uint32_t cell, cell_stage, const cell_summary&)>& visit);

  // Nothing where there is none. May be called from any thread, also while store runs on another one.
  std::optional<cell_record> load(std::uint32_t cell, cell_stage stage) const;
  // All in one transaction, durable when it returns. The sampled records of forget are dropped in it. Throws
  // sightcell::error on a full disk: then nothing of it is stored.
  void store(std::span<const stage_record> records, std::span<const std::uint32_t> forget = {});
  std::uint32_t count(cell_stage stage) const;
  // Tells of all records, unread. visit must not ask this checkpoint for anything.
  void list(const std::function<void(std::uint32_t cell, cell_stage)>& visit) const;

  // A copy of all that is committed, complete under its name or not there at all: written beside it, flushed, renamed.
  void copy_to(const std::filesystem::path& path) const;
  void remove();  // closes and deletes the file; the bake is done

 private:
  struct state;
  explicit checkpoint(std::unique_ptr<state> opened);
  std::unique_ptr<state> state_;
};

// Names of the settings in which two keys differ, for people: "player_radius, samples"; empty where they cannot be
// told.
std::string differing_names(const std::string& key, const std::string& other);

}  // namespace sightcell::bake
