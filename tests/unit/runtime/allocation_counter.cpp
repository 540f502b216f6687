#include "allocation_counter.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> allocations{0};

}  // namespace

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SIGHTCELL_TEST_IS_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SIGHTCELL_TEST_IS_SANITIZED 1
#endif
#endif

#if !defined(SIGHTCELL_TEST_IS_SANITIZED)
#define SIGHTCELL_TEST_COUNTS_NEW 1

void* operator new(std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  if (void* block = std::malloc(size)) return block;
  throw std::bad_alloc();
}
void operator delete(void* block) noexcept {
  std::free(block);
}
void operator delete(void* block, std::size_t) noexcept {
  std::free(block);
}

#if defined(__GLIBC__)
#define SIGHTCELL_TEST_COUNTS_MALLOC 1

extern "C" {
void* __libc_malloc(std::size_t size);                     // NOLINT(bugprone-reserved-identifier)
void* __libc_calloc(std::size_t count, std::size_t size);  // NOLINT(bugprone-reserved-identifier)
void* __libc_realloc(void* block, std::size_t size);       // NOLINT(bugprone-reserved-identifier)

__attribute__((visibility("default"))) void* malloc(std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_malloc(size);
}
__attribute__((visibility("default"))) void* calloc(std::size_t count, std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_calloc(count, size);
}
__attribute__((visibility("default"))) void* realloc(void* block, std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  return __libc_realloc(block, size);
}
}
#endif
#endif

namespace sightcell::test {

std::size_t allocation_count() {
  return allocations.load();
}

bool counts_new() {
#if defined(SIGHTCELL_TEST_COUNTS_NEW)
  return true;
#else
  return false;
#endif
}

bool counts_malloc() {
#if defined(SIGHTCELL_TEST_COUNTS_MALLOC)
  return true;
#else
  return false;
#endif
}

}  // namespace sightcell::test
