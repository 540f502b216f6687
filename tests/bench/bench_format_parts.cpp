// bench_format_parts FILE.pvs --json OUT.json: bytes of the rows of an exact file with and without each part of the
// format: the polygon order, rows that are differences, slack. Bytes are of rows, chunk directory and code tables.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "code_table_writer.h"
#include "reference_choice.h"
#include "row_chunk_encoder.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/set_reader.h"
#include "stored_sets.h"

namespace {

using namespace sightcell::format;

void require(status s, const char* what) {
  if (s != status::ok) throw std::runtime_error(std::string(what) + ": " + status_text(s));
}

struct corpus {
  file_parts parts;
  std::vector<std::vector<std::uint32_t>> sets;
};

corpus read(const char* path, std::vector<std::byte>& bytes) {
  std::ifstream in(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto raw = std::as_bytes(std::span(text));
  bytes.assign(raw.begin(), raw.end());
  reader file;
  set_reader sets;
  corpus out;
  require(reader::open(bytes, file), path);
  require(take_apart(file, out.parts), path);
  require(sets.open(file), path);
  out.sets.resize(file.cell_count());
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) require(sets.source_ids(cell, out.sets[cell]), path);
  return out;
}

// Draws and polygons as the source has them.
file_parts in_source_order(file_parts parts) {
  std::sort(parts.draws.begin(), parts.draws.end(), [](const draw_record& a, const draw_record& b) {
    return std::pair(a.first_source, a.polygon_count) < std::pair(b.first_source, b.polygon_count);
  });
  parts.orders.clear();
  parts.order_of_draw.clear();
  for (draw_record& d : parts.draws) {
    d.first_stored = d.first_source;
    parts.order_of_draw.push_back(static_cast<std::uint32_t>(parts.orders.size()));
    std::vector<std::uint32_t>& order = parts.orders.emplace_back(d.polygon_count);
    std::iota(order.begin(), order.end(), 0u);
  }
  return parts;
}

// Of a file that the writer makes.
std::uint64_t bytes_of_rows(const file_parts& parts, const corpus& all, double slack) {
  file_contents contents = parts.contents(sets_of(all.sets));
  contents.slack = slack;
  std::vector<std::byte> bytes;
  require(encode(contents, bytes), "encode");
  reader file;
  require(reader::open(bytes, file), "open");
  std::uint64_t sum = 0;
  for (std::uint32_t i = 0; i < file.section_count(); ++i) {
    section_record s;
    require(file.section(i, s), "section");
    const bool counts = s.id == layout::section_rows || s.id == layout::section_row_directory ||
                        s.id == layout::section_borders || s.id == layout::section_codes;
    sum += counts ? s.size : 0;
  }
  return sum;
}

// The same where no row is a difference.
std::uint64_t bytes_of_own_rows(const file_parts& parts, const corpus& all) {
  stored_sets stored(parts.draws, parts.order_of_draw, parts.orders);
  std::vector<std::vector<std::vector<run>>> chunks;
  std::vector<chunk_plan> plans;
  row_counts counts;
  std::vector<std::uint64_t> members;
  for (std::size_t begin = 0; begin < all.sets.size(); begin += layout::cells_per_block) {
    auto& sets = chunks.emplace_back(std::min<std::size_t>(all.sets.size() - begin, layout::cells_per_block));
    for (std::size_t i = 0; i < sets.size(); ++i) stored.runs_of(all.sets[begin + i], members, sets[i]);
    chunk_plan& plan = plans.emplace_back();
    for (const std::uint32_t first : first_equal(sets)) plan.same.push_back(static_cast<std::uint8_t>(first));
    plan.reference.assign(sets.size(), chunk_plan::alone);
    count_chunk(sets, plan, counts);
  }
  const row_encoders encoders(counts);
  std::vector<std::byte> bytes;
  for (std::size_t chunk = 0; chunk < chunks.size(); ++chunk)
    encode_chunk(chunks[chunk], plans[chunk], encoders, bytes);
  put_code_lengths(encoders.own.gap_lengths(), bytes);
  put_code_lengths(encoders.own.more_lengths(), bytes);
  return bytes.size() + chunks.size() * layout::chunk_record_size;
}

nlohmann::ordered_json measured(const file_parts& parts, const corpus& all) {
  return {{"own", bytes_of_own_rows(parts, all)},
          {"differences", bytes_of_rows(parts, all, 0.0)},
          {"slack", bytes_of_rows(parts, all, 0.05)}};
}

void measure(const char* path, const char* out) {
  std::vector<std::byte> bytes;
  const corpus all = read(path, bytes);
  if (all.parts.facts.slack > 0.0f) throw std::runtime_error(std::string(path) + " holds slack");
  const nlohmann::ordered_json result{{"stored_order", measured(all.parts, all)},
                                      {"source_order", measured(in_source_order(all.parts), all)}};
  std::ofstream(out) << result.dump(1) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4 || std::string(argv[2]) != "--json") {
    std::fprintf(stderr, "usage: bench_format_parts FILE.pvs --json OUT.json\n");
    return 2;
  }
  try {
    measure(argv[1], argv[3]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_format_parts: %s\n", e.what());
    return 1;
  }
  return 0;
}
