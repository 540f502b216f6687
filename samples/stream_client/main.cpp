// Loads a streamed scene from a web server and draws it. See README.md.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>

#include "client.h"
#include "sightcell/base/error.h"

namespace {

using sightcell::error;
using sightcell::error_kind;

struct arguments {
  std::string url, picture, save;
  std::vector<float> eye, look;
  stream_client::camera_choice camera;
  stream_client::client_settings settings;
  std::string size = "960x540";
  double memory = 512.0;  // MB
  std::int64_t stall = 10'000, connect = 10'000, backoff = 250, longest_backoff = 8000;
  bool no_draw = false, json = false, list = false;
};

void add_options(CLI::App& app, arguments& args) {
  auto& settings = args.settings;
  app.add_option("url", args.url, "the folder with scene.front, http:// or https://")->required();
  auto* walk = app.add_option("--walk", args.camera.path_file, "JSON file with the path that the camera follows");
  app.add_option("--speed", args.camera.speed, "speed of the camera on the walk, meters per second")
      ->check(CLI::Range(0.001f, 1e6f))
      ->capture_default_str();
  app.add_flag("--wait", settings.wait, "the camera of the walk waits where its cell is not complete");
  app.add_option("--eye", args.eye, "position of the camera: x,y,z in meters; default: the middle of the scene")
      ->delimiter(',')
      ->expected(3)
      ->excludes(walk);
  app.add_option("--look", args.look, "a point in the direction of the view: x,y,z")
      ->delimiter(',')
      ->expected(3)
      ->excludes(walk);
  app.add_option("--lookahead", settings.lookahead, "seconds of movement whose cells are loaded ahead of need")
      ->check(CLI::Range(0.0f, 60.0f))
      ->capture_default_str();
  app.add_option("--memory", args.memory, "limit of polygons and images in memory, MB")
      ->check(CLI::Range(0.01, 1e6))
      ->capture_default_str();
  app.add_option("--connections", settings.network.connections, "open connections at a time")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  app.add_option("--authorities", settings.network.authorities,
                 "file with the certificates to trust; default: those of the system");
  app.add_option("--threads", settings.decode_threads, "number of threads that decode pages and images")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  app.add_option("--attempts", settings.attempts, "requests for one file, after which it counts as failed")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  app.add_option("--backoff", args.backoff, "wait before a file is requested again, ms; it doubles with each attempt")
      ->check(CLI::Range(1, 60'000))
      ->capture_default_str();
  app.add_option("--longest-backoff", args.longest_backoff, "maximum of this wait, ms")
      ->check(CLI::Range(1, 600'000))
      ->capture_default_str();
  app.add_option("--stall", args.stall, "a transfer fails if it receives fewer than 256 bytes in this time, ms")
      ->check(CLI::Range(10, 600'000))
      ->capture_default_str();
  app.add_option("--connect", args.connect, "time limit of a connection attempt, ms")
      ->check(CLI::Range(10, 600'000))
      ->capture_default_str();
  app.add_option("--picture", args.picture, "write the last picture: .png");
  app.add_option("--size", args.size, "width and height of pictures in pixels")->capture_default_str();
  app.add_option("--pictures", settings.log.pictures, "writes pictures along the walk into this folder, as .png");
  app.add_option("--picture-distance", settings.log.picture_distance,
                 "distance along the walk between two of these pictures, meters")
      ->check(CLI::Range(0.001f, 1e6f))
      ->capture_default_str();
  app.add_option("--log-frames", settings.log.frames, "write what was missing in each frame: .csv");
  app.add_option("--log-requests", settings.log.requests, "write when each file was requested: .csv");
  app.add_option("--save", args.save, "folder that gets each file whose hash is right");
  app.add_flag("--no-draw", args.no_draw, "load and decode only");
  app.add_flag("--json", args.json, "print one JSON object");
  app.add_flag("--list", args.list, "with --json: the names of all files that are there at the end");
}

std::optional<glm::vec3> point_of(const std::vector<float>& numbers) {
  if (numbers.empty()) return std::nullopt;
  return glm::vec3(numbers[0], numbers[1], numbers[2]);
}

void complete(arguments& args) {
  auto& s = args.settings;
  s.network.base_url = args.url.ends_with('/') ? args.url : args.url + "/";
  s.network.stall_time = std::chrono::milliseconds(args.stall);
  s.network.connect_timeout = std::chrono::milliseconds(args.connect);
  s.first_backoff = std::chrono::milliseconds(args.backoff);
  s.longest_backoff = std::chrono::milliseconds(args.longest_backoff);
  s.memory = static_cast<std::uint64_t>(args.memory * 1e6);
  s.draw = !args.no_draw;
  s.save = args.save;
  args.camera.eye = point_of(args.eye);
  args.camera.look = point_of(args.look);
  int end = 0;
  unsigned width = 0, height = 0;
  if (std::sscanf(args.size.c_str(), "%5ux%5u%n", &width, &height, &end) != 2 ||
      args.size[static_cast<std::size_t>(end)] != '\0' || width == 0 || height == 0 || width > 16384 ||
      height > 16384) {
    throw error(error_kind::wrong_use, "client.size", "--size " + args.size, "is no size in pixels",
                "write for example 960x540");
  }
  s.width = width;
  s.height = height;
  if (args.no_draw && !(args.picture.empty() && s.log.pictures.empty())) {
    throw error(error_kind::wrong_use, "client.no-picture", args.picture.empty() ? "--pictures" : "--picture",
                "there is none with --no-draw", "leave out one of the two");
  }
}

nlohmann::ordered_json json_of(const stream_client::report& r, bool list) {
  nlohmann::ordered_json out;
  out["seconds"] = r.seconds;
  out["requests"] = r.requests;
  out["refetches"] = r.refetches;
  out["errors"] = r.errors;
  out["bytes"] = r.bytes;
  out["http2"] = r.http2;
  out["fronts"] = r.fronts;
  out["front_seconds"] = r.front_seconds;
  out["first_cell"] = nullptr;
  if (r.first_cell != SIGHTCELL_NO_CELL) out["first_cell"] = r.first_cell;
  out["first_cell_weight"] = r.first_cell_weight;
  out["first_cell_complete"] = nullptr;
  if (r.first_cell_complete >= 0.0) out["first_cell_complete"] = r.first_cell_complete;
  for (const stream_client::level& l : r.levels) {
    if (l.seconds < 0.0) continue;
    nlohmann::ordered_json entry;
    entry["percent"] = l.percent;
    entry["seconds"] = l.seconds;
    entry["bytes"] = l.bytes;
    entry["requests"] = l.requests;
    out["levels"].push_back(std::move(entry));
  }
  out["cells_entered"] = r.cells_entered;
  out["pending_seconds"] = r.pending_seconds;
  out["longest_pending"] = r.longest_pending;
  out["complete"] = r.complete;
  out["memory_peak"] = r.peak_memory;
  out["memory_limit"] = r.memory_limit;
  out["removed"] = r.removed;
  out["unsupported_images"] = r.unsupported_images;
  out["frames_drawn"] = r.frames_drawn;
  out["polygons_drawn"] = r.polygons_drawn;
  out["failed"] = nlohmann::ordered_json::array();
  for (const auto& file : r.failed) {
    nlohmann::ordered_json entry;
    entry["name"] = file.name;
    entry["cause"] = file.cause;
    out["failed"].push_back(std::move(entry));
  }
  if (list) out["present"] = r.present;
  return out;
}

void print(const stream_client::report& r) {
  fmt::print("{} requests, {} bytes, {:.3f} s{}; front after {:.3f} s\n", r.requests, r.bytes, r.seconds,
             r.http2 ? ", HTTP/2" : "", r.front_seconds);
  if (r.first_cell != SIGHTCELL_NO_CELL) fmt::print("first cell: {}\n", r.first_cell);
  for (const stream_client::level& l : r.levels) {
    if (l.seconds < 0.0) continue;
    fmt::print("{:>5} % of its weight after {:.3f} s, {} bytes, {} requests\n", l.percent, l.seconds, l.bytes,
               l.requests);
  }
  if (r.first_cell_complete >= 0.0) fmt::print("complete, with images, after {:.3f} s\n", r.first_cell_complete);
  fmt::print("{} cells entered; {:.3f} s in cells that were not complete, {:.3f} s at most in one go\n",
             r.cells_entered, r.pending_seconds, r.longest_pending);
  fmt::print("{:.1f} MB in memory at most, limit {:.1f} MB; {} files removed\n",
             static_cast<double>(r.peak_memory) / 1e6, static_cast<double>(r.memory_limit) / 1e6, r.removed);
  fmt::print("{} errors, {} refetches\n", r.errors, r.refetches);
  if (r.unsupported_images > 0) fmt::print("{} images of types that are not read\n", r.unsupported_images);
  if (r.frames_drawn > 0) fmt::print("{} pictures; {} polygons in the last one\n", r.frames_drawn, r.polygons_drawn);
}

int run(arguments& args) {
  complete(args);
  const stream_client::report r = stream_client::run_client(args.settings, args.camera, args.picture);
  if (args.json) {
    fmt::print("{}\n", json_of(r, args.list).dump());
  } else {
    print(r);
  }
  for (const auto& file : r.failed) {
    const error e(error_kind::failed, "client.not-loaded", file.name, file.cause, "check the server");
    fmt::print(stderr, "{}\n", e.what());
  }
  if (!r.complete && r.failed.empty()) {
    const error e(error_kind::failed, "client.not-complete", "the cell of the camera", "files of it are missing",
                  "report this");
    fmt::print(stderr, "{}\n", e.what());
  }
  return r.failed.empty() && r.complete ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  arguments args;
  CLI::App app{"Loads a streamed scene from a web server and draws it"};
  add_options(app, args);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    return run(args);
  } catch (const error& e) {
    fmt::print(stderr, "{}\n", e.what());
    return e.kind() == error_kind::wrong_use ? 2 : e.kind() == error_kind::bad_input ? 4 : 1;
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 1;
  }
}
