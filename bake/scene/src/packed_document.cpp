#include "packed_document.h"

#include <xxhash.h>

#include <algorithm>
#include <map>
#include <span>

#include "gltf_numbers.h"
#include "json_object.h"
#include "world_point.h"

namespace sightcell::scene {
namespace {

using nlohmann::json;

std::uint64_t aligned(std::uint64_t offset) {
  return (offset + 3) / 4 * 4;
}

std::string hex(std::span<const std::uint8_t> bytes) {
  std::string out;
  for (const std::uint8_t byte : bytes)
    for (const int shift : {4, 0}) out += "0123456789abcdef"[byte >> shift & 15];
  return out;
}

json vec3_json(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}

class document_writer {
 public:
  document_writer(const scene& s, const packed_order& order, const packed_vertices& vertices,
                  const carried_materials& materials, const packed_places& places,
                  const std::vector<object_switches>& switches)
      : scene_(s), order_(order), vertices_(vertices), materials_(materials), places_(places), switches_(switches) {}

  json write() {
    out_ = materials_.sections;
    out_["asset"] = {{"version", "2.0"}, {"generator", "sightcell pack"}};
    if (!materials_.copyright.empty()) out_["asset"]["copyright"] = materials_.copyright;
    out_["asset"]["extras"]["sightcell"] = {{"scene", hex(scene_.fingerprint)}, {"order", order_hash()}};
    out_["buffers"] = json::array({{{"byteLength", places_.bytes}}});
    if (vertices_.count() > 0) write_vertices();
    for (std::size_t i = 0; i < materials_.images.size(); ++i) {
      const auto& [number, bytes] = materials_.images[i];
      out_["images"][number]["bufferView"] = add_view(places_.images[i], bytes.size());
    }
    for (std::size_t g = 0; g < order_.groups.size(); ++g) write_group(g);
    json roots = json::array();
    for (std::size_t g = 0; g < order_.groups.size(); ++g)
      if (first_draw(g).lod_object == no_index) roots.push_back(g);
    write_levels(roots);
    out_["scenes"] = json::array({{{"nodes", roots}}});
    out_["scene"] = 0;
    return std::move(out_);
  }

 private:
  // Returns a hash of the order, because another bake of the same scene has another order, and a packed file fits one
  // order only.
  std::string order_hash() const {
    XXH64_canonical_t canonical;
    XXH64_canonicalFromHash(&canonical, XXH3_64bits(order_.source_of_stored.data(),
                                                    order_.source_of_stored.size() * sizeof(std::uint32_t)));
    return hex(canonical.digest);
  }

  std::size_t add_view(std::uint64_t offset, std::uint64_t bytes) {
    out_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
    return out_["bufferViews"].size() - 1;
  }

  void write_vertices() {
    for (const vertex_column& column : vertices_.columns()) {
      const std::size_t view = add_view(column.offset, std::uint64_t{vertices_.count()} * column.width * sizeof(float));
      out_["bufferViews"][view]["target"] = array_buffer;
      column_accessors_[column.name] = out_["accessors"].size();
      out_["accessors"].push_back({{"bufferView", view},
                                   {"componentType", float_type},
                                   {"count", vertices_.count()},
                                   {"type", vector_type(column.width)}});
    }
    out_["accessors"][0]["min"] = vec3_json(vertices_.min());
    out_["accessors"][0]["max"] = vec3_json(vertices_.max());
    index_view_ = add_view(places_.indices, std::uint64_t{scene_.polygon_count} * 12);
    out_["bufferViews"][index_view_]["target"] = element_array_buffer;
  }

  const draw& first_draw(std::size_t group) const { return scene_.draws[order_.groups[group].draws.front()]; }

  void write_group(std::size_t number) {
    const packed_group& group = order_.groups[number];
    const draw& first = first_draw(number);
    json node = {{"name", "group " + std::to_string(number)}};
    if (group.moves) {
      if (first.node < scene_.node_names.size() && !scene_.node_names[first.node].empty())
        node["name"] = scene_.node_names[first.node];
      // The source of the draw, so that the host finds the animation that moves it.
      node["extras"]["source"] = {
          {"node", first.node}, {"mesh", first.mesh}, {"primitive", first.primitive}, {"instance", first.instance}};
      if (first.to_world != glm::dmat4(1.0) && is_finite(first.to_world))
        for (int i = 0; i < 16; ++i) node["matrix"].push_back(first.to_world[i / 4][i % 4]);
    }
    json marks = marks_of(group);
    if (!marks.empty()) node["extras"]["sightcell"] = std::move(marks);
    if (group.polygon_count > 0) {
      node["mesh"] = out_.contains("meshes") ? out_["meshes"].size() : 0;
      out_["meshes"].push_back({{"primitives", json::array({primitive_of(group)})}});
    }
    out_["nodes"].push_back(std::move(node));
  }

  json primitive_of(const packed_group& group) {
    json attributes = {{"POSITION", 0}};
    for (const std::uint32_t number : group.draws)
      for (const auto& [name, width] : vertices_.attributes_of(number)) attributes[name] = column_accessors_.at(name);
    json primitive = {{"attributes", std::move(attributes)}, {"indices", out_["accessors"].size()}};
    const std::uint32_t material = scene_.draws[group.draws.front()].material;
    if (material != no_index) primitive["material"] = material;
    out_["accessors"].push_back({{"bufferView", index_view_},
                                 {"byteOffset", std::uint64_t{group.first_stored} * 12},
                                 {"componentType", unsigned_int_type},
                                 {"count", std::uint64_t{group.polygon_count} * 3},
                                 {"type", "SCALAR"}});
    return primitive;
  }

  // Returns the marks that all draws of a group share, because a node has one set of marks.
  json marks_of(const packed_group& group) const {
    const auto all = [&](auto has) {
      return std::all_of(group.draws.begin(), group.draws.end(),
                         [&](std::uint32_t number) { return has(scene_.draws[number].tags); });
    };
    json marks = json::object();
    const draw_tags& first = scene_.draws[group.draws.front()].tags;
    if (all([](const draw_tags& t) { return !t.occluder; })) marks["occluder"] = false;
    if (all([](const draw_tags& t) { return t.dynamic; })) marks["dynamic"] = true;
    if (all([](const draw_tags& t) { return t.always; })) marks["always"] = true;
    if (all([](const draw_tags& t) { return t.never; })) marks["never"] = true;
    if (first.group != no_index && all([&](const draw_tags& t) { return t.group == first.group; }))
      marks["group"] = scene_.groups[first.group];
    return marks;
  }

  // Writes objects with levels of detail as further nodes after the groups, one node per level.
  void write_levels(json& roots) {
    std::map<std::uint32_t, std::map<std::uint32_t, json>> objects;  // groups by object and level
    for (std::size_t g = 0; g < order_.groups.size(); ++g) {
      const draw& d = first_draw(g);
      if (d.lod_object != no_index)
        objects[d.lod_object].try_emplace(d.lod_level, json::array()).first->second.push_back(g);
    }
    for (const auto& [object, levels] : objects) {
      const std::size_t finest = out_["nodes"].size();
      for (const auto& [level, groups] : levels) {
        roots.push_back(out_["nodes"].size());
        out_["nodes"].push_back(
            {{"name", "object " + std::to_string(object) + " level " + std::to_string(level)}, {"children", groups}});
      }
      std::vector<level_switch> begins;
      const object_switches known = object < switches_.size() ? switches_[object] : object_switches{};
      for (const auto& [level, groups] : levels)
        if (level > 0) begins.push_back(level <= known.begins.size() ? known.begins[level - 1] : level_switch{});
      write_switches(finest, begins, known.least_coverage);
    }
    const auto is_extended = [](const json& node) { return node.contains("extensions"); };
    if (std::none_of(out_["nodes"].begin(), out_["nodes"].end(), is_extended)) return;
    json& used = out_["extensionsUsed"];
    if (std::find(used.begin(), used.end(), "MSFT_lod") == used.end()) used.push_back("MSFT_lod");
  }

  // Names the coarser levels of an object, whose nodes follow the finest one, and where they begin. MSFT_lod has
  // coverages for all of its levels or for none, so the others have level_of, which readers put behind them.
  void write_switches(std::size_t finest, const std::vector<level_switch>& begins, float least_coverage) {
    const bool covered = !begins.empty() && begins.front().below_coverage.has_value();
    const auto named = std::find_if(begins.begin(), begins.end(), [&](const level_switch& one) {
      return one.from_distance.has_value() || one.below_coverage.has_value() != covered;
    });
    json ids = json::array(), coverages = json::array();
    for (auto one = begins.begin(); one != begins.end(); ++one) {
      const std::size_t node = finest + 1 + static_cast<std::size_t>(one - begins.begin());
      if (one < named) {
        ids.push_back(node);
        if (covered) coverages.push_back(*one->below_coverage);
        continue;
      }
      json& marks = out_["nodes"][node]["extras"]["sightcell"];
      marks["level_of"] = out_["nodes"][finest]["name"];
      if (one->from_distance) marks["from_distance"] = *one->from_distance;
    }
    if (ids.empty()) return;
    out_["nodes"][finest]["extensions"]["MSFT_lod"]["ids"] = std::move(ids);
    if (!covered) return;
    coverages.push_back(least_coverage);
    out_["nodes"][finest]["extras"]["MSFT_screencoverage"] = std::move(coverages);
  }

  const scene& scene_;
  const packed_order& order_;
  const packed_vertices& vertices_;
  const carried_materials& materials_;
  const packed_places& places_;
  const std::vector<object_switches>& switches_;
  json out_;
  std::map<std::string, std::size_t> column_accessors_;
  std::size_t index_view_ = 0;
};

}  // namespace

packed_places places_of(const scene& s, const packed_vertices& vertices, const carried_materials& materials) {
  packed_places places;
  places.indices = vertices.bytes();
  std::uint64_t end = places.indices + std::uint64_t{s.polygon_count} * 12;
  for (const auto& [number, bytes] : materials.images) {
    places.images.push_back(end);
    end = aligned(end + bytes.size());
  }
  places.bytes = end;
  return places;
}

json packed_document(const scene& s, const packed_order& order, const packed_vertices& vertices,
                     const carried_materials& materials, const packed_places& places,
                     const std::vector<object_switches>& switches) {
  return document_writer(s, order, vertices, materials, places, switches).write();
}

}  // namespace sightcell::scene
