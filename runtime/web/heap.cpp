// malloc and free of the module, for the runtime and for the page, which passes bytes in. First fit in a list of free
// blocks sorted by address, in which neighbors are joined: a page has a few dozen blocks, and allocates none while it
// draws. The C library's malloc would be a seventh of all code.
#include <cstddef>
#include <cstdint>

extern "C" {
extern std::byte __heap_base;  // set by the linker: the end of data and stack
void* malloc(std::size_t size);
void free(void* address);
}

namespace {

constexpr std::size_t page_size = 65536;

// The header in front of a block's bytes, which begin at a multiple of 16.
struct alignas(16) block {
  std::size_t size = 0;   // with this header; a multiple of 16
  block* next = nullptr;  // only for free blocks
};

block* first_free = nullptr;
bool begun = false;

std::uintptr_t address_of(const void* address) noexcept {
  return reinterpret_cast<std::uintptr_t>(address);
}
std::uintptr_t end_of(const block* b) noexcept {
  return address_of(b) + b->size;
}

void join_next(block* b) noexcept {
  if (b->next == nullptr || end_of(b) != address_of(b->next)) return;
  b->size += b->next->size;
  b->next = b->next->next;
}

void put_back(block* b) noexcept {
  block* before = nullptr;
  block* behind = first_free;
  while (behind != nullptr && address_of(behind) < address_of(b)) {
    before = behind;
    behind = behind->next;
  }
  b->next = behind;
  (before == nullptr ? first_free : before->next) = b;
  join_next(b);
  if (before != nullptr) join_next(before);
}

void put_memory(std::uintptr_t begin, std::uintptr_t end) noexcept {
  auto* b = reinterpret_cast<block*>(begin);
  b->size = end - begin;
  put_back(b);
}

// Adds whole pages at the end of the memory. False if there are no more.
bool grow(std::size_t size) noexcept {
  const std::size_t pages = (size + page_size - 1) / page_size;
  const std::size_t before = __builtin_wasm_memory_grow(0, pages);
  if (before == SIZE_MAX) return false;
  put_memory(before * page_size, (before + pages) * page_size);
  return true;
}

// Takes the end of a free block, so that the rest keeps its entry in the list.
block* take(std::size_t size) noexcept {
  for (block** link = &first_free; *link != nullptr; link = &(*link)->next) {
    block* b = *link;
    if (b->size < size) continue;
    if (b->size == size) {
      *link = b->next;
      return b;
    }
    b->size -= size;
    auto* rest = reinterpret_cast<block*>(end_of(b));
    rest->size = size;
    return rest;
  }
  return nullptr;
}

}  // namespace

void* malloc(std::size_t size) {
  if (size > PTRDIFF_MAX) return nullptr;
  if (!begun) {
    begun = true;
    const std::uintptr_t begin = (address_of(&__heap_base) + alignof(block) - 1) / alignof(block) * alignof(block);
    const std::uintptr_t end = __builtin_wasm_memory_size(0) * page_size;
    if (end > begin + sizeof(block)) put_memory(begin, end);
  }
  const std::size_t whole = sizeof(block) + (size + alignof(block) - 1) / alignof(block) * alignof(block);
  block* b = take(whole);
  if (b == nullptr && grow(whole)) b = take(whole);
  return b == nullptr ? nullptr : b + 1;
}

void free(void* address) {
  if (address != nullptr) put_back(static_cast<block*>(address) - 1);
}
