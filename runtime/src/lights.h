#pragma once
// The lights of a file: which touch what a view shows, and the polygons that each reaches.
#include <cstddef>
#include <cstdint>
#include <span>

#include "db.h"
#include "memory.h"
#include "sightcell/format/light_table.h"
#include "sightcell/lights.h"
#include "view.h"

// In the global namespace, because the C API declares it.
struct sightcell_lights {
 public:
  // db: open.
  static sightcell_status create(const sightcell_db& db, sightcell_lights** out) noexcept;
  static void destroy(sightcell_lights* lights) noexcept;

  [[nodiscard]] const sightcell_db& db() const noexcept { return *db_; }
  [[nodiscard]] const sightcell::format::light_table& table() const noexcept { return table_; }
  // light: below the number of lights.
  [[nodiscard]] bool touches(const sightcell_view& view, std::uint32_t light) const noexcept;
  // Returns the polygons that a light reaches, without hidden groups, as runs of stored polygons, valid until the next
  // call. light: below the number of lights.
  [[nodiscard]] std::span<const sightcell::format::run> lit_set(const sightcell_view& view,
                                                                std::uint32_t light) noexcept;

 private:
  sightcell_lights() = default;
  [[nodiscard]] std::uint64_t carve(void* block) noexcept;
  [[nodiscard]] std::span<const sightcell::format::run> hidden_in(const sightcell_view& view) noexcept;

  const sightcell_db* db_ = nullptr;
  std::uint64_t block_size_ = 0;
  sightcell::format::light_table table_;
  const sightcell::format::row_codes* codes_ = nullptr;
  std::span<std::byte> codes_memory_, scratch_;
  std::span<sightcell::format::run> row_;     // of the set of a light
  std::span<sightcell::format::run> hidden_;  // of hidden groups
  std::span<sightcell::format::run> runs_;    // of one without the other
};
