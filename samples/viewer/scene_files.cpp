#include "scene_files.h"

#include <system_error>

namespace viewer {

opened_scene open_scene(const std::string& scene_file, int number, const std::string& pvs_file,
                        const std::string& cells_file) {
  opened_scene opened;
  opened.scene = std::make_unique<loaded_scene>(loaded_scene{sightcell::scene::load_gltf(scene_file, number), {}});
  opened.scene->world = sightcell::scene::flatten(opened.scene->facts);
  opened.baked = open_baked(opened.scene->facts, opened.scene->world, pvs_file, cells_file);
  return opened;
}

std::optional<file_watch::stamp> file_watch::now() const {
  if (file_.empty()) return std::nullopt;
  std::error_code no_time, no_size;
  const stamp found{std::filesystem::last_write_time(file_, no_time), std::filesystem::file_size(file_, no_size)};
  if (no_time || no_size) return std::nullopt;
  return found;
}

bool file_watch::changed() {
  if (file_.empty() || clock::now() - asked_ < std::chrono::seconds(1)) return false;
  asked_ = clock::now();
  const std::optional<stamp> found = now();
  if (!found || found == last_) return false;
  last_ = found;
  return true;
}

}  // namespace viewer
