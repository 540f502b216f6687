#include "client.h"

#include "sightcell/base/error.h"

namespace stream_client {
namespace {

using sightcell::error;
using sightcell::error_kind;

constexpr std::uint64_t most_chunk_memory = 16 << 20;

struct opened_front {
  stream_owner stream;
  std::vector<std::uint8_t> bytes;
};

transfer_result wait_for_front(const shared_run& run, bool encoded) {
  ++run.result.requests;
  run.log.request(run.seconds(), front_name);
  run.network.start({0, front_name, most_front_bytes, false, encoded});
  for (;;) {
    for (transfer_result& r : run.network.take()) {
      run.result.bytes += r.received;
      run.result.http2 = run.result.http2 || r.http2;
      if (r.tag == 0 && r.path == front_name) return std::move(r);
    }
    run.bell.wait_until(clock::now() + std::chrono::seconds(1));
  }
}

// A front has no hash: what is no front may have been damaged on its way.
opened_front load_front(const shared_run& run) {
  std::string cause;
  bool arrived = false;
  for (unsigned failures = 0; failures < run.settings.attempts; ++failures) {
    if (failures > 0) {
      ++run.result.refetches;
      const auto end = clock::now() + backoff(run.settings, failures, 0);
      while (clock::now() < end) run.bell.wait_until(end);
    }
    transfer_result r = wait_for_front(run, accepts_encoding(failures));
    cause = r.failure;
    arrived = cause.empty();
    if (arrived) {
      sightcell_stream* stream = nullptr;
      const std::uint64_t memory = std::min(run.settings.memory / 8, most_chunk_memory);
      const sightcell_status status = sightcell_stream_open(r.body.data(), r.body.size(), memory, nullptr, &stream);
      if (status == SIGHTCELL_OK) {
        ++run.result.fronts;
        return {stream_owner(stream), std::move(r.body)};
      }
      cause = sightcell_status_text(status);
    }
    ++run.result.errors;
  }
  throw error(arrived ? error_kind::bad_input : error_kind::failed, "client.front",
              run.settings.network.base_url + front_name, cause,
              "name the folder of a streamed scene that a server sends");
}

walk way_of(const camera_choice& camera, const sightcell_stream* stream) {
  if (!camera.path_file.empty()) return walk(camera.path_file, camera.speed);
  sightcell_stream_info info{};
  info.struct_size = sizeof info;
  require(sightcell_stream_describe(stream, &info), "sightcell_stream_describe");
  const glm::vec3 middle =
      0.5f * glm::vec3(info.min[0] + info.max[0], info.min[1] + info.max[1], info.min[2] + info.max[2]);
  const glm::vec3 eye = camera.eye.value_or(middle);
  const glm::vec3 forward = camera.look ? *camera.look - eye : glm::vec3(0.0f, 0.0f, -1.0f);
  return {eye, forward == glm::vec3(0.0f) ? glm::vec3(0.0f, 0.0f, -1.0f) : forward};
}

}  // namespace

report run_client(const client_settings& settings, const camera_choice& camera, const std::string& picture) {
  std::optional<gl_thread> device;
  if (settings.draw) device.emplace();
  doorbell bell;
  transfers network(settings.network, bell);
  report result;
  result.memory_limit = settings.memory;
  run_log log(settings.log, camera.speed);
  const shared_run run{settings, bell, network, result, log, clock::now()};
  std::optional<walk> way;
  double walked = 0.0;
  for (std::uint32_t number = 1;; ++number) {
    opened_front front = load_front(run);
    if (!way) {
      result.front_seconds = run.seconds();
      way = way_of(camera, front.stream.get());
    }
    session now(run, number, std::move(front.stream), std::move(front.bytes), device ? &*device : nullptr);
    const session::outcome outcome = now.run(*way, walked);
    now.finish_report();
    if (outcome == session::outcome::new_front) continue;
    result.seconds = run.seconds();
    if (!picture.empty()) sightcell::picture::write_png(picture, now.picture());
    return result;
  }
}

}  // namespace stream_client
