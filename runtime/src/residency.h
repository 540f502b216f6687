#pragma once
// The texture residency of a file, and the levels that a view needs.
#include <cstddef>
#include <cstdint>
#include <span>

#include "db.h"
#include "memory.h"
#include "sightcell/format/residency_table.h"
#include "sightcell/residency.h"
#include "view.h"

// In the global namespace, because the C API declares it.
struct sightcell_residency {
 public:
  // db: open.
  static sightcell_status create(const sightcell_db& db, sightcell_residency** out) noexcept;
  static void destroy(sightcell_residency* residency) noexcept;

  [[nodiscard]] const sightcell_db& db() const noexcept { return *db_; }
  [[nodiscard]] const sightcell::format::residency_table& table() const noexcept { return table_; }
  // Write the level of each texture to dst, which has one element for each. pixels_per_radian: valid.
  void levels_of(const sightcell_view& view, float pixels_per_radian, std::uint8_t* dst) noexcept;
  void levels_of(std::uint32_t cell, float pixels_per_radian, std::uint8_t* dst) noexcept;

 private:
  sightcell_residency() = default;
  [[nodiscard]] std::uint64_t carve(void* block) noexcept;
  [[nodiscard]] bool add(std::uint32_t cell) noexcept;
  void write(bool known, float pixels_per_radian, std::uint8_t* dst) const noexcept;

  const sightcell_db* db_ = nullptr;
  std::uint64_t block_size_ = 0;
  sightcell::format::residency_table table_;
  const sightcell::format::residency_codes* codes_ = nullptr;
  std::span<std::byte> codes_memory_;
  std::span<std::uint8_t> of_cell_;  // numbers of levels
  std::span<std::uint8_t> finest_;   // of all cells that were added
};
