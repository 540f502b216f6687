#pragma once
// Where Sightcell is hooked in: one view that follows the camera, and what it says, in the forms in which engines draw.
// An engine takes one of them; all are here to be compared.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine_scene.h"
#include "gl_buffer.h"
#include "sightcell/sightcell.hpp"

namespace engine_hook {

// glDrawElements of one unit.
struct draw_call {
  std::uint32_t unit = 0, first_index = 0, index_count = 0;
};

// Sorted by batch.
struct draw_list {
  GLuint indices = 0;  // 0: the index buffer of each batch
  std::vector<draw_call> calls;
};

// Indirect draws of one batch, one behind the other in the buffer of commands.
struct command_run {
  std::uint32_t batch = 0, first = 0, count = 0;
};

struct command_list {
  GLuint buffer = 0;
  std::vector<command_run> runs;
  std::uint64_t polygons = 0;
};

// Every unit, whole: what is drawn without visibility, and where nothing is known.
draw_list everything(const engine_scene& engine);

class visible_set {
 public:
  // References must outlive the object. min_gap: of the commands.
  visible_set(const engine_scene& engine, const sightcell::db& db, const std::string& pvs_file, std::uint32_t min_gap);

  // Every frame. The lists follow only when what is to be drawn has changed.
  void move(const std::array<float, 3>& eye);

  bool changed() const { return (frame_.flags & SIGHTCELL_FRAME_CHANGED) != 0; }
  bool draws_all() const { return (frame_.flags & SIGHTCELL_FRAME_DRAW_ALL) != 0; }

  const draw_list& index_list() const { return draws_all() ? all_ : index_list_; }
  const draw_list& objects() const { return draws_all() ? all_ : objects_; }  // instanced ones only
  // Needs no other list under DRAW_ALL: then the runtime has written one command per unit.
  const command_list& commands() const { return commands_; }

 private:
  void write_index_list();
  void write_commands();
  void read_objects();

  const engine_scene& engine_;
  std::string pvs_file_;
  std::uint32_t min_gap_;
  sightcell::view view_;
  sightcell_frame frame_{};
  draw_list all_, index_list_, objects_;
  command_list commands_;
  gl_buffer index_buffer_, command_buffer_;
  std::vector<sightcell_range> ranges_;            // room for info.range_bound, made once
  std::vector<sightcell_command> command_memory_;  // likewise
  std::vector<std::uint64_t> bits_;
};

}  // namespace engine_hook
