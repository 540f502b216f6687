#include "meshopt_decode.h"

#include <meshoptimizer.h>

namespace sightcell::scene {
namespace {

// Returns the smallest number of bytes that a stream of this many elements can have: the vertex codec uses two bits
// for 16 equal bytes, the index codecs one byte per triangle or index.
std::uint64_t least_bytes(const meshopt_stream& stream) {
  if (stream.mode == "ATTRIBUTES") return stream.count * stream.stride / 64;
  return stream.mode == "TRIANGLES" ? stream.count / 3 : stream.count;
}

const char* problem_with(const meshopt_stream& s) {
  constexpr std::uint64_t count_limit = std::uint64_t{1} << 32;
  if (s.count >= count_limit) return "its count is out of range";
  if (s.mode == "ATTRIBUTES") {
    if (s.stride == 0 || s.stride > 256 || s.stride % 4 != 0) return "its byteStride is not 4 to 256 in steps of 4";
  } else if (s.mode == "TRIANGLES" || s.mode == "INDICES") {
    if (s.stride != 2 && s.stride != 4) return "its byteStride is neither 2 nor 4";
    if (s.mode == "TRIANGLES" && s.count % 3 != 0) return "its count is not of whole triangles";
  } else {
    return "its mode is unknown";
  }
  const bool filtered = s.filter != "NONE";
  if (filtered && s.mode != "ATTRIBUTES") return "indices have no filter";
  if (s.filter == "OCTAHEDRAL"   ? s.stride != 4 && s.stride != 8
      : s.filter == "QUATERNION" ? s.stride != 8
                                 : filtered && s.filter != "EXPONENTIAL")
    return "its filter is unknown or does not fit the byteStride";
  return nullptr;
}

}  // namespace

std::optional<std::vector<std::uint8_t>> decode_meshopt(const meshopt_stream& stream,
                                                        std::span<const std::uint8_t> bytes, std::string& why_not) {
  if (const char* problem = problem_with(stream)) {
    why_not = problem;
    return std::nullopt;
  }
  if (least_bytes(stream) > bytes.size()) {
    why_not = "it claims more elements than its bytes can hold";
    return std::nullopt;
  }
  std::vector<std::uint8_t> out(stream.count * stream.stride);
  int failure = 0;
  if (stream.mode == "ATTRIBUTES") {
    failure = meshopt_decodeVertexBuffer(out.data(), stream.count, stream.stride, bytes.data(), bytes.size());
  } else if (stream.mode == "TRIANGLES") {
    failure = meshopt_decodeIndexBuffer(out.data(), stream.count, stream.stride, bytes.data(), bytes.size());
  } else {
    failure = meshopt_decodeIndexSequence(out.data(), stream.count, stream.stride, bytes.data(), bytes.size());
  }
  if (failure != 0) {
    why_not = "its bytes are damaged";
    return std::nullopt;
  }
  if (stream.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), stream.count, stream.stride);
  if (stream.filter == "QUATERNION") meshopt_decodeFilterQuat(out.data(), stream.count, stream.stride);
  if (stream.filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), stream.count, stream.stride);
  return out;
}

}  // namespace sightcell::scene
