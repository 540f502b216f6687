#pragma once
// One picture after another: camera, lists, lines, panel, and what is counted of them.
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "background_bake.h"
#include "bake_preview.h"
#include "controls.h"
#include "panel.h"
#include "scene_files.h"
#include "scene_renderer.h"
#include "triangle_tree.h"
#include "viewer.h"
#include "walker.h"

namespace viewer {

// GPU time of the scene, known two frames later: nobody waits for it.
class gpu_timer {
 public:
  gpu_timer();
  ~gpu_timer();
  gpu_timer(const gpu_timer&) = delete;
  gpu_timer& operator=(const gpu_timer&) = delete;
  void begin();
  void end();
  double milliseconds() const { return milliseconds_; }

 private:
  std::array<unsigned, 2> queries_{};
  std::size_t frame_ = 0;
  double milliseconds_ = 0.0;
};

// How long the last frames took.
class frame_rate {
 public:
  void add(double milliseconds);
  double per_second() const;

 private:
  std::deque<double> milliseconds_;
};

// Throws sightcell::error (wrong_use) if an option names a cell that the file does not have.
void check_cells(const options& chosen, const baked_scene& baked);

class session {
 public:
  // References must outlive the object. trees: made at the first call of tree().
  session(const options& chosen, const loaded_scene& s, std::unique_ptr<loaded_file> file, scene_renderer& renderer,
          float text_scale);

  controls& state() { return state_; }
  panel& over() { return panel_; }
  const baked_scene& baked() const { return file_->baked; }
  // Whether the last frame is as the one before: nothing moved and nothing was pressed.
  bool still() const { return still_; }
  // How long the last frame took, with all of its work and without waiting for something to happen.
  void took(double milliseconds);
  void show_message(const std::string& text) { facts_.message = text; }

  // After step: walks, goes to cells, begins and ends a freeze.
  void follow();
  void go_to(const fly_camera& camera);
  void go_to_cell(std::uint32_t cell);
  // Draws one frame. whole: with the complete map, for pictures.
  void draw(std::uint32_t width, std::uint32_t height, bool whole);
  // Draws the scene alone, all of it or what the set keeps.
  void draw_scene(bool pvs, std::uint32_t width, std::uint32_t height);
  // Chooses a brightness for a scene whose textures are dark because it comes without its lights.
  void brighten(std::uint32_t width, std::uint32_t height);
  // Draws the full scene and the set, without lines and panel. Returns how many pixels differ.
  std::uint64_t count_wrong_pixels(std::uint32_t width, std::uint32_t height);
  // Replaces the file; the camera stays where it is, unless it is outside of all cells and there were none before.
  void replace(std::unique_ptr<loaded_file> file);
  // Shows this bake in the panel, and its finished cells on the map. It must outlive the object.
  // file_exists: the file that it would write is there.
  void follow_bake(const background_bake& bake, bool file_exists);

  const frame_facts& facts() const { return facts_; }
  const sightcell_frame& here() const { return file_->lists.here(); }
  double move_milliseconds() const { return file_->lists.move_milliseconds(); }
  // What was drawn last, as one object.
  nlohmann::json report() const;

 private:
  chosen_lists lists_for(bool pvs, bool tint, const view_volume* volume);
  cell_map* map_to_show();
  void go_where_clicked(std::uint32_t number);
  std::vector<segment> lines(float aspect) const;
  const triangle_tree& tree();

  const loaded_scene& scene_;
  std::unique_ptr<loaded_file> file_;
  scene_renderer& renderer_;
  std::optional<triangle_tree> tree_;
  walker walker_;
  panel panel_;
  controls state_;
  fly_camera frozen_camera_;
  bool was_frozen_ = false, was_walking_ = false;
  fly_camera last_camera_;
  bool still_ = false;
  gpu_timer timer_;
  frame_rate rate_;
  frame_facts facts_;
  frame_history history_;
  std::optional<bake_preview> preview_;  // while a bake runs
  std::uint32_t visited_ = 0, last_cell_ = SIGHTCELL_NO_CELL;
};

}  // namespace viewer
