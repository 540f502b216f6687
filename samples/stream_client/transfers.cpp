#include "transfers.h"

#include <curl/curl.h>

#include <algorithm>
#include <deque>
#include <thread>

#include "sightcell/base/error.h"

namespace stream_client {
namespace {

constexpr std::uint64_t most_header_bytes = 64 << 10;
constexpr long most_redirects = 3;
constexpr std::chrono::milliseconds longest_poll{1000};
constexpr std::uint64_t first_reserve = 1 << 20;  // a server that claims more gets memory as the bytes arrive

// One easy handle; its connection stays open between transfers.
struct transfer {
  CURL* handle = nullptr;
  bool running = false;
  transfer_request request;
  std::vector<std::uint8_t> body;
  std::uint64_t header_bytes = 0;
  std::uint64_t at_window = 0;  // header and body bytes at the begin of this window
  clock::time_point window{};
  std::string cause;  // why a callback has ended it
  char curl_text[CURL_ERROR_SIZE] = {};

  // Of the body as it is sent: before it is decoded.
  std::uint64_t received() const {
    curl_off_t body_bytes = 0;
    curl_easy_getinfo(handle, CURLINFO_SIZE_DOWNLOAD_T, &body_bytes);
    return header_bytes + static_cast<std::uint64_t>(body_bytes);
  }
};

std::size_t on_body(char* data, std::size_t, std::size_t size, void* user) {
  auto& t = *static_cast<transfer*>(user);
  if (size > t.request.bytes - t.body.size()) {
    t.cause = "more than " + std::to_string(t.request.bytes) + " bytes";
    return CURL_WRITEFUNC_ERROR;
  }
  t.body.insert(t.body.end(), data, data + size);
  return size;
}

std::size_t on_header(char*, std::size_t, std::size_t size, void* user) {
  auto& t = *static_cast<transfer*>(user);
  t.header_bytes += size;
  if (t.header_bytes <= most_header_bytes) return size;
  t.cause = "more than " + std::to_string(most_header_bytes) + " bytes of headers";
  return CURL_WRITEFUNC_ERROR;
}

}  // namespace

struct transfers::state {
  state(const transfer_settings& s, doorbell& b) : settings(s), bell(b) {}

  void configure(transfer& t) const;
  void begin(transfer& t, transfer_request request);
  void finish(transfer& t, const std::string& failure);
  std::string failure_of(const transfer& t, CURLcode code, long status) const;
  void begin_waiting();
  void finish_ended();
  void finish_stalled();
  void run();

  transfer_settings settings;
  doorbell& bell;
  CURLM* multi = nullptr;
  std::vector<std::unique_ptr<transfer>> slots;
  bool http2 = false;

  std::mutex mutex;  // of the following
  std::deque<transfer_request> waiting;
  std::vector<transfer_result> ended;
  bool stop = false;

  std::thread thread;
};

void transfers::state::configure(transfer& t) const {
  const auto set = [&](auto option, auto value) { curl_easy_setopt(t.handle, option, value); };
  set(CURLOPT_PRIVATE, static_cast<void*>(&t));
  set(CURLOPT_WRITEFUNCTION, on_body);
  set(CURLOPT_WRITEDATA, static_cast<void*>(&t));
  set(CURLOPT_HEADERFUNCTION, on_header);
  set(CURLOPT_HEADERDATA, static_cast<void*>(&t));
  set(CURLOPT_ERRORBUFFER, t.curl_text);
  set(CURLOPT_NOSIGNAL, 1L);
  set(CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(settings.connect_timeout.count()));
  set(CURLOPT_PROTOCOLS_STR, "http,https");
  set(CURLOPT_REDIR_PROTOCOLS_STR, "http,https");
  set(CURLOPT_FOLLOWLOCATION, 1L);
  set(CURLOPT_MAXREDIRS, most_redirects);
  set(CURLOPT_HTTP_VERSION, static_cast<long>(CURL_HTTP_VERSION_2TLS));
  set(CURLOPT_PIPEWAIT, 1L);  // with HTTP/2: a stream of the open connection instead of another connection
  set(CURLOPT_BUFFERSIZE, 64L << 10);
  if (!settings.authorities.empty()) set(CURLOPT_CAINFO, settings.authorities.c_str());
  set(CURLOPT_USERAGENT, "sightcell-stream-client");
}

void transfers::state::begin(transfer& t, transfer_request request) {
  t.request = std::move(request);
  t.running = true;
  t.body.clear();
  t.body.reserve(static_cast<std::size_t>(std::min(t.request.bytes, first_reserve)));
  t.header_bytes = t.at_window = 0;
  t.window = clock::now();
  t.cause.clear();
  t.curl_text[0] = '\0';
  // Empty: all encodings that libcurl knows. Null: bytes arrive as the server has them.
  curl_easy_setopt(t.handle, CURLOPT_ACCEPT_ENCODING, t.request.encoded ? "" : nullptr);
  curl_easy_setopt(t.handle, CURLOPT_URL, (settings.base_url + t.request.path).c_str());
  if (const CURLMcode code = curl_multi_add_handle(multi, t.handle); code != CURLM_OK)
    finish(t, curl_multi_strerror(code));
}

std::string transfers::state::failure_of(const transfer& t, CURLcode code, long status) const {
  // libcurl may report its own follow-up error; the status and our cause name the origin.
  if (!t.cause.empty()) return t.cause;
  if (code == CURLE_OK && status != 200) return "HTTP status " + std::to_string(status);
  if (code != CURLE_OK) return t.curl_text[0] != '\0' ? t.curl_text : curl_easy_strerror(code);
  if (t.request.exact && t.body.size() != t.request.bytes) {
    return std::to_string(t.body.size()) + " bytes instead of " + std::to_string(t.request.bytes);
  }
  return {};
}

void transfers::state::finish(transfer& t, const std::string& failure) {
  transfer_result r;
  r.tag = t.request.tag;
  r.path = t.request.path;
  r.failure = failure;
  curl_easy_getinfo(t.handle, CURLINFO_RESPONSE_CODE, &r.http_status);
  long version = 0;
  curl_easy_getinfo(t.handle, CURLINFO_HTTP_VERSION, &version);
  r.http2 = version == CURL_HTTP_VERSION_2_0;
  http2 = http2 || r.http2;
  r.received = t.received();
  r.end = clock::now();
  if (failure.empty()) r.body = std::move(t.body);
  t.body = {};
  curl_multi_remove_handle(multi, t.handle);
  t.running = false;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    ended.push_back(std::move(r));
  }
  bell.ring();
}

void transfers::state::begin_waiting() {
  const std::size_t most = http2 ? settings.streams : settings.connections;
  for (std::size_t i = 0; i < most; ++i) {
    if (i == slots.size()) {
      auto made = std::make_unique<transfer>();
      made->handle = curl_easy_init();
      if (made->handle == nullptr) return;
      configure(*made);
      slots.push_back(std::move(made));
    }
    if (slots[i]->running) continue;
    transfer_request next;
    {
      const std::lock_guard<std::mutex> lock(mutex);
      if (waiting.empty()) return;
      next = std::move(waiting.front());
      waiting.pop_front();
    }
    begin(*slots[i], std::move(next));
  }
}

void transfers::state::finish_ended() {
  int left = 0;
  while (const CURLMsg* message = curl_multi_info_read(multi, &left)) {
    if (message->msg != CURLMSG_DONE) continue;
    const CURLcode code = message->data.result;  // message ends with the handle's removal
    char* user = nullptr;
    curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, &user);
    auto& t = *reinterpret_cast<transfer*>(user);
    long status = 0;
    curl_easy_getinfo(t.handle, CURLINFO_RESPONSE_CODE, &status);
    finish(t, failure_of(t, code, status));
  }
}

// libcurl's own limit of speed counts whole seconds.
void transfers::state::finish_stalled() {
  const clock::time_point now = clock::now();
  for (const auto& t : slots) {
    if (!t->running || now - t->window < settings.stall_time) continue;
    if (t->received() - t->at_window < settings.least_bytes) {
      finish(*t, "fewer than " + std::to_string(settings.least_bytes) + " bytes within " +
                     std::to_string(settings.stall_time.count()) + " ms");
      continue;
    }
    t->at_window = t->received();
    t->window = now;
  }
}

void transfers::state::run() {
  const auto poll =
      std::clamp<std::chrono::milliseconds>(settings.stall_time / 4, std::chrono::milliseconds(5), longest_poll);
  for (;;) {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      if (stop) break;
    }
    begin_waiting();
    int running = 0;
    curl_multi_perform(multi, &running);
    finish_ended();
    finish_stalled();
    bool more = false;
    {
      const std::lock_guard<std::mutex> lock(mutex);
      const auto free = [](const auto& t) { return !t->running; };
      more = !waiting.empty() && std::any_of(slots.begin(), slots.end(), free);
    }
    if (!more) curl_multi_poll(multi, nullptr, 0, static_cast<int>(poll.count()), nullptr);
  }
  for (const auto& t : slots) {
    if (t->running) curl_multi_remove_handle(multi, t->handle);
    curl_easy_cleanup(t->handle);
  }
}

transfers::transfers(const transfer_settings& settings, doorbell& bell)
    : state_(std::make_unique<state>(settings, bell)) {
  if (curl_global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK) state_->multi = curl_multi_init();
  if (state_->multi == nullptr) {
    throw sightcell::error(sightcell::error_kind::failed, "client.network", "libcurl", "cannot start",
                           "check the installation of libcurl");
  }
  curl_multi_setopt(state_->multi, CURLMOPT_MAX_TOTAL_CONNECTIONS, static_cast<long>(settings.connections));
  curl_multi_setopt(state_->multi, CURLMOPT_MAXCONNECTS, static_cast<long>(settings.connections));
  state_->thread = std::thread([this] { state_->run(); });
}

transfers::~transfers() {
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->stop = true;
  }
  curl_multi_wakeup(state_->multi);
  state_->thread.join();
  curl_multi_cleanup(state_->multi);
  curl_global_cleanup();
}

void transfers::start(transfer_request request) {
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    state_->waiting.push_back(std::move(request));
  }
  curl_multi_wakeup(state_->multi);
}

std::vector<transfer_result> transfers::take() {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  return std::exchange(state_->ended, {});
}

}  // namespace stream_client
