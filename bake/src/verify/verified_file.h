#pragma once
// A .pvs file and the scene that it was baked from, for who checks the one against the other: what the bake was told of
// seeing, and rays that are built anew from the import.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "file/stored_rules.h"
#include "sightcell/base/box.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/scene/scene.h"
#include "trace/ray_scene.h"
#include "volumes/stored_volumes.h"

namespace sightcell::bake {

class verified_file {
 public:
  // References must outlive the object. cells_from: the scene of the cells where that is another one, else null. Throws
  // sightcell::error where the file is broken or of other scenes.
  verified_file(const scene::scene& s, const scene::scene* cells_from, std::span<const std::byte> file,
                const std::string& name);
  verified_file(const verified_file&) = delete;  // rays point into it
  verified_file& operator=(const verified_file&) = delete;

  // Flattens what the bake saw as it did, and builds the rays: on the calling thread's TBB arena. Polygons from
  // file().polygon_count() on are of the other scene and in no set.
  void build_rays();

  const format::reader& file() const { return file_; }
  const stored_rules& rules() const { return rules_; }
  const ray_scene& rays() const { return *rays_; }  // when they are built

  // Of a cell that there is. seen: ascending source ids. Throws where its part of the file is damaged.
  void cell_set(std::uint32_t cell, std::vector<std::uint32_t>& seen);
  // The same with volumes behind the polygons, from file().polygon_count() on.
  void cell_items(std::uint32_t cell, std::vector<std::uint32_t>& items);
  stored_volumes volumes() const;
  box cell_box(std::uint32_t cell) const;

 private:
  const scene::scene& scene_;
  const scene::scene* cells_from_;
  const std::string& name_;
  format::reader file_;
  format::set_reader sets_;
  stored_rules rules_;
  scene::world_geometry geometry_;
  std::optional<ray_scene> rays_;
};

}  // namespace sightcell::bake
