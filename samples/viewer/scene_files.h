#pragma once
// The scene in memory, and what belongs to one version of its .pvs file.
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "baked_scene.h"
#include "cell_map.h"
#include "draw_lists.h"
#include "sightcell/scene/scene.h"
#include "visible_lists.h"

namespace viewer {

// The scene without its images and meshes, which are on the device.
struct loaded_scene {
  sightcell::scene::scene facts;
  sightcell::scene::world_geometry world;
};

// One version of the .pvs file and all that follows from it.
struct loaded_file {
  loaded_file(const loaded_scene& s, baked_scene opened)
      : baked(std::move(opened)),
        groups(s.facts, baked.draws),
        lists(baked, groups, s.world.positions),
        map(baked, s.world) {}

  baked_scene baked;
  draw_groups groups;
  visible_lists lists;
  cell_map map;
};

// A version of the scene, and the file that was baked of it.
struct opened_scene {
  std::unique_ptr<loaded_scene> scene;
  baked_scene baked;
};

// Opens both. number: which scene of the glTF file; -1: its default.
// Throws sightcell::error (bad_input) if one is broken, or the .pvs file is of another version.
opened_scene open_scene(const std::string& scene_file, int number, const std::string& pvs_file,
                        const std::string& cells_file);

// Notices that a file has changed. Asks the file system once per second at most.
class file_watch {
 public:
  explicit file_watch(std::string file) : file_(std::move(file)), last_(now()), asked_(clock::now()) {}
  // Returns true once after each change. A file that is gone has not changed.
  bool changed();

 private:
  using clock = std::chrono::steady_clock;
  struct stamp {
    std::filesystem::file_time_type time{};
    std::uintmax_t size = 0;
    bool operator==(const stamp&) const = default;
  };
  std::optional<stamp> now() const;

  std::string file_;
  std::optional<stamp> last_;
  clock::time_point asked_;
};

}  // namespace viewer
