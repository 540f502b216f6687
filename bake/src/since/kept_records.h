#pragma once
// The file of kept records beside a .pvs file: for each step of each cell its record, what went into it and the space
// that it touched, and the polygons of the scene. A later bake takes from it what an edit did not change.
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "since/polygon_table.h"
#include "trace/coincident.h"

namespace sightcell::bake {

// The steps of a cell (cell_bake.h).
enum class step_kind : std::uint8_t { sample = 0, finish_rays = 1, sample_and_finish = 2, check = 3 };

struct kept_step {
  std::uint64_t place = 0;     // of the cell
  std::array<float, 6> box{};  // of the cell: min, then max, meters
  step_kind kind = step_kind::sample;
  std::uint64_t own_inputs = 0;       // a hash of the cell's record before the step
  std::uint64_t neighbor_inputs = 0;  // a hash of the records of neighbors that went into the step
  bool started = false;               // from what an earlier bake found: it is not the record of a full bake
  std::vector<std::uint8_t> record;   // encode() of the cell_record
  // touched_space::encode(), of the step and of those that started from it since; together they are the space of it.
  std::vector<std::vector<std::uint8_t>> spaces;
  std::vector<std::uint8_t> tested;   // tested_viewpoints::encode()
};

struct kept_records {
  std::string key;  // of the settings
  polygon_table polygons;
  float partner_reach = 0.0f;          // of coincident partners, meters
  std::vector<polygon_pair> partners;  // polygons that coincide
  std::vector<kept_step> steps;
};

// Returns the name of the file that belongs to a .pvs file.
std::filesystem::path records_beside(const std::filesystem::path& pvs);

// The file of a .pvs file, complete but not under its name yet.
class written_records {
 public:
  // Writes it. Sorts the steps first, so that the bytes do not depend on the order of work. Fails with output.io.
  written_records(kept_records& records, const std::filesystem::path& pvs);
  // Removes what was not published.
  ~written_records();
  written_records(const written_records&) = delete;
  written_records& operator=(const written_records&) = delete;
  // Replaces the file of the .pvs file by rename. Fails with output.io.
  void publish();

 private:
  std::filesystem::path path_, fresh_;
};

// Writes the file of a .pvs file by rename. Fails with output.io.
void write_records(kept_records& records, const std::filesystem::path& pvs);

// Reads the file of a .pvs file. Its bytes may be arbitrary.
// Fails with records.missing and records.damaged.
kept_records read_records(const std::filesystem::path& pvs);

// For a file that is whole by its checksum, and still not one that a bake wrote. Throws records.damaged.
[[noreturn]] void refuse_records(const std::filesystem::path& pvs);

}  // namespace sightcell::bake
