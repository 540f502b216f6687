#pragma once
// Pages and images as what can be drawn, in threads of their own.
#include <condition_variable>
#include <deque>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "doorbell.h"
#include "page.h"
#include "sightcell/scene/image.h"

namespace stream_client {

struct decode_job {
  std::uint32_t file = 0;
  bool is_page = false;
  std::vector<std::uint8_t> bytes;
};

struct decoded_file {
  std::uint32_t file = 0;
  std::optional<page> polygons;
  std::optional<sightcell::scene::image_pixels> pixels;
  std::string failure;  // empty: one of the two is there

  // Returns the bytes that it takes on a device, with the smaller levels of an image.
  std::uint64_t bytes() const;
};

class decoders {
 public:
  // threads: 1 or more.
  // geometry_count: of the scene.
  // bell: rung after each result. Must outlive the decoders.
  decoders(unsigned threads, std::uint32_t geometry_count, doorbell& bell);

  // Finishes what is being decoded, and drops the rest.
  ~decoders();
  decoders(const decoders&) = delete;
  decoders& operator=(const decoders&) = delete;

  void start(decode_job job);

  // Returns what has been decoded since the last call.
  std::vector<decoded_file> take();

 private:
  void run();
  decoded_file decode(decode_job job) const;

  std::uint32_t geometry_count_;
  doorbell& bell_;
  std::mutex mutex_;  // of the following
  std::condition_variable changed_;
  std::deque<decode_job> waiting_;
  std::vector<decoded_file> done_;
  bool stop_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace stream_client
