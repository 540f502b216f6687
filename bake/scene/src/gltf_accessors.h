#pragma once
// Accessors, buffer views and buffers of a glTF file, checked against the bytes in the file, and decoded where they
// are compressed. Parts that nothing uses are not read.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "accessor.h"
#include "gltf_file.h"
#include "json_object.h"

namespace sightcell::scene {

// A checked buffer view.
struct view_bytes {
  std::uint32_t buffer = 0;
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::uint64_t stride = 0;  // 0: tightly packed
};

// All accessors of a file, which are checked and decoded when they are used first.
class accessor_table {
 public:
  // binary: the binary chunk of a .glb. The other arguments must outlive the table.
  accessor_table(const json_object& root, const gltf_source& source, std::optional<std::vector<std::uint8_t>> binary);

  std::size_t size() const { return accessors_.size(); }
  std::size_t view_count() const { return views_.size(); }
  // Returns a buffer view after checking it; a compressed one is decoded first.
  view_bytes view(std::uint32_t index);
  // Returns the bytes of a buffer view.
  std::span<const std::uint8_t> bytes_of_view(std::uint32_t index);

  // Marks the accessor as used. Throws sightcell::error if its bytes are missing or it has another type.
  void require(const json_object& user, std::uint32_t index, const char* what, std::initializer_list<const char*> types,
               std::initializer_list<int> components);
  std::uint64_t count(std::uint32_t index) const {  // of a used accessor
    return reduced_accessors_[index].at("count").get<std::uint64_t>();
  }
  // Returns the JSON of an accessor.
  const json_object& source(std::uint32_t index) const { return accessors_[index]; }

  // Must be called before a stream is decoded. Each decoded stream is limited by itself; this limits streams that all
  // use the same few bytes. Throws sightcell::error above the limit.
  void count_compressed(const json_object& user, std::uint64_t bytes);

  // Adds an accessor with decoded numbers, floats or std::uint32_t. Returns its index.
  template <typename T>
  std::uint32_t add(const std::vector<T>& values, const char* type, std::uint64_t width) {
    std::vector<std::uint8_t> bytes(values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return add_bytes(std::move(bytes), type, std::is_same_v<T, float> ? 5126 : 5125, values.size() / width);
  }

  // Returns the elements of a used accessor; they point into the buffers.
  accessor_view elements(std::uint32_t index) const;
  // Returns the elements by index; empty for accessors that are not used.
  std::vector<accessor_view> all_elements() const;
  // Writes the accessors into the reduced document under their indices, without content, because tinygltf only checks
  // that they exist.
  void write_stubs(nlohmann::json& reduced) const;
  // Returns the buffers that elements() points into.
  std::vector<std::vector<std::uint8_t>> take_buffers() { return std::move(bytes_); }

 private:
  std::span<const std::uint8_t> buffer(std::uint32_t index);
  std::uint32_t decoded_buffer(std::uint32_t view_index, const json_object& meshopt);
  std::uint32_t add_buffer(std::vector<std::uint8_t> bytes);
  std::uint32_t add_bytes(std::vector<std::uint8_t> bytes, const char* type, int component, std::uint64_t count);
  void use_accessor(std::uint32_t index);
  void use_sparse(const json_object& accessor, std::uint64_t count, std::uint64_t element_size,
                  nlohmann::json& reduced);
  std::span<const std::uint8_t> used_bytes(const nlohmann::json& user) const;
  void use_bytes(const json_object& user, std::uint32_t view_index, std::uint64_t offset, std::uint64_t need);

  const gltf_source& source_;
  std::optional<std::vector<std::uint8_t>> binary_;
  std::vector<json_object> accessors_, views_, buffers_;
  std::vector<nlohmann::json> reduced_accessors_, reduced_views_;  // null until used
  std::map<std::uint32_t, std::uint32_t> decoded_buffers_;         // by compressed view
  std::uint64_t zero_filled_ = 0, compressed_bytes_ = 0;           // so far
  std::vector<std::vector<std::uint8_t>> bytes_;  // by buffer, decoded ones after those of the file; empty until used
};

}  // namespace sightcell::scene
