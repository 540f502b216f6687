#include "checkpoint.h"

#include <fmt/format.h>
#include <sqlite3.h>
#include <xxhash.h>

#include <bit>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <type_traits>

#include "sightcell/scene/error.h"

// Why these choices of SQLite: a rollback journal keeps every committed cell in the one file (a write-ahead log would
// leave part of the bake in a second one that people forget to copy); after a kill the journal that is left is rolled
// back at the next open. synchronous=FULL: a cell is on the disk when store returns. locking_mode=EXCLUSIVE: the lock
// is held as long as the bake runs, and the system drops it when the process dies, however it dies.

namespace sightcell::bake {

namespace {

constexpr int application_id = 0x53434B31;  // "SCK1": tells our files from other people's databases
constexpr int schema_version = 1;
constexpr std::uint8_t record_version = 1;

// --- one record as bytes: version, the plain fields little-endian, the set as varint gaps, XXH3-64 of all before it

void put_bytes(std::vector<std::uint8_t>& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

void put_varint(std::vector<std::uint8_t>& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<std::uint8_t>(value | 0x80));
  out.push_back(static_cast<std::uint8_t>(value));
}

std::vector<std::uint8_t> encode(const cell_record& record) {
  std::vector<std::uint8_t> out;
  out.reserve(64 + 2 * record.set.size());
  out.push_back(record_version);
  out.push_back(static_cast<std::uint8_t>((record.stored ? 1 : 0) | (record.bound_met ? 2 : 0)));
  put_bytes(out, record.rays, 8);
  put_bytes(out, record.misses, 8);
  put_bytes(out, std::bit_cast<std::uint64_t>(record.upper_bound), 8);
  put_bytes(out, std::bit_cast<std::uint64_t>(record.confidence), 8);
  put_bytes(out, record.rays_spent, 8);
  put_bytes(out, record.samples, 4);
  put_bytes(out, std::bit_cast<std::uint64_t>(record.seconds), 8);
  put_varint(out, record.set.size());
  std::uint32_t previous = 0;
  for (const std::uint32_t id : record.set) {
    put_varint(out, id - previous);
    previous = id;
  }
  put_bytes(out, XXH3_64bits(out.data(), out.size()), 8);
  return out;
}

// Every read is checked; after the first one past the end all answer 0 and good is false.
struct reader {
  std::span<const std::uint8_t> bytes;
  bool good = true;

  std::uint64_t take(int count) {
    std::uint64_t value = 0;
    if (bytes.size() < static_cast<std::size_t>(count)) return fail();
    for (int i = 0; i < count; ++i) value |= std::uint64_t{bytes[static_cast<std::size_t>(i)]} << (8 * i);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    return value;
  }
  std::uint64_t take_varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 63; shift += 7) {
      const std::uint64_t part = take(1);
      value |= (part & 0x7F) << shift;
      if (part < 0x80) return value;
    }
    return fail();
  }
  double take_double() { return std::bit_cast<double>(take(8)); }

 private:
  std::uint64_t fail() {
    good = false;
    bytes = {};
    return 0;
  }
};

std::optional<cell_record> decode(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 8) return std::nullopt;
  const std::span<const std::uint8_t> body = bytes.first(bytes.size() - 8);
  reader tail{bytes.last(8)};
  if (tail.take(8) != XXH3_64bits(body.data(), body.size())) return std::nullopt;
  reader in{body};
  if (in.take(1) != record_version) return std::nullopt;
  cell_record record;
  const std::uint64_t flags = in.take(1);
  record.stored = (flags & 1) != 0;
  record.bound_met = (flags & 2) != 0;
  record.rays = in.take(8);
  record.misses = in.take(8);
  record.upper_bound = in.take_double();
  record.confidence = in.take_double();
  record.rays_spent = in.take(8);
  record.samples = static_cast<std::uint32_t>(in.take(4));
  record.seconds = in.take_double();
  const std::uint64_t count = in.take_varint();
  if (count > in.bytes.size()) return std::nullopt;  // a gap takes at least one byte
  record.set.reserve(count);
  std::uint64_t id = 0;
  for (std::uint64_t i = 0; i < count; ++i) {
    id += in.take_varint();
    if (id > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
    record.set.push_back(static_cast<std::uint32_t>(id));
  }
  if (!in.good || !in.bytes.empty()) return std::nullopt;
  return record;
}

// --- keys

// What differs between two keys, for people: "player_radius, samples". A key is plain words (scene, cells) and then the
// settings as a JSON object; empty when a key is anything else.
std::string differing_names(const std::string& a, const std::string& b) {
  using nlohmann::json;
  const std::size_t begin_a = a.find('{'), begin_b = b.find('{');
  if (begin_a == std::string::npos || begin_b == std::string::npos) return {};
  const json left = json::parse(a.substr(begin_a), nullptr, false),
             right = json::parse(b.substr(begin_b), nullptr, false);
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
  // Settings of the cells change the cells too: only where no setting differs is it news.
  if (names.empty() && a.substr(0, begin_a) != b.substr(0, begin_b)) names = "the scene or its cells";
  return names;
}

struct finalize_statement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using statement = std::unique_ptr<sqlite3_stmt, finalize_statement>;

constexpr const char* fresh_remedy = "start over with --fresh, or choose another -o";

}  // namespace

struct checkpoint::state {
  std::filesystem::path path;
  sqlite3* database = nullptr;

  explicit state(std::filesystem::path where) : path(std::move(where)) {}
  ~state() { close(); }
  state(const state&) = delete;
  state& operator=(const state&) = delete;

  void close() {
    sqlite3_close(database);
    database = nullptr;
  }

  // Turns SQLite's answer into one of our errors.
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
                    fmt::format("cannot be created or written{}{}", system != 0 ? ": " : "",
                                system != 0 ? std::strerror(system) : ""),
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

  // First column of the first row, which every query here has.
  std::int64_t ask_number(const char* sql) const {
    const statement query = prepare(sql);
    const int code = sqlite3_step(query.get());
    if (code != SQLITE_ROW) fail(code == SQLITE_DONE ? SQLITE_CORRUPT : code, "reading");
    return sqlite3_column_int64(query.get(), 0);
  }

  std::optional<std::string> ask_key() const {
    const statement query = prepare("SELECT key FROM bake");
    const int code = sqlite3_step(query.get());
    if (code == SQLITE_DONE) return std::nullopt;
    if (code != SQLITE_ROW) fail(code, "reading");
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(query.get(), 0));
    return std::string(text != nullptr ? text : "");
  }

  // Opens the file and takes the lock that keeps a second bake out until close.
  void open_locked() {
    const int code = sqlite3_open_v2(path.c_str(), &database, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
    if (code != SQLITE_OK) fail(code, "opening");
    sqlite3_extended_result_codes(database, 1);
    run("PRAGMA locking_mode=EXCLUSIVE; PRAGMA synchronous=FULL; PRAGMA trusted_schema=OFF", "opening");
    run("BEGIN EXCLUSIVE", "opening");
    run("COMMIT", "opening");  // in this locking mode the lock stays
    run("PRAGMA journal_mode=DELETE", "opening");
  }

  bool empty() const { return ask_number("SELECT count(*) FROM sqlite_schema") == 0; }

  void create(const std::string& key) const {
    run("BEGIN", "creating");
    run(fmt::format("PRAGMA application_id={}; PRAGMA user_version={};"
                    "CREATE TABLE bake(key TEXT NOT NULL);"
                    "CREATE TABLE cell(number INTEGER PRIMARY KEY, record BLOB NOT NULL)",
                    application_id, schema_version)
            .c_str(),
        "creating");
    const statement insert = prepare("INSERT INTO bake(key) VALUES(?)");
    sqlite3_bind_text(insert.get(), 1, key.data(), static_cast<int>(key.size()), SQLITE_STATIC);
    const int code = sqlite3_step(insert.get());
    if (code != SQLITE_DONE) fail(code, "creating");
    run("COMMIT", "creating");
  }

  void check_key(const std::string& key) const {
    if (ask_number("PRAGMA application_id") != application_id)
      throw error(error_kind::bad_input, "checkpoint.not-ours", path.string(), "is some other program's database",
                  "choose another -o");
    const bool same_schema = ask_number("PRAGMA user_version") == schema_version;
    const std::optional<std::string> stored = same_schema ? ask_key() : std::nullopt;
    if (stored == key) return;
    std::string what = "scene, settings or version";
    if (stored) {
      if (const std::string names = differing_names(*stored, key); !names.empty()) what = names;
    }
    throw error(error_kind::wrong_use, "checkpoint.other-bake", path.string(),
                fmt::format("holds an unfinished bake that differs in {}", what),
                std::string("repeat that bake's command to finish it, ") + fresh_remedy);
  }

  // Deletes the file and what a killed bake may have left beside it.
  void delete_files() const {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
    std::filesystem::remove(path.string() + "-journal", ignored);
  }
};

checkpoint::checkpoint(const std::filesystem::path& path, const std::string& key, bool fresh)
    : state_(std::make_unique<state>(path)) {
  try {
    state_->open_locked();
    if (fresh && !state_->empty()) {
      state_->delete_files();  // while the lock is held: a bake that is using it has refused us above
      state_->close();
      state_->open_locked();
    }
  } catch (const error& e) {
    if (!fresh || e.id() != "checkpoint.damaged") throw;
    state_->close();
    state_->delete_files();
    state_->open_locked();
  }
  if (state_->empty())
    state_->create(key);
  else
    state_->check_key(key);
}

checkpoint::~checkpoint() = default;

std::optional<cell_record> checkpoint::load(std::uint32_t cell) const {
  const statement query = state_->prepare("SELECT record FROM cell WHERE number=?");
  sqlite3_bind_int64(query.get(), 1, cell);
  const int code = sqlite3_step(query.get());
  if (code == SQLITE_DONE) return std::nullopt;
  if (code != SQLITE_ROW) state_->fail(code, "reading");
  const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(query.get(), 0));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(query.get(), 0));
  std::optional<cell_record> record = decode({bytes, size});
  if (!record)
    throw error(error_kind::bad_input, "checkpoint.damaged", state_->path.string(),
                fmt::format("the record of cell {} is damaged", cell), fresh_remedy);
  return record;
}

void checkpoint::store(std::uint32_t cell, const cell_record& record) {
  const std::vector<std::uint8_t> bytes = encode(record);
  // A single statement is a transaction of its own: SQLite rolls it back when any of it fails.
  const statement insert = state_->prepare("INSERT OR REPLACE INTO cell(number,record) VALUES(?,?)");
  sqlite3_bind_int64(insert.get(), 1, cell);
  int code = sqlite3_bind_blob64(insert.get(), 2, bytes.data(), bytes.size(), SQLITE_STATIC);
  if (code == SQLITE_OK) code = sqlite3_step(insert.get());
  if (code != SQLITE_DONE) state_->fail(code, "storing a cell");
}

std::uint32_t checkpoint::finished() const {
  return static_cast<std::uint32_t>(state_->ask_number("SELECT count(*) FROM cell"));
}

void checkpoint::remove() {
  // The file goes first, while the lock still keeps others from opening it.
  state_->delete_files();
  state_->close();
}

}  // namespace sightcell::bake
