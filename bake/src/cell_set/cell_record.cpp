#include "cell_set/cell_record.h"

#include <xxhash.h>

#include <bit>

#include "cell_set/set_bytes.h"

namespace sightcell::bake {
namespace {

constexpr std::size_t checksum_size = 8;

void put_witnesses(std::vector<std::uint8_t>& out, const cell_record& record) {
  put_varint(out, record.witnesses.size());
  for (const glm::vec3& eye : record.witnesses)
    for (int axis = 0; axis < 3; ++axis) put_bytes(out, std::bit_cast<std::uint32_t>(eye[axis]), 4);
  const std::vector<std::uint32_t>& of = record.witness_of;
  put_varint(out, of.size());
  for (std::size_t i = 0; i < of.size();) {
    const std::size_t end = end_of_run(of, i, [](std::uint32_t a, std::uint32_t b) { return a == b; });
    put_varint(out, of[i]);
    put_varint(out, end - i - 1);
    i = end;
  }
}

void take_witnesses(byte_reader& in, cell_record& record) {
  const std::uint64_t eyes = in.take_varint();
  for (std::uint64_t i = 0; in.good && i < eyes; ++i) {
    glm::vec3 eye{0.0f};
    for (int axis = 0; axis < 3; ++axis) eye[axis] = std::bit_cast<float>(static_cast<std::uint32_t>(in.take(4)));
    record.witnesses.push_back(eye);
  }
  const std::uint64_t count = in.take_varint();
  if (count != 0 && count != record.set.size()) in.fail();
  while (in.good && record.witness_of.size() < count) {
    const std::uint64_t eye = in.take_varint(), length = in.take_varint() + 1;
    if (eye >= eyes || length > count - record.witness_of.size()) in.fail();
    if (in.good) record.witness_of.insert(record.witness_of.end(), length, static_cast<std::uint32_t>(eye));
  }
}

void put_bound_rays(std::vector<std::uint8_t>& out, const bound_rays& of) {
  put_varint(out, of.number);
  put_varint(out, of.name);
  put_varint(out, of.parts.size());
  for (const std::uint64_t rays : of.parts) put_varint(out, rays);
}

void take_bound_rays(byte_reader& in, bound_rays& of) {
  of.number = static_cast<std::uint32_t>(in.take_varint());
  of.name = static_cast<std::uint32_t>(in.take_varint());
  const std::uint64_t parts = in.take_varint();
  if (parts > in.bytes.size()) in.fail();
  for (std::uint64_t i = 0; in.good && i < parts; ++i) of.parts.push_back(in.take_varint());
}

// Returns a reader of the bytes between version and checksum; nothing if one of the two is wrong.
std::optional<byte_reader> body_of(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < checksum_size) return std::nullopt;
  const std::span<const std::uint8_t> body = bytes.first(bytes.size() - checksum_size);
  byte_reader tail{bytes.last(checksum_size)};
  if (tail.take(checksum_size) != XXH3_64bits(body.data(), body.size())) return std::nullopt;
  byte_reader in{body};
  if (in.take(1) != record_version) return std::nullopt;
  return in;
}

constexpr std::uint64_t has_volumes = 8, is_out_of_time = 16;  // bits of the flags

// Reads the plain fields. Returns the flags.
std::uint64_t take_plain_fields(byte_reader& in, cell_record& record) {
  const std::uint64_t flags = in.take(1);
  record.stored = (flags & 1) != 0;
  record.bound_met = (flags & 2) != 0;
  record.geometry_inside = (flags & 4) != 0;
  record.out_of_time = (flags & is_out_of_time) != 0;
  record.rays = in.take(8);
  record.misses = in.take(8);
  record.upper_bound = in.take_double();
  record.confidence = in.take_double();
  record.rays_spent = in.take(8);
  record.samples = static_cast<std::uint32_t>(in.take(4));
  record.valid_share = in.take_double();
  record.batches = static_cast<std::uint32_t>(in.take(4));
  record.unverified = in.take_varint();
  for (std::uint32_t& count : record.found) count = static_cast<std::uint32_t>(in.take_varint());
  for (std::uint32_t& count : record.growth) count = static_cast<std::uint32_t>(in.take_varint());
  record.outside_share = in.take_double();
  record.seconds = in.take_double();
  return flags;
}

}  // namespace

cell_summary summary_of(const cell_record& record) {
  return {record.stored, record.geometry_inside, record.bound_met, record.rays,
          record.misses, record.upper_bound,     record.set.size()};
}

std::vector<std::uint8_t> encode(const cell_record& record) {
  std::vector<std::uint8_t> out;
  out.push_back(record_version);
  out.push_back(static_cast<std::uint8_t>(
      (record.stored ? 1 : 0) | (record.bound_met ? 2 : 0) | (record.geometry_inside ? 4 : 0) |
      (record.volumes.empty() ? 0 : has_volumes) | (record.out_of_time ? is_out_of_time : 0)));
  put_bytes(out, record.rays, 8);
  put_bytes(out, record.misses, 8);
  put_bytes(out, std::bit_cast<std::uint64_t>(record.upper_bound), 8);
  put_bytes(out, std::bit_cast<std::uint64_t>(record.confidence), 8);
  put_bytes(out, record.rays_spent, 8);
  put_bytes(out, record.samples, 4);
  put_bytes(out, std::bit_cast<std::uint64_t>(record.valid_share), 8);
  put_bytes(out, record.batches, 4);
  put_varint(out, record.unverified);
  for (const std::uint32_t count : record.found) put_varint(out, count);
  for (const std::uint32_t count : record.growth) put_varint(out, count);
  put_bytes(out, std::bit_cast<std::uint64_t>(record.outside_share), 8);
  put_bytes(out, std::bit_cast<std::uint64_t>(record.seconds), 8);
  put_set(out, record.set);
  put_witnesses(out, record);
  put_varint(out, record.region.size());
  out.insert(out.end(), record.region.begin(), record.region.end());
  put_varint(out, record.eyes.size());
  for (const auto& eye : record.eyes)
    for (const std::uint16_t steps : eye) put_bytes(out, steps, 2);
  put_set(out, record.late);
  if (!record.volumes.empty()) put_set(out, record.volumes);
  put_bound_rays(out, record.of_bound);
  put_bytes(out, XXH3_64bits(out.data(), out.size()), checksum_size);
  return out;
}

std::optional<cell_record> decode(std::span<const std::uint8_t> bytes) {
  std::optional<byte_reader> in = body_of(bytes);
  if (!in) return std::nullopt;
  cell_record record;
  const std::uint64_t flags = take_plain_fields(*in, record);
  take_set(*in, record.set);
  take_witnesses(*in, record);
  const std::uint64_t region_bytes = in->take_varint();
  if (region_bytes > in->bytes.size()) return std::nullopt;
  record.region.assign(in->bytes.begin(), in->bytes.begin() + static_cast<std::ptrdiff_t>(region_bytes));
  in->bytes = in->bytes.subspan(region_bytes);
  const std::uint64_t eyes = in->take_varint();
  if (eyes > in->bytes.size()) return std::nullopt;
  record.eyes.resize(eyes);
  for (auto& eye : record.eyes)
    for (std::uint16_t& steps : eye) steps = static_cast<std::uint16_t>(in->take(2));
  take_set(*in, record.late);
  if ((flags & has_volumes) != 0) take_set(*in, record.volumes);
  take_bound_rays(*in, record.of_bound);
  if (!in->good || !in->bytes.empty()) return std::nullopt;
  return record;
}

std::optional<cell_summary> decode_summary(std::span<const std::uint8_t> bytes) {
  std::optional<byte_reader> in = body_of(bytes);
  if (!in) return std::nullopt;
  cell_record record;
  take_plain_fields(*in, record);
  cell_summary summary = summary_of(record);
  summary.polygons = in->take_varint();
  if (!in->good) return std::nullopt;
  return summary;
}

}  // namespace sightcell::bake
