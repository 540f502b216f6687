#include "draco_decode.h"

#include <memory>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#pragma GCC diagnostic pop

namespace sightcell::scene {
namespace {

// Limit on claims of a stream. A flat regular grid of a million triangles takes a byte for 6 triangles and 3 points,
// real meshes one byte for half a triangle.
constexpr std::uint64_t elements_per_byte = 64;
constexpr std::uint64_t free_elements = std::uint64_t{1} << 16;

// Returns the cause if the header claims too much; else nothing. Draco allocates what the header claims before it
// reads the rest. Streams that cannot be read here are rejected by Draco.
std::optional<std::string> problem_with_header(std::span<const std::uint8_t> bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::DracoHeader header{};
  if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return std::nullopt;
  if (header.version_major != 2 || header.version_minor != 2) {  // other versions encode numbers in other ways
    return "its bitstream is " + std::to_string(header.version_major) + "." + std::to_string(header.version_minor) +
           ", and glTF has 2.2";
  }
  buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
  draco::GeometryMetadata metadata;
  if ((header.flags & METADATA_FLAG_MASK) != 0 && !draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata))
    return std::nullopt;
  std::uint8_t traversal = 0;
  if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING && !buffer.Decode(&traversal)) return std::nullopt;
  std::uint32_t one = 0, other = 0;  // triangles and points, in the order of the method
  if (!draco::DecodeVarint(&one, &buffer) || !draco::DecodeVarint(&other, &buffer)) return std::nullopt;
  const std::uint64_t elements = std::uint64_t{one} + other;
  if (elements <= free_elements + elements_per_byte * bytes.size()) return std::nullopt;
  return "it claims " + std::to_string(elements) + " triangles and points in " + std::to_string(bytes.size()) +
         " bytes";
}

}  // namespace

std::optional<draco_mesh> decode_draco(std::span<const std::uint8_t> bytes, std::span<const draco_wish> wishes,
                                       std::string& why_not) {
  if (const auto problem = problem_with_header(bytes)) {
    why_not = *problem;
    return std::nullopt;
  }
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) {
    why_not = std::string("Draco reports: ") + decoded.status().error_msg();
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
        why_not = "a triangle has a corner that does not exist";
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
