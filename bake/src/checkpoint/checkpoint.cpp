#include "checkpoint/checkpoint.h"

#include <fmt/format.h>
#include <sqlite3.h>
#include <xxhash.h>

#include <cstring>
#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>

#include "sightcell/base/disk.h"
#include "sightcell/base/error.h"
#include "sightcell/base/json_text.h"

// Reasons for the settings of SQLite:
// On a local disk it keeps a write-ahead log, because a commit is then one flush instead of three. Closing the file
// moves the log into it, so a bake that is not killed leaves one file. On a network disk it keeps a rollback journal,
// because a log requires more of a disk than network disks guarantee. After a kill, the next open rolls the journal
// back or applies the log.
// synchronous=FULL: records are on the disk when store() returns.
// locking_mode=EXCLUSIVE: the lock is held while the bake runs, and the system drops it when the process ends, however
// it ends.

namespace sightcell::bake {

namespace {

constexpr int application_id = 0x53434B31;  // "SCK1": distinguishes our files from other databases
constexpr int schema_version = 6;

struct finalize_statement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using statement = std::unique_ptr<sqlite3_stmt, finalize_statement>;

// Returns a path in the form that a URI needs.
std::string escaped(const std::string& path) {
  std::string out;
  for (const char c : path) {
    if (c == '%' || c == '?' || c == '#')
      out += fmt::format("%{:02X}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out;
}

constexpr const char* fresh_remedy = "start over with --fresh, or choose another -o";

constexpr std::int64_t stage_count = 3;

std::int64_t number_of(std::uint32_t cell, cell_stage stage) {
  return stage_count * cell + static_cast<std::int64_t>(stage);
}

std::span<const std::uint8_t> blob(sqlite3_stmt* row, int column) {
  const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(row, column));
  return {bytes, static_cast<std::size_t>(sqlite3_column_bytes(row, column))};
}

// The checksum of a record does not cover its row number: a flipped bit there would make it the record of another cell.
// So a seal, a hash of bytes and number, follows the record.
std::uint64_t seal_of(std::span<const std::uint8_t> bytes, std::int64_t number) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), static_cast<std::uint64_t>(number));
}

constexpr std::size_t seal_size = 8;

std::vector<std::uint8_t> sealed(std::vector<std::uint8_t> bytes, std::int64_t number) {
  const std::uint64_t seal = seal_of(bytes, number);
  for (std::size_t i = 0; i < seal_size; ++i) bytes.push_back(static_cast<std::uint8_t>(seal >> (8 * i)));
  return bytes;
}

std::optional<std::span<const std::uint8_t>> unsealed(std::span<const std::uint8_t> bytes, std::int64_t number) {
  if (bytes.size() < seal_size) return std::nullopt;
  const auto body = bytes.first(bytes.size() - seal_size);
  std::uint64_t seal = 0;
  for (std::size_t i = 0; i < seal_size; ++i) seal |= std::uint64_t{bytes[body.size() + i]} << (8 * i);
  if (seal != seal_of(body, number)) return std::nullopt;
  return body;
}

// What the seal of the cells has as its number, which no record has.
constexpr std::int64_t number_of_cells = -1;

std::int64_t seal_of_key(std::string_view key, std::string_view plan) {
  std::string both(key);
  both.append(1, '\0').append(plan);
  return static_cast<std::int64_t>(XXH3_64bits(both.data(), both.size()));
}

}  // namespace

std::string differing_names(const std::string& a, const std::string& b) {
  using nlohmann::json;
  const std::size_t begin_a = a.find('{'), begin_b = b.find('{');
  if (begin_a == std::string::npos || begin_b == std::string::npos) return {};
  const json left = scene::parse_json(a.substr(begin_a), false), right = scene::parse_json(b.substr(begin_b), false);
  if (!left.is_object() || !right.is_object()) return {};
  const json flat_left = left.flatten(), flat_right = right.flatten();
  std::string names;
  const auto add = [&names](std::string pointer) {
    pointer.erase(0, 1);
    for (char& c : pointer) c = c == '/' ? '.' : c;
    names += (names.empty() ? "" : ", ") + pointer;
  };
  for (const auto& [name, value] : flat_left.items()) {
    if (!flat_right.contains(name) || flat_right[name] != value) add(name);
  }
  for (const auto& [name, value] : flat_right.items()) {
    if (!flat_left.contains(name)) add(name);
  }
  // Settings of the cells also change the cells, so the cells are reported only if no setting differs.
  if (names.empty() && a.substr(0, begin_a) != b.substr(0, begin_b)) names = "the scene or its cells";
  return names;
}

struct checkpoint::state {
  std::filesystem::path path;
  sqlite3* database = nullptr;
  std::string key;
  std::mutex mutex;  // one thread at a time uses the database

  explicit state(std::filesystem::path where) : path(std::move(where)) {}
  ~state() { close(); }
  state(const state&) = delete;
  state& operator=(const state&) = delete;

  void close() {
    sqlite3_close(database);
    database = nullptr;
  }

  // SQLite opens a file that it cannot write again for reading, and then reports the error of that. The folder shows
  // the actual cause.
  std::string why_not_writable(int sqlite_error) const {
    const int of_folder = folder_problem(folder_of(path));
    const int why = of_folder != 0 ? of_folder : sqlite_error;
    return why != 0 ? fmt::format(": {}", std::strerror(why)) : std::string();
  }

  // Throws the sightcell::error for an error code of SQLite.
  [[noreturn]] void fail(int code, const char* doing) const {
    const std::string subject = path.string();
    const std::string text = database != nullptr ? sqlite3_errmsg(database) : sqlite3_errstr(code);
    const int system = database != nullptr ? sqlite3_system_errno(database) : 0;
    switch (code & 0xFF) {
      case SQLITE_BUSY:
      case SQLITE_LOCKED:
        throw error(error_kind::failed, "checkpoint.in-use", subject, "another bake is using it",
                    "wait for that bake to end, or choose another -o");
      case SQLITE_NOTADB:
      case SQLITE_CORRUPT:
        throw error(error_kind::bad_input, "checkpoint.damaged", subject, "is damaged (" + text + ")", fresh_remedy);
      case SQLITE_FULL:
        throw error(error_kind::failed, "checkpoint.disk-full", subject, fmt::format("{}: the disk is full", doing),
                    "make room and run the same command again; finished cells are kept");
      case SQLITE_CANTOPEN:
      case SQLITE_READONLY:
      case SQLITE_PERM:
      case SQLITE_AUTH:
        throw error(error_kind::failed, "checkpoint.not-writable", subject,
                    "cannot be created or written" + why_not_writable(system),
                    "choose an -o in a folder that exists and can be written");
      case SQLITE_NOMEM:
        throw std::bad_alloc();
      default:
        throw error(
            error_kind::failed, "checkpoint.failed", subject,
            fmt::format("{}: {}{}{}", doing, text, system != 0 ? ", " : "", system != 0 ? std::strerror(system) : ""),
            "check the disk and run the same command again; finished cells are kept");
    }
  }

  void run(const char* sql, const char* doing) const {
    const int code = sqlite3_exec(database, sql, nullptr, nullptr, nullptr);
    if (code != SQLITE_OK) fail(code, doing);
  }

  statement prepare(const char* sql) const {
    sqlite3_stmt* made = nullptr;
    const int code = sqlite3_prepare_v2(database, sql, -1, &made, nullptr);
    if (code != SQLITE_OK) fail(code, "reading");
    return statement(made);
  }

  // Returns the first column of the first row, which every query here has.
  std::int64_t query_number(const char* sql) const {
    const statement query = prepare(sql);
    const int code = sqlite3_step(query.get());
    if (code != SQLITE_ROW) fail(code == SQLITE_DONE ? SQLITE_CORRUPT : code, "reading");
    return sqlite3_column_int64(query.get(), 0);
  }

  std::optional<std::string> query_key() const {
    const statement query = prepare("SELECT key, plan, seal FROM bake");
    const int code = sqlite3_step(query.get());
    if (code == SQLITE_DONE) return std::nullopt;
    if (code != SQLITE_ROW) fail(code, "reading");
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(query.get(), 0));
    const std::string found(text != nullptr ? text : "");
    const auto plan = blob(query.get(), 1);
    if (sqlite3_column_int64(query.get(), 2) != seal_of_key(found, std::string(plan.begin(), plan.end())))
      throw error(error_kind::bad_input, "checkpoint.damaged", path.string(),
                  "is damaged: its key and its checksum differ", fresh_remedy);
    return found;
  }

  // Opens the file and takes the lock that keeps other bakes out until close(). A bake that ends may remove the file
  // after this bake opened it and before this bake locked it. The lock would then be on a file without a name, so the
  // function compares identities and tries again.
  void open_locked() {
    for (int tries = 0; tries < 100; ++tries) {
      const file_identity before = identity_of(path);
      open_and_lock();
      const file_identity now = identity_of(path);
      if (now.there && (!before.there || before == now)) return;
      close();
    }
    throw error(error_kind::failed, "checkpoint.in-use", path.string(),
                "is created and deleted again and again: other bakes are using it",
                "wait for those bakes to end, or choose another -o");
  }

  void open_and_lock() {
    // Absolute, because Debian's SQLite takes names that begin with "file:" for URIs.
    const int code = sqlite3_open_v2(std::filesystem::absolute(path).c_str(), &database,
                                     SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
    if (code != SQLITE_OK) fail(code, "opening");
    sqlite3_extended_result_codes(database, 1);
    run("PRAGMA locking_mode=EXCLUSIVE; PRAGMA synchronous=FULL; PRAGMA trusted_schema=OFF", "opening");
    run("BEGIN EXCLUSIVE", "opening");
    run("COMMIT", "opening");  // in this locking mode the lock remains
    run(on_network_disk(folder_of(path)) ? "PRAGMA journal_mode=TRUNCATE" : "PRAGMA journal_mode=WAL", "opening");
  }

  void open_to_read() {
    // No process writes the file any more: SQLite needs no lock and searches for no journal.
    const std::string name = "file:" + escaped(std::filesystem::absolute(path).string()) + "?immutable=1";
    const int code = sqlite3_open_v2(name.c_str(), &database, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    if (code != SQLITE_OK) fail(code, "opening");
    sqlite3_extended_result_codes(database, 1);
    run("PRAGMA trusted_schema=OFF", "opening");
  }

  bool empty() const { return query_number("SELECT count(*) FROM sqlite_schema") == 0; }

  void create(const std::string& bake_key, std::string_view plan, std::string_view cells) {
    run("BEGIN", "creating");
    run(fmt::format("PRAGMA application_id={}; PRAGMA user_version={};"
                    "CREATE TABLE bake(key TEXT NOT NULL, plan BLOB NOT NULL, seal INTEGER NOT NULL);"
                    "CREATE TABLE cells(bytes BLOB NOT NULL);"
                    "CREATE TABLE record(number INTEGER PRIMARY KEY, bytes BLOB NOT NULL)",
                    application_id, schema_version)
            .c_str(),
        "creating");
    insert_key(bake_key, plan);
    insert_cells(cells);
    run("COMMIT", "creating");
    key = bake_key;
  }

  void insert_key(const std::string& bake_key, std::string_view plan) const {
    const statement insert = prepare("INSERT INTO bake(key, plan, seal) VALUES(?,?,?)");
    sqlite3_bind_text(insert.get(), 1, bake_key.data(), static_cast<int>(bake_key.size()), SQLITE_STATIC);
    sqlite3_bind_blob64(insert.get(), 2, plan.empty() ? "" : plan.data(), plan.size(), SQLITE_STATIC);
    sqlite3_bind_int64(insert.get(), 3, seal_of_key(bake_key, plan));
    const int code = sqlite3_step(insert.get());
    if (code != SQLITE_DONE) fail(code, "creating");
  }

  void insert_cells(std::string_view cells) const {
    if (cells.empty()) return;
    const std::vector<std::uint8_t> bytes = sealed({cells.begin(), cells.end()}, number_of_cells);
    const statement insert = prepare("INSERT INTO cells(bytes) VALUES(?)");
    sqlite3_bind_blob64(insert.get(), 1, bytes.data(), bytes.size(), SQLITE_STATIC);
    const int code = sqlite3_step(insert.get());
    if (code != SQLITE_DONE) fail(code, "storing the list of cells");
  }

  std::string query_cells() const {
    const statement query = prepare("SELECT bytes FROM cells");
    const int code = sqlite3_step(query.get());
    if (code == SQLITE_DONE) return {};
    if (code != SQLITE_ROW) fail(code, "reading");
    const auto body = unsealed(blob(query.get(), 0), number_of_cells);
    return body ? std::string(body->begin(), body->end()) : std::string();
  }

  // Stores the cells of the bake if the file has none, or damaged ones.
  void keep_cells(std::string_view cells) const {
    if (query_cells() == cells) return;
    run("BEGIN", "storing the list of cells");
    run("DELETE FROM cells", "storing the list of cells");
    insert_cells(cells);
    run("COMMIT", "storing the list of cells");
  }

  // Reads the key of an existing file. Returns nothing if the file has another schema or no key.
  std::optional<std::string> read_key() const {
    if (query_number("PRAGMA application_id") != application_id)
      throw error(error_kind::bad_input, "checkpoint.not-ours", path.string(), "is the database of another program",
                  "choose another -o");
    const bool same_schema = query_number("PRAGMA user_version") == schema_version;
    return same_schema ? query_key() : std::nullopt;
  }

  // Gives the file another key and plan and deletes stale records, in one transaction.
  void hand_over(const std::string& wanted, std::string_view plan, std::string_view cells,
                 const stale_record& is_stale) const {
    run("BEGIN", "taking over an unfinished bake");
    std::vector<std::int64_t> stale;
    {
      const statement query = prepare("SELECT number FROM record");
      int code = SQLITE_ROW;
      while ((code = sqlite3_step(query.get())) == SQLITE_ROW) {
        const std::int64_t number = sqlite3_column_int64(query.get(), 0);
        if (is_stale(static_cast<std::uint32_t>(number / stage_count), static_cast<cell_stage>(number % stage_count)))
          stale.push_back(number);
      }
      if (code != SQLITE_DONE) fail(code, "reading");
    }
    for (const std::int64_t number : stale)
      run(fmt::format("DELETE FROM record WHERE number={}", number).c_str(), "dropping a record");
    run("DELETE FROM bake; DELETE FROM cells", "taking over an unfinished bake");
    insert_key(wanted, plan);
    insert_cells(cells);
    run("COMMIT", "taking over an unfinished bake");
  }

  void check_key(const std::string& wanted, std::string_view plan, std::string_view cells,
                 const stale_key_test& take_over_test) {
    const std::optional<std::string> stored = read_key();
    key = wanted;
    if (stored == wanted) return keep_cells(cells);
    if (const auto is_stale = stored && take_over_test ? take_over_test(*stored) : std::nullopt)
      return hand_over(wanted, plan, cells, *is_stale);
    std::string what = "scene, settings or version";
    if (stored) {
      if (const std::string names = differing_names(*stored, wanted); !names.empty()) what = names;
    }
    throw error(error_kind::wrong_use, "checkpoint.other-bake", path.string(),
                fmt::format("holds an unfinished bake that differs in {}", what),
                std::string("repeat that bake's command to finish it, ") + fresh_remedy);
  }

  // Returns the cells of an opened file of any key; empty if it is of another version.
  std::string cells_of_any_key() const {
    if (empty() || !read_key()) return {};
    return query_cells();
  }

  // Deletes the file and the files that a killed bake may have left beside it.
  void delete_files() const {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    for (const char* beside : {"-journal", "-wal", "-shm"}) {
      std::filesystem::path other = path;
      std::filesystem::remove(other += beside, ignored);
    }
  }

  // Deletes the file before the lock ends, so that no other bake opens it. The journal mode is set to DELETE first,
  // because closing a write-ahead log deletes a file of its name, which may be that of another bake by then.
  void remove() {
    sqlite3_exec(database, "PRAGMA journal_mode=DELETE", nullptr, nullptr, nullptr);
    delete_files();
    close();
  }
};

checkpoint::checkpoint(const std::filesystem::path& path, const std::string& key, bool fresh, std::string_view plan,
                       std::string_view cells, const stale_key_test& take_over_test)
    : state_(std::make_unique<state>(path)) {
  try {
    state_->open_locked();
    if (fresh && !state_->empty()) {
      state_->remove();
      state_->open_locked();
    }
  } catch (const error& e) {
    if (!fresh || e.id() != "checkpoint.damaged") throw;
    state_->close();
    state_->delete_files();
    state_->open_locked();
  }
  if (state_->empty())
    state_->create(key, plan, cells);
  else
    state_->check_key(key, plan, cells, take_over_test);
}

checkpoint::checkpoint(std::unique_ptr<state> opened) : state_(std::move(opened)) {}
checkpoint::~checkpoint() = default;
checkpoint::checkpoint(checkpoint&&) noexcept = default;

checkpoint checkpoint::open_to_read(const std::filesystem::path& path) {
  auto opened = std::make_unique<state>(path);
  opened->open_to_read();
  const std::optional<std::string> key = opened->read_key();
  if (!key)
    throw error(error_kind::bad_input, "checkpoint.other-version", path.string(), "was made by another version",
                "bake it again with this version");
  opened->key = *key;
  return checkpoint(std::move(opened));
}

const std::string& checkpoint::key() const {
  return state_->key;
}

std::string checkpoint::plan() const {
  const std::scoped_lock lock(state_->mutex);
  const statement query = state_->prepare("SELECT plan FROM bake");
  const int code = sqlite3_step(query.get());
  if (code != SQLITE_ROW) state_->fail(code == SQLITE_DONE ? SQLITE_CORRUPT : code, "reading");
  const auto bytes = blob(query.get(), 0);
  return {bytes.begin(), bytes.end()};
}

std::string checkpoint::cells() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->query_cells();
}

std::string checkpoint::cells_in(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return {};
  state opened(path);
  opened.open_locked();
  return opened.cells_of_any_key();
}

std::uint32_t checkpoint::survey(
    const std::function<void(std::uint32_t cell, cell_stage, const cell_summary&)>& visit) {
  const std::scoped_lock lock(state_->mutex);
  std::vector<std::int64_t> damaged;
  {
    const statement query = state_->prepare("SELECT number, bytes FROM record");
    int code = SQLITE_ROW;
    while ((code = sqlite3_step(query.get())) == SQLITE_ROW) {
      const std::int64_t number = sqlite3_column_int64(query.get(), 0);
      const auto body = unsealed(blob(query.get(), 1), number);
      const std::optional<cell_summary> summary = body ? decode_summary(*body) : std::nullopt;
      if (!summary)
        damaged.push_back(number);
      else
        visit(static_cast<std::uint32_t>(number / stage_count), static_cast<cell_stage>(number % stage_count),
              *summary);
    }
    if (code != SQLITE_DONE) state_->fail(code, "reading");
  }
  for (const std::int64_t number : damaged)
    state_->run(fmt::format("DELETE FROM record WHERE number={}", number).c_str(), "dropping a damaged record");
  return static_cast<std::uint32_t>(damaged.size());
}

std::optional<cell_record> checkpoint::load(std::uint32_t cell, cell_stage stage) const {
  std::vector<std::uint8_t> bytes;
  {
    const std::scoped_lock lock(state_->mutex);
    const statement query = state_->prepare("SELECT bytes FROM record WHERE number=?");
    sqlite3_bind_int64(query.get(), 1, number_of(cell, stage));
    const int code = sqlite3_step(query.get());
    if (code == SQLITE_DONE) return std::nullopt;
    if (code != SQLITE_ROW) state_->fail(code, "reading");
    const auto stored = blob(query.get(), 0);
    bytes.assign(stored.begin(), stored.end());
  }
  // Outside the lock, because decoding takes longer than reading and other cells are loaded at the same time.
  const auto body = unsealed(bytes, number_of(cell, stage));
  std::optional<cell_record> record = body ? decode(*body) : std::nullopt;
  if (!record)
    throw error(error_kind::bad_input, "checkpoint.damaged", state_->path.string(),
                fmt::format("the record of cell {} is damaged", cell),
                "run the same command again: it repeats that cell");
  return record;
}

void checkpoint::store(std::span<const stage_record> records, std::span<const std::uint32_t> forget) {
  std::vector<std::vector<std::uint8_t>> bytes;
  for (const stage_record& one : records) bytes.push_back(sealed(encode(one.record), number_of(one.cell, one.stage)));
  const std::scoped_lock lock(state_->mutex);
  state_->run("BEGIN", "storing cells");
  try {
    const statement insert = state_->prepare("INSERT OR REPLACE INTO record(number, bytes) VALUES(?,?)");
    for (std::size_t i = 0; i < records.size(); ++i) {
      sqlite3_bind_int64(insert.get(), 1, number_of(records[i].cell, records[i].stage));
      int code = sqlite3_bind_blob64(insert.get(), 2, bytes[i].data(), bytes[i].size(), SQLITE_STATIC);
      if (code == SQLITE_OK) code = sqlite3_step(insert.get());
      if (code != SQLITE_DONE) state_->fail(code, "storing cells");
      sqlite3_reset(insert.get());
    }
    for (const std::uint32_t cell : forget)
      state_->run(fmt::format("DELETE FROM record WHERE number={}", number_of(cell, cell_stage::sampled)).c_str(),
                  "storing cells");
    state_->run("COMMIT", "storing cells");
  } catch (...) {
    sqlite3_exec(state_->database, "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
}

std::uint32_t checkpoint::count(cell_stage stage) const {
  const std::scoped_lock lock(state_->mutex);
  return static_cast<std::uint32_t>(state_->query_number(
      fmt::format("SELECT count(*) FROM record WHERE number%{}={}", stage_count, static_cast<int>(stage)).c_str()));
}

void checkpoint::list(const std::function<void(std::uint32_t cell, cell_stage)>& visit) const {
  const std::scoped_lock lock(state_->mutex);
  const statement query = state_->prepare("SELECT number FROM record");
  int code = SQLITE_ROW;
  while ((code = sqlite3_step(query.get())) == SQLITE_ROW) {
    const std::int64_t number = sqlite3_column_int64(query.get(), 0);
    visit(static_cast<std::uint32_t>(number / stage_count), static_cast<cell_stage>(number % stage_count));
  }
  if (code != SQLITE_DONE) state_->fail(code, "reading");
}

void checkpoint::copy_to(const std::filesystem::path& path) const {
  const std::scoped_lock lock(state_->mutex);
  std::filesystem::path partial = path;
  partial += ".partial";
  std::error_code ignored;
  std::filesystem::remove(partial, ignored);  // left by a kill
  const statement copy = state_->prepare("VACUUM INTO ?");
  const std::string name = partial.string();
  sqlite3_bind_text(copy.get(), 1, name.data(), static_cast<int>(name.size()), SQLITE_STATIC);
  if (const int code = sqlite3_step(copy.get()); code != SQLITE_DONE) {
    std::filesystem::remove(partial, ignored);
    throw error(error_kind::failed, "checkpoint.not-copied", path.string(),
                fmt::format("cannot be written ({})", sqlite3_errmsg(state_->database)),
                "free space or choose another folder, then run the same command again; finished cells are kept");
  }
  try {
    publish(partial, path);
  } catch (const std::filesystem::filesystem_error& e) {
    throw error(error_kind::failed, "checkpoint.not-copied", path.string(),
                fmt::format("cannot be written ({})", e.code().message()),
                "free space or choose another folder, then run the same command again; finished cells are kept");
  }
}

void checkpoint::remove() {
  state_->remove();
}

}  // namespace sightcell::bake
