#pragma once
// A .pvs file with the scene that it was baked from, for checks of the file against the scene: its visibility rules,
// and a ray scene that is built from the import.
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
#include "trace/viewpoint_region.h"
#include "volumes/stored_volumes.h"

namespace sightcell::bake {

class verified_file {
 public:
  // cells_from: the scene of the cells if it is another one, else null.
  // References must outlive the object. Throws sightcell::error if the file is damaged or was baked from other
  // scenes.
  verified_file(const scene::scene& s, const scene::scene* cells_from, std::span<const std::byte> file,
                const std::string& name);
  verified_file(const verified_file&) = delete;  // rays_ refers to a member
  verified_file& operator=(const verified_file&) = delete;

  // Flattens the scene with the settings of the bake and builds the ray scene on the calling thread's TBB arena.
  // Polygons from file().polygon_count() on are of the other scene and in no set.
  void build_rays();

  const format::reader& file() const { return file_; }
  const stored_rules& rules() const { return rules_; }
  const ray_scene& rays() const { return *rays_; }  // after build_rays()

  // Writes the set of a cell to seen, ascending source ids. Throws sightcell::error if that part of the file is
  // damaged.
  void cell_set(std::uint32_t cell, std::vector<std::uint32_t>& seen);
  // Does the same with volumes after the polygons, numbered from file().polygon_count() on.
  void cell_items(std::uint32_t cell, std::vector<std::uint32_t>& items);
  // Returns the visibility volumes of the file.
  stored_volumes volumes() const;
  // Returns the box of a cell, without the margin.
  box cell_box(std::uint32_t cell) const;
  // Returns the part of the grown box of a cell that its certificate is about.
  // Throws sightcell::error "pvs.broken" if it is damaged.
  viewpoint_region region(std::uint32_t cell) const;

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
