#include "decoders.h"

#include <webp/decode.h>

#include <cstring>
#include <exception>
#include <optional>
#include <span>
#include <utility>

namespace stream_client {
namespace {

constexpr std::uint32_t largest_side = 16384;  // pixels
constexpr std::size_t longest_cause = 200;     // bytes

// Causes may quote bytes of a file.
std::string printable(std::string text) {
  if (text.size() > longest_cause) text.resize(longest_cause);
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text;
}

bool is_webp(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
         std::memcmp(bytes.data() + 8, "WEBP", 4) == 0;
}

// Nothing for a damaged image.
std::optional<sightcell::scene::image_pixels> decode_webp(std::span<const std::uint8_t> bytes) {
  int width = 0, height = 0;
  if (WebPGetInfo(bytes.data(), bytes.size(), &width, &height) == 0) return {};
  sightcell::scene::image_pixels out;
  out.width = static_cast<std::uint32_t>(width);
  out.height = static_cast<std::uint32_t>(height);
  out.rgba.resize(4 * std::size_t{out.width} * out.height);
  if (WebPDecodeRGBAInto(bytes.data(), bytes.size(), out.rgba.data(), out.rgba.size(), 4 * width) == nullptr) return {};
  return out;
}

}  // namespace

std::uint64_t decoded_file::bytes() const {
  const std::uint64_t pixel_bytes = pixels ? pixels->rgba.size() + pixels->rgba.size() / 3 : 0;
  return pixel_bytes + (polygons ? polygons->bytes() : 0);
}

decoders::decoders(unsigned threads, std::uint32_t geometry_count, doorbell& bell)
    : geometry_count_(geometry_count), bell_(bell) {
  for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
}

decoders::~decoders() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  for (std::thread& t : threads_) t.join();
}

void decoders::start(decode_job job) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_.push_back(std::move(job));
  }
  changed_.notify_one();
}

std::vector<decoded_file> decoders::take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(done_, {});
}

// Contents that are broken become a failure of their file, whatever a decoder throws.
decoded_file decoders::decode(decode_job job) const {
  decoded_file out;
  out.file = job.file;
  try {
    if (job.is_page) {
      out.polygons = read_page(job.bytes, geometry_count_);
    } else {
      out.pixels = is_webp(job.bytes) ? decode_webp(job.bytes)
                                      : sightcell::scene::decode({{}, std::move(job.bytes)}, largest_side);
      if (!out.pixels) out.failure = "the image is damaged";
    }
  } catch (const std::exception& e) {
    out.failure = printable(e.what());
  }
  return out;
}

void decoders::run() {
  for (;;) {
    decode_job job;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait(lock, [this] { return stop_ || !waiting_.empty(); });
      if (stop_) return;
      job = std::move(waiting_.front());
      waiting_.pop_front();
    }
    decoded_file result = decode(std::move(job));
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      done_.push_back(std::move(result));
    }
    bell_.ring();
  }
}

}  // namespace stream_client
