#include "row_encoder.h"

namespace sightcell::format {
namespace {

std::size_t varint_size(std::uint32_t value) {
  std::size_t size = 1;
  for (; value >= 0x80u; value >>= 7) ++size;
  return size;
}

void put_varint(std::uint32_t value, std::vector<std::byte>& out) {
  for (; value >= 0x80u; value >>= 7) out.push_back(static_cast<std::byte>((value & 0x7Fu) | 0x80u));
  out.push_back(static_cast<std::byte>(value));
}

// Calls put(gap) and put(length - 1) for every run, as run_stream reads them.
template <class Put>
void for_each_number(std::span<const run> runs, const Put& put) {
  std::uint32_t expected = 0;  // the lowest number the next run may begin with
  for (const run& r : runs) {
    put(r.first - expected);
    put(r.count - 1);
    expected = r.first + r.count + 1;
  }
}

std::size_t runs_size(std::span<const run> runs) {
  std::size_t size = 0;
  for_each_number(runs, [&](std::uint32_t value) { size += varint_size(value); });
  return size;
}

void put_runs(std::span<const run> runs, std::vector<std::byte>& out) {
  for_each_number(runs, [&](std::uint32_t value) { put_varint(value, out); });
}

std::uint32_t to_u32(std::size_t value) {
  return static_cast<std::uint32_t>(value);
}

// a without b, both sets. Appends to out.
void subtract(std::span<const run> a, std::span<const run> b, std::vector<run>& out) {
  std::size_t at = 0;
  for (const run& r : a) {
    std::uint64_t place = r.first;
    const std::uint64_t end = place + r.count;
    while (at < b.size() && std::uint64_t{b[at].first} + b[at].count <= place) ++at;
    for (std::size_t i = at; i < b.size() && b[i].first < end; ++i) {
      if (b[i].first > place) out.push_back({to_u32(place), to_u32(b[i].first - place)});
      place = std::uint64_t{b[i].first} + b[i].count;
    }
    if (place < end) out.push_back({to_u32(place), to_u32(end - place)});
  }
}

}  // namespace

std::vector<run> runs_of(std::span<const std::uint32_t> ascending) {
  std::vector<run> runs;
  for (const std::uint32_t number : ascending) {
    if (!runs.empty() && runs.back().first + runs.back().count == number) {
      ++runs.back().count;
    } else {
      runs.push_back({number, 1});
    }
  }
  return runs;
}

void difference(std::span<const run> reference, std::span<const run> set, std::vector<run>& removed,
                std::vector<run>& added) {
  removed.clear();
  added.clear();
  subtract(reference, set, removed);
  subtract(set, reference, added);
}

std::size_t own_row_size(std::span<const run> set) {
  return varint_size(to_u32(set.size()) << 1) + runs_size(set);
}

std::size_t delta_row_size(std::span<const run> removed, std::span<const run> added) {
  const std::size_t removed_size = runs_size(removed);
  return varint_size(to_u32(removed.size()) << 1 | 1u) + 1 + varint_size(to_u32(added.size())) +
         varint_size(to_u32(removed_size)) + removed_size + runs_size(added);
}

void encode_own_row(std::span<const run> set, std::vector<std::byte>& out) {
  put_varint(to_u32(set.size()) << 1, out);
  put_runs(set, out);
}

void encode_delta_row(std::uint32_t reference, std::span<const run> removed, std::span<const run> added,
                      std::vector<std::byte>& out) {
  put_varint(to_u32(removed.size()) << 1 | 1u, out);
  put_varint(reference, out);
  put_varint(to_u32(added.size()), out);
  put_varint(to_u32(runs_size(removed)), out);
  put_runs(removed, out);
  put_runs(added, out);
}

}  // namespace sightcell::format
