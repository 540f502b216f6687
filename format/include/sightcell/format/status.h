#pragma once
// Result of reading or writing a .pvs file. Values equal those of sightcell_status in the C API (runtime/), so that a
// status passes through unchanged. format does not include the runtime.
#include <cstdint>

namespace sightcell::format {

enum class [[nodiscard]] status : std::uint32_t{
    ok = 0,        argument = 1, memory = 2,     capacity = 3,  stale = 4,    absent = 5, pending = 6,      io = 10,
    not_ours = 20, version = 21, truncated = 22, checksum = 23, corrupt = 24, limit = 25, other_scene = 26,
};

// One English line for a status, also for a value that is none. Static storage, never null.
const char* status_text(status s) noexcept;

}  // namespace sightcell::format
