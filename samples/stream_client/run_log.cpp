#include "run_log.h"

#include <fmt/format.h>

#include <filesystem>
#include <limits>

#include "sightcell/base/error.h"

namespace stream_client {
namespace {

using sightcell::error;
using sightcell::error_kind;

[[noreturn]] void fail_log(const std::string& file) {
  throw error(error_kind::failed, "client.log", file, "cannot be written", "name another file or folder");
}

std::ofstream begin_table(const std::string& file, const char* columns) {
  std::ofstream out;
  if (file.empty()) return out;
  out.open(file, std::ios::binary);
  if (!(out << columns << '\n')) fail_log(file);
  return out;
}

}  // namespace

run_log::run_log(const log_settings& settings, float speed)
    : settings_(settings),
      picture_seconds_(static_cast<double>(settings.picture_distance) / static_cast<double>(speed)),
      frames_(begin_table(settings.frames,
                          "seconds,walked_seconds,bytes,cell,unknown_cell,pending,missing,weight,weight_present")),
      requests_(begin_table(settings.requests, "seconds,name")) {
  std::error_code failure;
  if (settings_.pictures.empty()) return;
  std::filesystem::create_directories(settings_.pictures, failure);
  if (failure) fail_log(settings_.pictures);
}

void run_log::frame(double seconds, double walked, const sightcell_stream_frame& frame, const report& so_far) {
  if (!frames_.is_open()) return;
  const bool known = frame.cell != SIGHTCELL_NO_CELL;
  frames_ << fmt::format("{:.4f},{:.4f},{},{},{:d},{:d},{},{:.6g},{:.6g}\n", seconds, walked, so_far.bytes,
                         known ? fmt::format("{}", frame.cell) : "", (frame.flags & SIGHTCELL_STREAM_UNKNOWN_CELL) != 0,
                         (frame.flags & SIGHTCELL_STREAM_PENDING) != 0, frame.missing, frame.weight,
                         frame.weight_present);
  if (!frames_) fail_log(settings_.frames);
}

void run_log::request(double seconds, const std::string& name) {
  if (!requests_.is_open()) return;
  requests_ << fmt::format("{:.4f},{}\n", seconds, name);
  if (!requests_) fail_log(settings_.requests);
}

double run_log::next_picture() const {
  if (settings_.pictures.empty()) return std::numeric_limits<double>::infinity();
  return static_cast<double>(pictures_) * picture_seconds_;
}

void run_log::picture(const sightcell::picture::image_rgba& drawn) {
  const std::filesystem::path file = std::filesystem::path(settings_.pictures) / fmt::format("{:05}.png", pictures_);
  sightcell::picture::write_png(file.string(), drawn);
  ++pictures_;
}

}  // namespace stream_client
