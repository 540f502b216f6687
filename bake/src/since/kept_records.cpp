#include "since/kept_records.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <system_error>
#include <tuple>
#include <utility>

#include "sightcell/base/disk.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

constexpr char magic[8] = {'S', 'C', 'K', 'E', 'P', 'T', '0', '5'};
constexpr std::size_t checksum_size = 8;
static_assert(sizeof(triangle) == 36);

// Writes values to a file and computes the checksum of what it wrote. The records of a level have hundreds of megabytes,
// so they are not put together in memory.
class records_writer {
 public:
  explicit records_writer(const std::filesystem::path& path) : out_(path, std::ios::binary) {
    XXH3_64bits_reset(sum_.get());
  }

  void put(const void* from, std::size_t size) {
    if (size > 0) XXH3_64bits_update(sum_.get(), from, size);
    out_.write(static_cast<const char*>(from), static_cast<std::streamsize>(size));
  }
  template <class Number>
  void put(const Number& number) {
    put(&number, sizeof(number));
  }
  void put_list(std::span<const std::uint8_t> bytes) {
    put(static_cast<std::uint64_t>(bytes.size()));
    put(bytes.data(), bytes.size());
  }
  template <class Item>
  void put_items(const std::vector<Item>& items) {
    put(items.data(), items.size() * sizeof(Item));
  }
  // Ends with the checksum. Returns whether all was written.
  bool close() {
    put(static_cast<std::uint64_t>(XXH3_64bits_digest(sum_.get())));
    out_.close();
    return static_cast<bool>(out_);
  }

 private:
  std::ofstream out_;
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> sum_{XXH3_createState(), &XXH3_freeState};
};

// Reads values and checks every read. After the first read past the end, good is false and all reads give zeros.
struct records_reader {
  std::span<const std::uint8_t> bytes;
  bool good = true;

  std::span<const std::uint8_t> take_bytes(std::uint64_t size) {
    if (size > bytes.size()) {
      good = false;
      bytes = {};
      return {};
    }
    const auto taken = bytes.first(static_cast<std::size_t>(size));
    bytes = bytes.subspan(taken.size());
    return taken;
  }
  template <class Number>
  Number take() {
    Number number{};
    const auto from = take_bytes(sizeof(number));
    if (good) std::memcpy(&number, from.data(), sizeof(number));
    return number;
  }
  std::span<const std::uint8_t> take_list() { return take_bytes(take<std::uint64_t>()); }
};

template <class Item>
void take_items(records_reader& in, std::size_t count, std::vector<Item>& items) {
  const auto bytes = in.take_bytes(std::uint64_t{count} * sizeof(Item));
  items.resize(bytes.size() / sizeof(Item));
  if (!bytes.empty()) std::memcpy(items.data(), bytes.data(), bytes.size());
}

// Not deflated: hashes do not become smaller, and an edit waits for this.
void put_polygons(records_writer& out, const polygon_table& table) {
  out.put(static_cast<std::uint64_t>(table.names.size()));
  out.put_items(table.names);
  out.put_items(table.near);
  out.put_items(table.corners);
}

bool take_polygons(records_reader& in, polygon_table& table) {
  const auto count = in.take<std::uint64_t>();
  if (count >= scene::no_index) return false;
  take_items(in, static_cast<std::size_t>(count), table.names);
  take_items(in, static_cast<std::size_t>(count), table.near);
  take_items(in, static_cast<std::size_t>(count), table.corners);
  return in.good;
}

void put_partners(records_writer& out, const kept_records& records) {
  out.put(records.partner_reach);
  out.put(static_cast<std::uint64_t>(records.partners.size()));
  static_assert(sizeof(polygon_pair) == 8);
  out.put_items(records.partners);
}

bool take_partners(records_reader& in, kept_records& records) {
  records.partner_reach = in.take<float>();
  const auto count = in.take<std::uint64_t>(), polygons = std::uint64_t{records.polygons.names.size()};
  for (std::uint64_t i = 0; in.good && i < count; ++i) {
    const auto a = in.take<std::uint32_t>(), b = in.take<std::uint32_t>();
    if (a >= b || b >= polygons) return false;
    records.partners.emplace_back(a, b);
  }
  return in.good;
}

// Returns whether all was written.
bool write_to(const std::filesystem::path& path, const kept_records& records) {
  records_writer out(path);
  out.put(magic, sizeof(magic));
  out.put_list({reinterpret_cast<const std::uint8_t*>(records.key.data()), records.key.size()});
  put_polygons(out, records.polygons);
  put_partners(out, records);
  out.put(static_cast<std::uint64_t>(records.steps.size()));
  for (const kept_step& step : records.steps) {
    out.put(step.place);
    out.put(step.box);
    out.put(step.kind);
    out.put(step.own_inputs);
    out.put(step.neighbor_inputs);
    out.put(static_cast<std::uint8_t>(step.started ? 1 : 0));
    out.put_list(step.record);
    out.put(static_cast<std::uint8_t>(step.spaces.size()));
    for (const auto& space : step.spaces) out.put_list(space);
    out.put_list(step.tested);
  }
  return out.close();
}

[[noreturn]] void refuse_to_write(const std::filesystem::path& path) {
  throw error(error_kind::failed, "output.io", path.string(), "the kept records cannot be written",
              "make room or choose another -o; the .pvs file is complete");
}

std::optional<kept_records> records_of(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < sizeof(magic) + checksum_size) return std::nullopt;
  const auto body = bytes.first(bytes.size() - checksum_size);
  records_reader tail{bytes.last(checksum_size)};
  if (tail.take<std::uint64_t>() != XXH3_64bits(body.data(), body.size())) return std::nullopt;
  records_reader in{body};
  if (std::memcmp(in.take_bytes(sizeof(magic)).data(), magic, sizeof(magic)) != 0) return std::nullopt;
  kept_records records;
  const auto key = in.take_list();
  records.key.assign(key.begin(), key.end());
  if (!take_polygons(in, records.polygons) || !take_partners(in, records)) return std::nullopt;
  const auto count = in.take<std::uint64_t>();
  for (std::uint64_t i = 0; in.good && i < count; ++i) {
    kept_step& step = records.steps.emplace_back();
    step.place = in.take<std::uint64_t>();
    step.box = in.take<std::array<float, 6>>();
    const auto kind = in.take<std::uint8_t>();
    if (kind > static_cast<std::uint8_t>(step_kind::check)) return std::nullopt;
    step.kind = static_cast<step_kind>(kind);
    step.own_inputs = in.take<std::uint64_t>();
    step.neighbor_inputs = in.take<std::uint64_t>();
    step.started = in.take<std::uint8_t>() != 0;
    const auto record = in.take_list();
    const auto spaces = in.take<std::uint8_t>();
    for (std::uint8_t k = 0; k < spaces; ++k) {
      const auto space = in.take_list();
      step.spaces.emplace_back(space.begin(), space.end());
    }
    const auto tested = in.take_list();
    step.record.assign(record.begin(), record.end());
    step.tested.assign(tested.begin(), tested.end());
  }
  if (!in.good || !in.bytes.empty()) return std::nullopt;
  return records;
}

}  // namespace

std::filesystem::path records_beside(const std::filesystem::path& pvs) {
  std::filesystem::path path = pvs;
  path += ".records";
  return path;
}

written_records::written_records(kept_records& records, const std::filesystem::path& pvs)
    : path_(records_beside(pvs)), fresh_(path_) {
  fresh_ += ".new";  // the lock of the checkpoint keeps other bakes of this output out
  std::sort(records.steps.begin(), records.steps.end(), [](const kept_step& a, const kept_step& b) {
    return std::tie(a.place, a.box, a.kind) < std::tie(b.place, b.box, b.kind);
  });
  if (write_to(fresh_, records)) return;
  std::error_code ignored;
  std::filesystem::remove(fresh_, ignored);
  refuse_to_write(path_);
}

written_records::~written_records() {
  std::error_code ignored;
  if (!fresh_.empty()) std::filesystem::remove(fresh_, ignored);
}

void written_records::publish() {
  try {
    bake::publish(fresh_, path_);
  } catch (const std::filesystem::filesystem_error&) {
    refuse_to_write(path_);
  }
  fresh_.clear();
}

void write_records(kept_records& records, const std::filesystem::path& pvs) {
  written_records(records, pvs).publish();
}

kept_records read_records(const std::filesystem::path& pvs) {
  const std::filesystem::path path = records_beside(pvs);
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = in ? static_cast<std::streamoff>(in.tellg()) : -1;
  std::error_code ignored;
  if (size < 0 || !std::filesystem::is_regular_file(path, ignored))
    throw error(error_kind::bad_input, "records.missing", path.string(), "does not exist or cannot be read",
                "bake once with --keep-records, then give that file to --since");
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(size));
  in.seekg(0);
  in.read(reinterpret_cast<char*>(bytes.data()), size);
  if (!in) refuse_records(pvs);
  std::optional<kept_records> records = records_of(bytes);
  if (!records) refuse_records(pvs);
  return std::move(*records);
}

void refuse_records(const std::filesystem::path& pvs) {
  throw error(error_kind::bad_input, "records.damaged", records_beside(pvs).string(),
              "is damaged, or was written by another version", "bake with --keep-records and without --since");
}

}  // namespace sightcell::bake
