#include "since/kept_records.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <optional>
#include <span>
#include <system_error>
#include <tuple>
#include <utility>

#include "sightcell/base/disk.h"
#include "sightcell/base/error.h"

namespace sightcell::bake {
namespace {

constexpr char magic[8] = {'S', 'C', 'K', 'E', 'P', 'T', '0', '4'};
constexpr std::size_t checksum_size = 8;
static_assert(sizeof(triangle) == 36);

void put(std::vector<std::uint8_t>& out, const void* from, std::size_t size) {
  const auto* bytes = static_cast<const std::uint8_t*>(from);
  out.insert(out.end(), bytes, bytes + size);
}
template <class Number>
void put(std::vector<std::uint8_t>& out, const Number& number) {
  put(out, &number, sizeof(number));
}
void put_list(std::vector<std::uint8_t>& out, std::span<const std::uint8_t> bytes) {
  put(out, static_cast<std::uint64_t>(bytes.size()));
  put(out, bytes.data(), bytes.size());
}

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
void put_items(std::vector<std::uint8_t>& out, const std::vector<Item>& items) {
  put(out, items.data(), items.size() * sizeof(Item));
}

template <class Item>
void take_items(records_reader& in, std::size_t count, std::vector<Item>& items) {
  const auto bytes = in.take_bytes(std::uint64_t{count} * sizeof(Item));
  items.resize(bytes.size() / sizeof(Item));
  if (!bytes.empty()) std::memcpy(items.data(), bytes.data(), bytes.size());
}

// Not deflated: hashes do not become smaller, and an edit waits for this.
void put_polygons(std::vector<std::uint8_t>& out, const polygon_table& table) {
  put(out, static_cast<std::uint64_t>(table.names.size()));
  put_items(out, table.names);
  put_items(out, table.near);
  put_items(out, table.corners);
}

bool take_polygons(records_reader& in, polygon_table& table) {
  const auto count = in.take<std::uint64_t>();
  if (count >= scene::no_index) return false;
  take_items(in, static_cast<std::size_t>(count), table.names);
  take_items(in, static_cast<std::size_t>(count), table.near);
  take_items(in, static_cast<std::size_t>(count), table.corners);
  return in.good;
}

void put_partners(std::vector<std::uint8_t>& out, const kept_records& records) {
  put(out, records.partner_reach);
  put(out, static_cast<std::uint64_t>(records.partners.size()));
  for (const auto& [a, b] : records.partners) put(out, a), put(out, b);
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

std::vector<std::uint8_t> bytes_of(const kept_records& records) {
  std::size_t of_steps = 0;
  for (const kept_step& step : records.steps) of_steps += step.record.size() + step.space.size() + sizeof(kept_step);
  std::vector<std::uint8_t> out;
  out.reserve(records.polygons.names.size() * (2 * sizeof(std::uint64_t) + sizeof(triangle)) + of_steps);
  out.insert(out.end(), std::begin(magic), std::end(magic));
  put_list(out, {reinterpret_cast<const std::uint8_t*>(records.key.data()), records.key.size()});
  put_polygons(out, records.polygons);
  put_partners(out, records);
  put(out, static_cast<std::uint64_t>(records.steps.size()));
  for (const kept_step& step : records.steps) {
    put(out, step.place);
    put(out, step.box);
    put(out, step.kind);
    put(out, step.own_inputs);
    put(out, step.neighbor_inputs);
    put(out, static_cast<std::uint8_t>(step.started ? 1 : 0));
    put_list(out, step.record);
    put_list(out, step.space);
  }
  put(out, static_cast<std::uint64_t>(XXH3_64bits(out.data(), out.size())));
  return out;
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
    const auto record = in.take_list(), space = in.take_list();
    step.record.assign(record.begin(), record.end());
    step.space.assign(space.begin(), space.end());
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

void write_records(kept_records& records, const std::filesystem::path& pvs) {
  std::sort(records.steps.begin(), records.steps.end(), [](const kept_step& a, const kept_step& b) {
    return std::tie(a.place, a.box, a.kind) < std::tie(b.place, b.box, b.kind);
  });
  const std::vector<std::uint8_t> bytes = bytes_of(records);
  const std::filesystem::path path = records_beside(pvs);
  std::filesystem::path fresh = path;
  fresh += ".new";  // the lock of the checkpoint keeps other bakes of this output out
  {
    std::ofstream out(fresh, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (out) {
      try {
        publish(fresh, path);
        return;
      } catch (const std::filesystem::filesystem_error&) {
        // reported below
      }
    }
  }
  std::error_code ignored;
  std::filesystem::remove(fresh, ignored);
  throw error(error_kind::failed, "output.io", path.string(), "the kept records cannot be written",
              "make room or choose another -o; the .pvs file is complete");
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
