#pragma once
// A bake of the scene by `sightcell bake` in another process, while the window stays in use.
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace viewer {

// A cell whose bound the bake has proved.
struct finished_cell {
  glm::vec3 min{0.0f}, max{0.0f};  // meters
  std::uint32_t polygons = 0;
  float bound = 1.0f;
  float seconds = -1.0f;  // that the bake took for it; negative if an earlier bake has begun it
  glm::vec3 middle() const { return 0.5f * (min + max); }
};

// What to bake. Its file appears when the bake is complete.
struct bake_command {
  std::string scene_file;
  int scene = -1;          // of the glTF file; -1: its default
  std::string cells_file;  // empty: the bake places the cells
  std::string output;      // the .pvs file
};

class background_bake {
 public:
  enum class step { idle, running, done, failed, stopped };

  explicit background_bake(bake_command command) : command_(std::move(command)) {}
  // Ends the process. What it has finished stays on the disk, and the same bake resumes.
  ~background_bake();
  background_bake(const background_bake&) = delete;
  background_bake& operator=(const background_bake&) = delete;

  // Starts a process, unless one runs. A failure to start is a failed bake.
  // quality: draft, normal or final. After a bake of another quality, what that one left unfinished is discarded.
  void start(const std::string& quality);
  // Asks the process to end. It ends within a second.
  void stop();
  // Takes what the process has written. Never waits. Returns true once, when a bake has come to its end with a file.
  bool poll();

  step now() const { return step_; }
  const std::string& quality() const { return quality_; }  // of the last start
  const std::string& output() const { return command_.output; }
  const std::string& phase() const { return phase_; }  // "baking cells"
  // Part of the phases before the first cell that is done, 0 .. 1.
  double prepared() const { return prepared_; }
  std::uint32_t cells() const { return cells_; }  // finished
  std::uint32_t cells_total() const { return cells_total_; }
  double seconds_left() const { return seconds_left_; }  // 0: unknown
  const std::string& error() const { return error_; }    // of a failed bake: the last line that it wrote
  // In the order in which they came.
  const std::vector<finished_cell>& finished() const { return finished_; }

 private:
  void take(const std::string& line);
  void take_progress(const std::string& line);
  void read_all();
  void close_pipe();
  void end(int wait_status);

  const bake_command command_;
  std::string quality_, phase_, error_, last_message_, rest_;
  step step_ = step::idle;
  int process_ = -1;  // its pid
  int pipe_ = -1;     // standard error of the process
  std::uint32_t cells_ = 0, cells_total_ = 0;
  double prepared_ = 0.0, seconds_left_ = 0.0;
  std::vector<finished_cell> finished_;
};

// Returns the program `sightcell`: beside this program, else in PATH ("sightcell").
std::filesystem::path bake_program();

// Returns where a bake of a scene writes if nothing else is asked for: level.pvs for level.glb.
std::string file_beside(const std::string& scene_file);

}  // namespace viewer
