#pragma once
// Files from a web server, with libcurl on a thread of its own: HTTP/1.1 connections that stay open, or HTTP/2 where
// the server offers it (over TLS). A transfer ends with the bytes or with a cause; transfers knows nothing of retries.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "doorbell.h"

namespace stream_client {

struct transfer_settings {
  std::string base_url;      // ends in '/'
  std::string authorities;   // file with the certificates to trust; empty: those of the system
  unsigned connections = 6;  // open at a time; with HTTP/2 fewer
  unsigned streams = 24;     // requests at a time with HTTP/2
  std::chrono::milliseconds connect_timeout{10'000};
  // A transfer that receives fewer than `least_bytes` within `stall_time` ends.
  std::chrono::milliseconds stall_time{10'000};
  std::uint64_t least_bytes = 256;
};

struct transfer_request {
  std::uint64_t tag = 0;    // for the caller
  std::string path;         // below base_url
  std::uint64_t bytes = 0;  // that the file has, or at most has
  bool exact = false;       // the file has so many bytes
  bool encoded = true;      // the server may send it compressed (Content-Encoding). The body is decoded
};

struct transfer_result {
  std::uint64_t tag = 0;
  std::string path;
  std::string failure;  // empty: the body is complete. Else the cause
  long http_status = 0;
  bool http2 = false;
  std::uint64_t received = 0;  // bytes as sent, with headers
  clock::time_point end{};
  std::vector<std::uint8_t> body;
};

class transfers {
 public:
  // bell: rung after each result. Must outlive the transfers.
  // Fails with client.network if libcurl cannot start.
  transfers(const transfer_settings& settings, doorbell& bell);

  // Ends all transfers.
  ~transfers();
  transfers(const transfers&) = delete;
  transfers& operator=(const transfers&) = delete;

  // Adds a transfer. They begin in the order of the calls.
  void start(transfer_request request);

  // Returns what has ended since the last call.
  std::vector<transfer_result> take();

 private:
  struct state;
  std::unique_ptr<state> state_;
};

}  // namespace stream_client
