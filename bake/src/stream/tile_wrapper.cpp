#include "stream/tile_wrapper.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>
#include <vector>

#include "sightcell/base/json_text.h"
#include "stream/instance_attributes.h"
#include "stream/short_number.h"

namespace sightcell::bake {
namespace {

using nlohmann::ordered_json;

// CesiumJS and three.js, on which 3d-tiles-renderer is built, both read EXT_mesh_gpu_instancing: it is how 3D Tiles 1.1
// replaces the instanced tiles of 1.0. Instances are one draw call for all places, where nodes are one for each: 705
// instead of 6,016 in intel_castle. From this number on, they also are shorter than nodes with a matrix each.
constexpr std::size_t least_instances = 4;
constexpr std::size_t page_buffer = 0, decoded_buffer = 1, instance_buffer = 2;

struct page_document {
  ordered_json json;
  std::size_t binary = 0;  // where its BIN chunk has its first byte

  explicit page_document(std::span<const std::byte> glb) {
    std::size_t size = 0;
    for (std::size_t k = 4; k-- > 0;) size = size << 8 | std::to_integer<std::size_t>(glb[12 + k]);
    json = scene::parse_ordered_json({reinterpret_cast<const char*>(&glb[20]), size});
    binary = 20 + size + 8;
  }
};

// Indices of one primitive of the page that one material shows.
struct shown_range {
  std::uint32_t primitive = 0, material = 0;
  std::size_t first = 0, count = 0;
};

// What is shown in the same places, by their numbers: the primitives of one mesh.
using ranges_by_places = std::map<std::vector<std::uint32_t>, std::vector<shown_range>>;

// Adds indices. Neighbors with one material become one range, which is one draw call.
void add_range(std::vector<shown_range>& ranges, const shown_range& added) {
  const auto before = std::find_if(ranges.rbegin(), ranges.rend(), [&](const shown_range& r) {
    return r.primitive == added.primitive && r.material == added.material && r.first + r.count == added.first;
  });
  if (before != ranges.rend())
    before->count += added.count;
  else
    ranges.push_back(added);
}

class wrapper_writer {
 public:
  wrapper_writer(std::span<const std::byte> page, const std::string& uri, const scene::gltf_pager& pager,
                 const shown_draws& shown, const tile_materials& materials)
      : page_(page), bytes_(page.size()), uri_(uri), pager_(pager), shown_(shown), materials_(materials) {}

  std::string write() {
    const auto meshes = page_.json.find("meshes");
    if (meshes == page_.json.end()) return "";
    const ordered_json& primitives = meshes->at(0).at("primitives");
    for (std::uint32_t p = 0; p < primitives.size(); ++p) read_primitive(primitives[p], p);
    if (by_places_.empty()) return "";
    number_materials();
    for (const auto& [places, ranges] : by_places_) {
      ordered_json list = ordered_json::array();
      for (const shown_range& range : ranges) list.push_back(primitive_of(primitives[range.primitive], range));
      meshes_.push_back({{"primitives", std::move(list)}});
      add_nodes(places);
    }
    return document().dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  }

 private:
  // Finds the draws of each geometry of a primitive.
  void read_primitive(const ordered_json& primitive, std::uint32_t number) {
    const ordered_json& pairs = primitive.at("extras").at("sightcell");
    std::size_t first = 0;
    std::uint32_t geometry = 0;
    for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
      geometry += pairs[i].get<std::uint32_t>() + (i > 0 ? 1u : 0u);
      const std::size_t count = 3 * pairs[i + 1].get<std::size_t>();
      std::map<std::uint32_t, std::vector<std::uint32_t>> places_by_material;
      for (const std::uint32_t draw : shown_.of(geometry))
        places_by_material[pager_.content().draws[draw].material].push_back(shown_.place_of(draw));
      for (auto& [material, places] : places_by_material) {
        std::sort(places.begin(), places.end());
        add_range(by_places_[places], {number, material, first, count});
      }
      first += count;
    }
  }

  void number_materials() {
    for (const auto& [places, ranges] : by_places_)
      for (const shown_range& range : ranges)
        if (range.material != scene::no_index && number_of_material_.try_emplace(range.material, 0).second)
          used_materials_.push_back(range.material);
    std::sort(used_materials_.begin(), used_materials_.end());
    for (std::size_t i = 0; i < used_materials_.size(); ++i) number_of_material_[used_materials_[i]] = i;
  }

  ordered_json primitive_of(const ordered_json& of_page, const shown_range& range) {
    ordered_json out;
    for (const auto& [name, accessor] : of_page.at("attributes").items())
      out["attributes"][name] = accessor_as_in_page(accessor.get<std::size_t>());
    ordered_json indices = page_.json.at("accessors").at(of_page.at("indices").get<std::size_t>());
    constexpr int unsigned_int = 5125;
    const std::size_t width = indices.at("componentType") == unsigned_int ? 4 : 2;
    indices["bufferView"] = view_as_in_page(indices.at("bufferView").get<std::size_t>());
    if (range.first > 0) indices["byteOffset"] = range.first * width;
    indices["count"] = range.count;
    out["indices"] = accessors_.size();
    accessors_.push_back(std::move(indices));
    if (range.material != scene::no_index) out["material"] = number_of_material_.at(range.material);
    return out;
  }

  std::size_t accessor_as_in_page(std::size_t number) {
    const auto [found, is_new] = number_of_accessor_.try_emplace(number, accessors_.size());
    if (is_new) {
      ordered_json accessor = page_.json.at("accessors").at(number);
      accessor["bufferView"] = view_as_in_page(accessor.at("bufferView").get<std::size_t>());
      accessors_.push_back(std::move(accessor));
    }
    return found->second;
  }

  std::size_t view_as_in_page(std::size_t number) {
    const auto [found, is_new] = number_of_view_.try_emplace(number, views_.size());
    if (is_new) {
      ordered_json view = page_.json.at("bufferViews").at(number);
      ordered_json& packed = view.at("extensions").at("EXT_meshopt_compression");
      packed["buffer"] = page_buffer;
      packed["byteOffset"] = page_.binary + packed.value("byteOffset", std::size_t{0});
      view["buffer"] = decoded_buffer;
      views_.push_back(std::move(view));
    }
    return found->second;
  }

  // Adds the nodes of the last mesh.
  void add_nodes(const std::vector<std::uint32_t>& places) {
    const std::size_t mesh = meshes_.size() - 1;
    std::vector<instance_place> instances;
    std::vector<std::uint32_t> others;
    for (const std::uint32_t place : places) {
      if (const auto instance = instance_place_of(shown_.matrix_at(place)))
        instances.push_back(*instance);
      else
        others.push_back(place);
    }
    if (instances.size() < least_instances) {
      instances.clear();
      others = places;
    }
    if (!instances.empty()) instanced_.push_back({mesh, std::move(instances)});
    for (const std::uint32_t place : others) {
      nodes_.push_back({{"mesh", mesh}});
      put_transform(shown_.matrix_at(place), nodes_.back());
    }
  }

  static void put_transform(const draw_matrix& m, ordered_json& node) {
    constexpr draw_matrix none = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    if (m == none) return;
    if (std::equal(m.begin(), m.begin() + 9, none.begin())) {
      node["translation"] = {short_json(m[9]), short_json(m[10]), short_json(m[11])};
      return;
    }
    ordered_json matrix = ordered_json::array();
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t r = 0; r < 3; ++r) matrix.push_back(short_json(m[3 * c + r]));
      matrix.push_back(c == 3 ? 1 : 0);
    }
    node["matrix"] = std::move(matrix);
  }

  ordered_json document() {
    instance_bytes instances;
    for (const auto& [mesh, places] : instanced_) {
      ordered_json extension = instances.add(places, views_.size(), accessors_);
      nodes_.push_back({{"mesh", mesh}, {"extensions", std::move(extension)}});
    }
    ordered_json out{{"asset", {{"version", "2.0"}}}};
    materials_.put(used_materials_, out);
    for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
      for (const ordered_json& name : page_.json.at(key)) out[key].push_back(name);
      if (!instanced_.empty()) out[key].push_back("EXT_mesh_gpu_instancing");
    }
    out["buffers"] = {{{"uri", uri_}, {"byteLength", bytes_}}, page_.json.at("buffers").at(decoded_buffer)};
    if (!instanced_.empty()) {
      out["buffers"].push_back({{"uri", instances.data_uri()}, {"byteLength", instances.size()}});
      views_.push_back({{"buffer", instance_buffer}, {"byteLength", instances.size()}});
    }
    out["bufferViews"] = std::move(views_);
    out["accessors"] = std::move(accessors_);
    out["meshes"] = std::move(meshes_);
    std::vector<std::size_t> roots(nodes_.size());
    for (std::size_t i = 0; i < roots.size(); ++i) roots[i] = i;
    out["nodes"] = std::move(nodes_);
    out["scenes"] = {{{"nodes", roots}}};
    out["scene"] = 0;
    return out;
  }

  page_document page_;
  std::size_t bytes_;
  const std::string& uri_;
  const scene::gltf_pager& pager_;
  const shown_draws& shown_;
  const tile_materials& materials_;
  ranges_by_places by_places_;
  std::vector<std::uint32_t> used_materials_;
  std::map<std::uint32_t, std::size_t> number_of_material_;
  std::map<std::size_t, std::size_t> number_of_accessor_, number_of_view_;  // by their numbers in the page
  std::vector<std::pair<std::size_t, std::vector<instance_place>>> instanced_;
  ordered_json accessors_ = ordered_json::array(), views_ = ordered_json::array();
  ordered_json meshes_ = ordered_json::array(), nodes_ = ordered_json::array();
};

}  // namespace

std::string tile_wrapper(std::span<const std::byte> page, const std::string& uri, const scene::gltf_pager& pager,
                         const shown_draws& shown, const tile_materials& materials) {
  return wrapper_writer(page, uri, pager, shown, materials).write();
}

}  // namespace sightcell::bake
