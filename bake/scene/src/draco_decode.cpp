#include "draco_decode.h"

#include <memory>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#include <draco/compression/decode.h>
#pragma GCC diagnostic pop

namespace sightcell::scene {

std::optional<draco_mesh> decode_draco(std::span<const std::uint8_t> bytes, std::span<const draco_wish> wishes,
                                       std::string& why_not) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) {
    why_not = std::string("Draco says: ") + decoded.status().error_msg();
    return std::nullopt;
  }
  const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
  draco_mesh out;
  out.vertex_count = mesh->num_points();
  out.indices.reserve(std::size_t{3} * mesh->num_faces());
  for (draco::FaceIndex f(0); f < mesh->num_faces(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = mesh->face(f)[k].value();
      if (corner >= out.vertex_count) {
        why_not = "a triangle has a corner that is not there";
        return std::nullopt;
      }
      out.indices.push_back(corner);
    }
  }
  for (const draco_wish& wish : wishes) {
    const draco::PointAttribute* attribute = mesh->GetAttributeByUniqueId(wish.id);
    if (attribute == nullptr || attribute->num_components() != static_cast<int>(wish.width)) {
      why_not = "it has no attribute " + std::to_string(wish.id) + " of " + std::to_string(wish.width) + " components";
      return std::nullopt;
    }
    std::vector<float>& values = out.attributes.emplace_back(std::size_t{out.vertex_count} * wish.width);
    for (draco::PointIndex p(0); p < out.vertex_count; ++p) {
      const draco::AttributeValueIndex at = attribute->mapped_index(p);
      if (at.value() >= attribute->size() ||
          !attribute->ConvertValue<float>(at, static_cast<std::int8_t>(wish.width),
                                          &values[std::size_t{p.value()} * wish.width])) {
        why_not = "attribute " + std::to_string(wish.id) + " cannot be read";
        return std::nullopt;
      }
    }
  }
  return out;
}

}  // namespace sightcell::scene
