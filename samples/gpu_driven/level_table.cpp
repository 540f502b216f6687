#include "level_table.h"

#include <bit>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <span>

#include "sightcell/base/error.h"

namespace gpu_driven {
namespace {

constexpr std::size_t header_bytes = 32, range_bytes = 16, least_meshlet_bytes = 64, least_group_bytes = 32;
constexpr std::size_t least_link_bytes = 8;
constexpr std::uint32_t magic = 0x4C4D4353, version_with_levels = 2;

// Little-endian numbers of a table. Throws where it ends before them.
class table_bytes {
 public:
  table_bytes(std::vector<char> bytes, std::string file) : bytes_(std::move(bytes)), file_(std::move(file)) {}

  std::uint32_t number(std::size_t at) const {
    require(at % 4 == 0 && bytes_.size() >= 4 && at <= bytes_.size() - 4);
    std::uint32_t out = 0;
    for (std::size_t k = 4; k-- > 0;) out = out << 8 | static_cast<unsigned char>(bytes_[at + k]);
    return out;
  }
  float real(std::size_t at) const { return std::bit_cast<float>(number(at)); }

  void require(bool holds) const {
    if (holds) return;
    throw sightcell::error(sightcell::error_kind::bad_input, "gpu-driven.levels", file_,
                           "has a table of meshlets that contradicts itself", "pack the scene again");
  }

 private:
  std::vector<char> bytes_;
  std::string file_;
};

[[noreturn]] void throw_no_levels(const std::string& file) {
  throw sightcell::error(sightcell::error_kind::bad_input, "gpu-driven.no-levels", file,
                         "has no levels of detail in clusters",
                         "write it with sightcell pack --meshlets --levels, and bake what that writes");
}

// Returns the bytes of the buffer view with the table.
std::vector<char> table_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  const std::vector<char> glb{std::istreambuf_iterator<char>(in), {}};
  const table_bytes all(glb, file);
  if (glb.size() < 20 || all.number(0) != 0x46546C67) throw_no_levels(file);
  const std::size_t text_bytes = all.number(12);
  if (text_bytes > glb.size() - 20) throw_no_levels(file);
  const auto text = glb.begin() + 20;
  const auto json = nlohmann::json::parse(text, text + static_cast<std::ptrdiff_t>(text_bytes), nullptr, false);
  const nlohmann::json::json_pointer where("/extras/sightcell/meshlets/bufferView");
  if (json.is_discarded() || !json.contains(where)) throw_no_levels(file);
  try {
    const nlohmann::json& view = json.at("bufferViews").at(json.at(where).get<std::size_t>());
    const std::size_t binary = 20 + text_bytes + 8;
    const std::size_t offset = view.value("byteOffset", std::size_t{0}), bytes = view.at("byteLength");
    all.require(binary <= glb.size() && offset <= glb.size() - binary && bytes <= glb.size() - binary - offset);
    const auto first = glb.begin() + static_cast<std::ptrdiff_t>(binary + offset);
    return {first, first + static_cast<std::ptrdiff_t>(bytes)};
  } catch (const nlohmann::json::exception&) {
    all.require(false);
    throw;
  }
}

// Where the parts of the table begin. docs/meshlets.md has its bytes.
class level_reader {
 public:
  level_reader(const table_bytes& table, std::size_t levels) : table_(table) {
    groups_ = table.number(8);
    leaves_ = table.number(12);
    group_bytes_ = table.number(16);
    coarse_ = table.number(levels);
    level_groups_ = table.number(levels + 4);
    indices_ = table.number(levels + 8);
    meshlet_bytes_ = table.number(levels + 12);
    level_group_bytes_ = table.number(levels + 16);
    link_bytes_ = table.number(levels + 20);
    table.require(meshlet_bytes_ >= least_meshlet_bytes && level_group_bytes_ >= least_group_bytes &&
                  link_bytes_ >= least_link_bytes);
    ranges_at_ = levels + header_bytes;
    coarse_at_ = ranges_at_ + range_bytes * groups_;
    level_groups_at_ = coarse_at_ + meshlet_bytes_ * coarse_;
    links_at_ = level_groups_at_ + level_group_bytes_ * level_groups_;
    indices_at_ = links_at_ + link_bytes_ * (std::size_t{leaves_} + coarse_);
    if (indices_ > 0) static_cast<void>(table.number(indices_at_ + std::size_t{4} * (indices_ - 1)));
  }

  level_table read() const {
    level_table out;
    for (std::uint32_t g = 0; g < groups_; ++g) {
      const std::size_t group = header_bytes + group_bytes_ * g;
      primitive_levels made = read_primitive(g, table_.number(group + 8), table_.number(group + 12));
      if (!made.groups.empty()) out.emplace(std::pair(table_.number(group), table_.number(group + 4)), std::move(made));
    }
    return out;
  }

 private:
  primitive_levels read_primitive(std::uint32_t g, std::uint32_t first_leaf, std::uint32_t leaves) const {
    const std::size_t range = ranges_at_ + range_bytes * g;
    const std::uint32_t first_coarse = table_.number(range), coarse = table_.number(range + 4);
    const std::uint32_t first_group = table_.number(range + 8), groups = table_.number(range + 12);
    table_.require(is_part(first_leaf, leaves, leaves_) && first_coarse >= leaves_ &&
                   is_part(first_coarse - leaves_, coarse, coarse_) && is_part(first_group, groups, level_groups_));
    primitive_levels out{.leaves = leaves, .links = {}, .groups = {}, .coarse_triangles = {}, .coarse_indices = {}};
    for (std::uint32_t c = 0; c < leaves + coarse; ++c) {
      const std::size_t link = links_at_ + link_bytes_ * (c < leaves ? first_leaf + c : first_coarse + c - leaves);
      level_links own{group_in(table_.number(link), first_group, groups),
                      group_in(table_.number(link + 4), first_group, groups)};
      table_.require((own.made_by == no_level_group) == (c < leaves));
      table_.require(c < leaves || own.member_of > own.made_by);  // none is the greatest number
      out.links.push_back(own);
    }
    for (std::uint32_t i = 0; i < groups; ++i) {
      const std::size_t at = level_groups_at_ + level_group_bytes_ * (first_group + i);
      out.groups.push_back({table_.real(at + 16), table_.real(at + 20), table_.real(at + 24), table_.real(at + 28),
                            table_.real(at + 12)});
    }
    for (std::uint32_t c = 0; c < coarse; ++c) {
      const std::size_t at = coarse_at_ + meshlet_bytes_ * (first_coarse - leaves_ + c);
      const std::uint32_t first = table_.number(at + 4), triangles = table_.number(at + 8);
      table_.require(first <= indices_ && triangles <= (indices_ - first) / 3);
      out.coarse_triangles.push_back(triangles);
      for (std::uint32_t i = first; i < first + 3 * triangles; ++i)
        out.coarse_indices.push_back(table_.number(indices_at_ + std::size_t{4} * i));
    }
    return out;
  }

  static bool is_part(std::uint32_t first, std::uint32_t count, std::uint32_t all) {
    return first <= all && count <= all - first;
  }

  std::uint32_t group_in(std::uint32_t number, std::uint32_t first, std::uint32_t count) const {
    if (number == no_level_group) return number;
    table_.require(number >= first && number - first < count);
    return number - first;
  }

  const table_bytes& table_;
  std::uint32_t groups_ = 0, leaves_ = 0, coarse_ = 0, level_groups_ = 0, indices_ = 0;
  std::size_t group_bytes_ = 0, meshlet_bytes_ = 0, level_group_bytes_ = 0, link_bytes_ = 0;
  std::size_t ranges_at_ = 0, coarse_at_ = 0, level_groups_at_ = 0, links_at_ = 0, indices_at_ = 0;
};

}  // namespace

level_table read_levels(const std::string& file) {
  const table_bytes table(table_of(file), file);
  table.require(table.number(0) == magic);
  if (table.number(4) != version_with_levels) throw_no_levels(file);
  return level_reader(table, table.number(24)).read();
}

}  // namespace gpu_driven
