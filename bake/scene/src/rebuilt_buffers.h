#pragma once
// Gives a changed document one buffer that has all it uses and nothing else.
#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "gltf_accessors.h"
#include "stripped_meshes.h"

namespace sightcell::scene {

using carried_images = std::vector<std::pair<std::size_t, std::vector<std::uint8_t>>>;  // by number in images

class rebuilt_buffers {
 public:
  // Numbers accessors and buffer views anew. Each accessor has a view of its own, without sparse elements and without
  // compression; accessors of the same bytes share one.
  // document: changed. Its images are those of `images`.
  // root, table: of the file. added: accessors that the file has not.
  // room_bytes: size of one more buffer view, whose bytes the caller writes; 0: none.
  // All references must outlive the object.
  // Throws sightcell::error (bad_input).
  rebuilt_buffers(nlohmann::json& document, const json_object& root, accessor_table& table,
                  const added_accessors& added, const carried_images& images, const std::string& file,
                  std::uint64_t room_bytes = 0);

  std::uint64_t bytes() const { return bytes_; }        // of the buffer, a multiple of 4
  std::size_t room_view() const { return room_view_; }  // the number of the view of room_bytes
  std::uint64_t room_offset() const { return pieces_[room_view_].offset; }
  // into: bytes() bytes, zero.
  void write(std::span<std::byte> into) const;

 private:
  // Where a view of the buffer comes from.
  struct piece {
    std::uint64_t offset = 0, size = 0;
    std::span<const std::uint8_t> bytes;  // as they are; else the elements of an accessor
    accessor_view elements;
    std::size_t stride = 0;
  };

  void renumber_accessors(nlohmann::json& document);
  nlohmann::json rebuilt_accessor(const nlohmann::json& source, std::size_t number, int target);
  void renumber_views(nlohmann::json& document);
  std::size_t add_piece(piece made, std::size_t byte_stride, int target);
  std::size_t index_of(const nlohmann::json& value, std::size_t size, const char* section) const;

  const json_object& root_;
  accessor_table& table_;
  const added_accessors& added_;
  const std::string& file_;
  std::vector<piece> pieces_;
  // By the elements: where they begin, how many, their distance and size in the file; their distance here,
  // and the target of the view.
  std::map<std::tuple<const std::uint8_t*, std::size_t, std::size_t, std::size_t, std::size_t, int>, std::size_t>
      views_of_elements_;
  std::uint64_t bytes_ = 0;
  std::size_t room_view_ = 0;
  std::vector<nlohmann::json> views_;
};

}  // namespace sightcell::scene
