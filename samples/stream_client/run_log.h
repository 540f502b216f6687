#pragma once
// What a run writes while it goes on, for measurements: frames and requests as CSV files, pictures along a walk.
#include <fstream>
#include <string>

#include "report.h"
#include "sightcell/picture/picture.h"
#include "sightcell/stream.h"

namespace stream_client {

struct log_settings {
  std::string frames, requests;   // CSV files; empty: none
  std::string pictures;           // folder; empty: none
  float picture_distance = 1.0f;  // meters of the walk between two pictures
};

class run_log {
 public:
  // speed: of the walk, meters per second.
  // Fails with client.log.
  run_log(const log_settings& settings, float speed);

  // A frame. seconds: since the run began; walked: of the walk.
  void frame(double seconds, double walked, const sightcell_stream_frame& frame, const report& so_far);

  // A request. name: of the file, next to scene.front.
  void request(double seconds, const std::string& name);

  // Returns the seconds of the walk at which the next picture is to be taken; infinity without pictures.
  double next_picture() const;

  // Writes this picture, with its number as its name.
  void picture(const sightcell::picture::image_rgba& drawn);

 private:
  log_settings settings_;
  double picture_seconds_;
  std::size_t pictures_ = 0;
  std::ofstream frames_, requests_;
};

}  // namespace stream_client
