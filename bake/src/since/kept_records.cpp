#include "since/kept_records.h"

#include <xxhash.h>
#include <zlib.h>

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

constexpr char magic[8] = {'S', 'C', 'K', 'E', 'P', 'T', '0', '3'};
constexpr std::size_t checksum_size = 8;
constexpr std::size_t polygons_of_part = 16384;
constexpr std::size_t bytes_of_polygon = 2 * sizeof(std::uint64_t) + sizeof(triangle);
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

// The polygons in deflated parts, so that a damaged count requests no more memory than the file has parts.
void put_polygons(std::vector<std::uint8_t>& out, const polygon_table& table) {
  const std::size_t count = table.names.size();
  put(out, static_cast<std::uint64_t>(count));
  std::vector<std::uint8_t> part, deflated;
  for (std::size_t first = 0; first < count; first += polygons_of_part) {
    const std::size_t size = std::min(polygons_of_part, count - first);
    part.clear();
    put(part, &table.names[first], size * sizeof(table.names[0]));
    put(part, &table.near[first], size * sizeof(table.near[0]));
    put(part, &table.corners[first], size * sizeof(table.corners[0]));
    uLongf length = compressBound(static_cast<uLong>(part.size()));
    deflated.resize(length);
    (void)compress2(deflated.data(), &length, part.data(), static_cast<uLong>(part.size()), Z_BEST_SPEED);
    put_list(out, std::span(deflated).first(length));
  }
}

bool take_polygons(records_reader& in, polygon_table& table) {
  const auto count = in.take<std::uint64_t>();
  if (count >= scene::no_index) return false;
  std::vector<std::uint8_t> part;
  for (std::uint64_t first = 0; first < count; first += polygons_of_part) {
    const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(polygons_of_part, count - first));
    const auto deflated = in.take_list();
    part.resize(size * bytes_of_polygon);
    uLongf length = static_cast<uLongf>(part.size());
    if (!in.good || uncompress(part.data(), &length, deflated.data(), static_cast<uLong>(deflated.size())) != Z_OK ||
        length != part.size())
      return false;
    records_reader from{part};
    const auto add = [&](auto& list) {
      const std::size_t before = list.size();
      list.resize(before + size);
      std::memcpy(&list[before], from.take_bytes(size * sizeof(list[0])).data(), size * sizeof(list[0]));
    };
    add(table.names);
    add(table.near);
    add(table.corners);
  }
  return in.good;
}

std::vector<std::uint8_t> bytes_of(const kept_records& records) {
  std::vector<std::uint8_t> out(std::begin(magic), std::end(magic));
  put_list(out, {reinterpret_cast<const std::uint8_t*>(records.key.data()), records.key.size()});
  put_polygons(out, records.polygons);
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
  if (!take_polygons(in, records.polygons)) return std::nullopt;
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
