#pragma once
// Time that the device spends on the stages of hemicubes, from timestamps in the stream of commands. For benchmarks:
// each timestamp makes the device wait for the stage before it, so stages do not overlap.
#include <epoxy/gl.h>

#include <cstddef>
#include <string>
#include <vector>

namespace sightcell::bake {

class gpu_timeline {
 public:
  struct stage {
    std::string name;
    double seconds = 0.0;  // sum over all hemicubes
  };

  gpu_timeline() = default;
  ~gpu_timeline();
  gpu_timeline(const gpu_timeline&) = delete;
  gpu_timeline& operator=(const gpu_timeline&) = delete;

  // Nothing is recorded before this is called, so a source with an idle timeline is as quick as one without.
  void enable() { enabled_ = true; }
  // Begins a hemicube.
  void start();
  // Ends a stage, which began where the last one ended. name: a literal; stages with equal names are added up.
  void end(const char* name);
  // Waits for the device. Stages in the order of their first use.
  std::vector<stage> stages() const;

 private:
  void record(const char* name);
  struct mark {
    const char* name;  // null: the beginning of a hemicube
    GLuint query;
  };
  bool enabled_ = false;
  std::vector<mark> marks_;
};

}  // namespace sightcell::bake
