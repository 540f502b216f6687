#pragma once
// A client of one front: requests, retries, decoding, memory and drawing.
#include <array>
#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "decoders.h"
#include "gl_thread.h"
#include "owners.h"
#include "renderer.h"
#include "report.h"
#include "resident_files.h"
#include "run_log.h"
#include "transfers.h"
#include "walk.h"

namespace stream_client {

struct client_settings {
  transfer_settings network;
  unsigned decode_threads = 2;
  unsigned attempts = 6;                         // per file
  std::chrono::milliseconds first_backoff{250};  // doubles with each failure
  std::chrono::milliseconds longest_backoff{8000};
  std::uint64_t memory = std::uint64_t{512} << 20;
  bool wait = false;       // the camera moves on only while its cell is complete
  float lookahead = 2.0f;  // seconds of movement whose cells are loaded ahead
  std::uint32_t width = 960, height = 540;
  bool draw = true;
  std::filesystem::path save;  // folder for files that have been checked; empty: none
  log_settings log;
};

inline constexpr const char* front_name = "scene.front";
inline constexpr std::uint64_t most_front_bytes = 64 << 20;

// Where transfers of all sessions of a run report to: results of an earlier session are dropped.
struct shared_run {
  const client_settings& settings;
  doorbell& bell;
  transfers& network;
  report& result;
  run_log& log;
  clock::time_point begin;

  double seconds() const { return std::chrono::duration<double>(clock::now() - begin).count(); }
};

// Returns how long to wait before another attempt: longer after each failure, and not the same for all files.
std::chrono::milliseconds backoff(const client_settings& settings, unsigned failures, std::uint64_t file);

// Returns whether an attempt lets the server compress the file: each second one does not, because some servers name an
// encoding that the bytes do not have.
bool accepts_encoding(unsigned failures);

class session {
 public:
  enum class outcome { done, new_front };

  // number: of the session in the run.
  // front: the bytes of a front that sightcell_stream_open has accepted; taken for comparison.
  // device: null draws nothing. Must outlive the session.
  // Fails with gl.*, here and in the functions below.
  session(const shared_run& run, std::uint32_t number, stream_owner stream, std::vector<std::uint8_t> front,
          gl_thread* device);

  // Waits for what is being drawn.
  ~session();
  session(const session&) = delete;
  session& operator=(const session&) = delete;

  // Follows the walk until nothing is left to load, or until the server has another front.
  // walked: seconds of the walk that are done; moved on.
  outcome run(const walk& way, double& walked);

  // Draws the current view, and waits for it.
  sightcell::picture::image_rgba picture();

  // Writes into the report what holds at the end.
  void finish_report();

 private:
  struct failed_attempts {
    unsigned count = 0;
    std::string cause;
  };

  void take_transfers();
  void take_decoded();
  void release_backoffs();
  void move(const walk& way, double seconds);
  void measure(const sightcell_stream_frame& frame);
  bool request_files(bool at_rest);
  bool may_load(const sightcell_stream_request& request);
  void start(std::uint32_t file);
  void fail(std::uint32_t file, const std::string& cause, bool gone);
  void save(const std::string& name, const std::vector<std::uint8_t>& bytes) const;
  void show(decoded_file& decoded);
  void remove(std::uint32_t file);
  void draw_if_due();
  sightcell::picture::camera camera() const;
  void picture_of_walk(bool loading);
  void mark_unsupported();
  bool idle() const { return in_transfer_ == 0 && decoding_ == 0 && waiting_.empty() && !front_requested_; }
  std::uint64_t estimate(const sightcell_stream_file& file) const;
  std::size_t most_transfers() const;
  sightcell_stream_file describe(std::uint32_t file) const;

  shared_run run_;
  std::uint32_t number_;
  stream_owner stream_;
  view_owner view_;
  std::vector<std::uint8_t> front_;
  sightcell_stream_info info_{};
  resident_files resident_;
  decoders decoders_;
  gl_thread* device_;
  std::unique_ptr<renderer> renderer_;  // used on the thread of the device only
  std::atomic<bool> drawing_ = false;   // a picture that nothing waits for

  std::map<std::uint32_t, failed_attempts> failures_;              // by file
  std::set<std::pair<clock::time_point, std::uint32_t>> waiting_;  // for another attempt
  std::map<std::uint32_t, std::uint32_t> shown_file_;              // by image: the file on the device
  std::set<std::uint32_t> not_needed_;                             // files on their way that no cell waited for
  std::size_t in_transfer_ = 0, decoding_ = 0;
  bool front_requested_ = false, front_changed_ = false, front_checked_ = false;

  camera_pose pose_;
  sightcell_stream_frame frame_{};
  std::vector<std::uint64_t> shown_;  // a bit for each draw
  bool changed_ = true;               // since the last picture
  clock::time_point last_picture_{};
  double pending_since_ = not_reached;
  std::uint32_t last_cell_ = SIGHTCELL_NO_CELL;
};

}  // namespace stream_client
