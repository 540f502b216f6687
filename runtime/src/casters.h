#pragma once
// The shadow casters of a file, and the polygons that a view draws into the shadow map of a sun.
#include <cstddef>
#include <cstdint>
#include <span>

#include "db.h"
#include "memory.h"
#include "sightcell/casters.h"
#include "sightcell/format/caster_table.h"
#include "view.h"

// In the global namespace, because the C API declares it.
struct sightcell_casters {
 public:
  // db: open.
  static sightcell_status create(const sightcell_db& db, sightcell_casters** out) noexcept;
  static void destroy(sightcell_casters* casters) noexcept;

  [[nodiscard]] const sightcell_db& db() const noexcept { return *db_; }
  [[nodiscard]] const sightcell::format::caster_table& table() const noexcept { return table_; }
  // Returns the polygons of the view and the casters of its cells, as runs of stored polygons, valid until the next
  // call. sun: below the number of suns.
  [[nodiscard]] std::span<const sightcell::format::run> shadow_set(const sightcell_view& view,
                                                                   std::uint32_t sun) noexcept;

 private:
  sightcell_casters() = default;
  [[nodiscard]] std::uint64_t carve(void* block) noexcept;
  void mark(std::span<const sightcell::format::run> runs, bool in) noexcept;
  [[nodiscard]] bool mark_casters(const sightcell_view& view, std::uint32_t sun) noexcept;
  [[nodiscard]] std::span<const sightcell::format::run> marked() noexcept;

  const sightcell_db* db_ = nullptr;
  std::uint64_t block_size_ = 0;
  sightcell::format::caster_table table_;
  const sightcell::format::row_codes* codes_ = nullptr;
  std::span<std::byte> codes_memory_, scratch_;
  std::span<sightcell::format::run> row_;   // of one caster set
  std::span<sightcell::format::run> runs_;  // of a whole shadow set
  std::span<std::uint64_t> bits_;           // one for each stored polygon
};
