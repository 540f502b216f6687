#pragma once
// A host of a paged file that delivers at once, or when the test calls for it.
#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "sightcell/sightcell.h"

namespace sightcell::test {

struct page_request {
  std::uint64_t offset = 0;
  std::uint32_t size = 0;
  std::uint32_t ticket = 0;
};

class paged_host {
 public:
  explicit paged_host(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}
  ~paged_host() { sightcell_db_close(db_); }
  paged_host(const paged_host&) = delete;
  paged_host& operator=(const paged_host&) = delete;

  sightcell_status open(std::uint64_t resident_bytes, const sightcell_allocator* mem = nullptr) {
    const sightcell_source source{this, bytes_.size(), ask};
    const bool waits = std::exchange(at_once, true);
    const sightcell_status s = sightcell_db_open_source(&source, mem, resident_bytes, &db_);
    at_once = waits;
    opening_requests = std::exchange(requests, 0);
    return s;
  }

  // Opens without waiting; requests stay open unless at_once.
  sightcell_status begin(std::uint64_t resident_bytes, const sightcell_allocator* mem = nullptr) {
    const sightcell_source source{this, bytes_.size(), ask};
    return sightcell_db_begin_source(&source, mem, resident_bytes, &db_);
  }

  sightcell_status deliver(const page_request& r) {
    return sightcell_db_deliver(db_, r.ticket, bytes_.data() + r.offset, r.size);
  }
  // Delivers all open requests, in their order.
  void deliver_all() {
    while (!waiting.empty()) {
      const page_request r = waiting.front();
      waiting.pop_front();
      EXPECT_EQ(deliver(r), SIGHTCELL_OK);
    }
  }

  [[nodiscard]] sightcell_db* db() const { return db_; }
  [[nodiscard]] std::vector<std::byte>& bytes() { return bytes_; }

  bool at_once = false;  // else requests stay open
  sightcell_status answer = SIGHTCELL_OK;
  std::size_t requests = 0;
  std::size_t opening_requests = 0;
  std::deque<page_request> waiting;

 private:
  static sightcell_status ask(void* user, std::uint64_t offset, std::uint32_t size, std::uint32_t ticket) {
    auto* self = static_cast<paged_host*>(user);
    ++self->requests;
    const page_request r{offset, size, ticket};
    if (offset > self->bytes_.size() || size > self->bytes_.size() - offset) return SIGHTCELL_ERR_IO;
    if (self->answer != SIGHTCELL_OK) return self->answer;
    if (!self->at_once) {
      self->waiting.push_back(r);
      return SIGHTCELL_OK;
    }
    static_cast<void>(self->deliver(r));
    return SIGHTCELL_OK;
  }

  std::vector<std::byte> bytes_;
  sightcell_db* db_ = nullptr;
};

}  // namespace sightcell::test
