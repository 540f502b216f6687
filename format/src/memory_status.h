#pragma once
// How writers report that memory ran out.
#include <new>
#include <stdexcept>

#include "sightcell/format/status.h"

namespace sightcell::format {

// Returns make(), a status; memory where an allocation throws.
template <class Make>
status or_memory(const Make& make) {
#if defined(__cpp_exceptions)
  try {
    return make();
  } catch (const std::bad_alloc&) {
    return status::memory;
  } catch (const std::length_error&) {  // thrown by a vector above its largest size
    return status::memory;
  }
#else
  return make();
#endif
}

}  // namespace sightcell::format
