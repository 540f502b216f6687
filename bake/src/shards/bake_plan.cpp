#include "shards/bake_plan.h"

#include <xxhash.h>

#include <bit>
#include <span>
#include <utility>

#include "sightcell/base/error.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/writer.h"

namespace sightcell::bake {
namespace {

void put(std::string& out, std::uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) out.push_back(static_cast<char>(value >> (8 * i)));
}

void put(std::string& out, std::string_view text) {
  put(out, text.size(), 8);
  out += text;
}

// Reading past the end returns zeros and sets good to false.
struct reader {
  std::string_view bytes;
  bool good = true;

  std::uint64_t number(std::size_t count) {
    if (bytes.size() < count) {
      good = false;
      return 0;
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i) value |= std::uint64_t{static_cast<std::uint8_t>(bytes[i])} << (8 * i);
    bytes.remove_prefix(count);
    return value;
  }
  std::uint32_t number32() { return static_cast<std::uint32_t>(number(4)); }
  std::string_view text() {
    const std::uint64_t size = number(8);
    good = good && size <= bytes.size();
    if (!good) return {};
    const std::string_view out = bytes.substr(0, size);
    bytes.remove_prefix(size);
    return out;
  }
  // Returns the number of records of this size that follow; 0 if the bytes are too few for them.
  std::uint64_t count_of(std::size_t record) {
    const std::uint64_t count = number(4);
    good = good && count <= bytes.size() / record;
    return good ? count : 0;
  }
};

// Facts, draw table, named groups, volumes and settings are encoded as a .pvs file without cells.
std::string file_without_cells(const pvs_frame& frame) {
  format::file_contents contents;
  contents.facts = frame.facts;
  contents.draws = frame.draws;
  contents.named_groups = frame.named_groups;
  contents.cell_sets = format::sets_of({});
  contents.settings = frame.settings;
  contents.volumes = {{frame.volume_width, frame.volume_width}, frame.volumes};
  std::vector<std::byte> bytes;
  if (format::encode(contents, bytes) != format::status::ok)
    throw error(error_kind::failed, "output.encode", frame.scene_name,
                "its draws or settings exceed the limits of the format", "report this scene");
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool read_frame(std::string_view bytes, pvs_frame& frame) {
  format::reader file;
  if (format::reader::open(std::as_bytes(std::span(bytes)), file) != format::status::ok) return false;
  frame.facts = file.facts();
  frame.settings = file.settings();
  frame.draws.resize(file.draw_count());
  for (std::uint32_t i = 0; i < file.draw_count(); ++i)
    if (file.draw(i, frame.draws[i]) != format::status::ok) return false;
  for (std::uint32_t group = 0; group < file.named_groups().count(); ++group) {
    std::string_view name;
    if (!file.named_groups().name(group, name)) return false;
    frame.named_groups.emplace_back(name);
  }
  frame.volume_width = file.volumes().shape().width;
  frame.volumes.resize(file.volumes().count());
  for (std::uint32_t volume = 0; volume < frame.volumes.size(); ++volume)
    if (!file.volumes().place(volume, frame.volumes[volume])) return false;
  return true;
}

void put_later_parts(std::string& out, const pvs_frame& frame) {
  const draw_identity& identity = frame.identity;
  if (frame.clusters.empty() && identity.hashes.empty()) return;
  put(out, frame.clusters.size(), 4);
  for (const std::uint32_t number : frame.clusters) put(out, number, 4);
  put(out, identity.hashes.size(), 4);
  for (const std::uint64_t hash : identity.hashes) put(out, hash, 8);
  for (const auto* names : {&identity.node_names, &identity.mesh_names}) {
    put(out, names->size(), 4);
    for (const std::string& name : *names) put(out, name);
  }
}

// Plans of bakes without clusters and names end before these parts.
void read_later_parts(reader& in, pvs_frame& frame) {
  if (in.bytes.empty()) return;
  frame.clusters.resize(in.count_of(4));
  for (std::uint32_t& number : frame.clusters) number = in.number32();
  frame.identity.hashes.resize(in.count_of(8));
  for (std::uint64_t& hash : frame.identity.hashes) hash = in.number(8);
  for (auto* names : {&frame.identity.node_names, &frame.identity.mesh_names}) {
    names->resize(in.count_of(8));
    for (std::string& name : *names) name = in.text();
  }
}

}  // namespace

bake_plan plan_of(pvs_frame frame, const cell_blocks& blocks) {
  bake_plan plan;
  plan.frame = std::move(frame);
  for (std::uint32_t cell = 0; cell < blocks.cell_count(); ++cell) plan.block_of.push_back(blocks.block_of(cell));
  for (std::uint32_t block = 0; block < blocks.count(); ++block) plan.block_names.push_back(blocks.name_of(block));
  return plan;
}

std::string encode(const bake_plan& plan) {
  std::string out;
  put(out, file_without_cells(plan.frame));
  put(out, plan.frame.scene_name);
  put(out, plan.frame.seed, 8);
  put(out, plan.frame.cells.size(), 4);
  for (const format::box& b : plan.frame.cells)
    for (const auto* corner : {&b.min, &b.max})
      for (const float value : *corner) put(out, std::bit_cast<std::uint32_t>(value), 4);
  for (const std::uint32_t block : plan.block_of) put(out, block, 4);
  put(out, plan.block_names.size(), 4);
  for (const std::string& name : plan.block_names) put(out, name);
  put_later_parts(out, plan.frame);
  put(out, XXH3_64bits(out.data(), out.size()), 8);
  return out;
}

bake_plan decode_plan(std::string_view bytes, const std::string& file) {
  bake_plan plan;
  const std::size_t body = bytes.size() < 8 ? 0 : bytes.size() - 8;
  reader tail{bytes.substr(body)}, in{bytes.substr(0, body)};
  bool good = bytes.size() >= 8 && tail.number(8) == XXH3_64bits(bytes.data(), body);
  good = good && read_frame(in.text(), plan.frame);
  plan.frame.scene_name = in.text();
  plan.frame.seed = in.number(8);
  plan.frame.cells.resize(in.count_of(28));  // box and block
  for (format::box& b : plan.frame.cells)
    for (auto* corner : {&b.min, &b.max})
      for (float& value : *corner) value = std::bit_cast<float>(in.number32());
  for (std::size_t i = 0; i < plan.frame.cells.size(); ++i) plan.block_of.push_back(in.number32());
  plan.block_names.resize(in.count_of(8));
  for (std::string& name : plan.block_names) name = in.text();
  read_later_parts(in, plan.frame);
  const std::size_t clustered = plan.frame.clusters.size();
  good = good && (clustered == 0 || clustered == plan.frame.facts.polygon_count);
  for (const std::uint32_t block : plan.block_of) good = good && block < plan.block_names.size();
  if (!good || !in.good || !in.bytes.empty())
    throw error(error_kind::bad_input, "shard.damaged", file, "is damaged", "bake that shard again");
  return plan;
}

}  // namespace sightcell::bake
