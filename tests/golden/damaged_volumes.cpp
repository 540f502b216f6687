// Faults of volumes, and of sets that hold some.
#include <array>
#include <functional>
#include <limits>

#include "byte_sink.h"
#include "damaged_file.h"
#include "packed_columns_writer.h"
#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/layout.h"

namespace sightcell::test {
namespace layout = format::layout;
namespace {

using bytes = std::vector<std::byte>;
using numbers = std::vector<std::uint32_t>;
using format::status;
using place_list = std::vector<format::lattice_place>;

constexpr format::lattice_shape shape{1.0, 1.0};

// tiny_contents() with four volumes; cell 1 sees the last polygon and the first volume in one run, and the last volume.
sample_contents contents_with_volumes() {
  sample_contents contents = tiny_contents();
  contents.volume_shape = shape;
  contents.volumes = {{0, 0, 0, 0}, {1, 0, 0, 0}, {0, -2, 5, 0}, {-3, 0, 1, 0}};
  contents.sets = {{0, 1, 2, 4}, {5, 6, 9}};
  contents.settings = "{}";
  return contents;
}

bytes volumes_of(const format::lattice_shape& lattice, const place_list& places) {
  std::vector<numbers> columns(layout::volume_columns);
  for (const format::lattice_place& p : places) {
    std::size_t column = 0;
    for (const std::int32_t at : {p.x, p.y, p.z}) columns[column++].push_back(format::from_signed(at));
  }
  bytes out;
  format::byte_sink sink(out);
  sink.put_f64(lattice.width);
  sink.put_f64(lattice.height);
  sink.put_u32(static_cast<std::uint32_t>(places.size()));
  format::put_columns(columns, out);
  return out;
}

bytes with_volumes(const bytes& file, const format::lattice_shape& lattice, const place_list& places) {
  return with_section(file, layout::section_volumes, volumes_of(lattice, places));
}

void damage_shapes(const bytes& whole, const place_list& places, damaged_list& list) {
  const auto add = [&](const char* name, const format::lattice_shape& lattice) {
    list.push_back({name, status::corrupt, with_volumes(whole, lattice, places)});
  };
  add("volumes_width_0", {0.0, 1.0});
  add("volumes_height_negative", {1.0, -1.0});
  add("volumes_height_nan", {1.0, std::numeric_limits<double>::quiet_NaN()});
  add("volumes_width_infinite", {std::numeric_limits<double>::infinity(), 1.0});
  add("volumes_beyond_floats", {1e300, 1.0});
  add("volumes_below_floats", {1.0, 1e-300});
}

// As of cells (damage_far_places): where two floats meet, there is still a box.
void damage_places(const bytes& whole, const place_list& places, damaged_list& list) {
  constexpr std::int32_t most = 1 << 30;
  const auto add = [&](const std::string& name, const format::lattice_place& last, status expected) {
    place_list changed = places;
    changed.back() = last;
    list.push_back({name, expected, with_volumes(whole, shape, changed)});
  };
  const std::array<const char*, 3> axes{"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = [&](std::int32_t value) {
      std::array<std::int32_t, 3> xyz{};
      xyz[axis] = value;
      return format::lattice_place{xyz[0], xyz[1], xyz[2], 0};
    };
    const std::string name = axes[axis];
    add("undamaged_volume_far_in_" + name, at(most - 33), status::ok);
    add("volume_too_far_in_" + name, at(most + 64), status::corrupt);
    add("undamaged_volume_far_behind_in_" + name, at(-most + 32), status::ok);
    add("volume_too_far_behind_in_" + name, at(-most - 65), status::corrupt);
  }
  add("volume_between_floats", {most - 65, 0, 0, 0}, status::corrupt);
}

void damage_counts(const bytes& whole, const place_list& places, damaged_list& list) {
  list.push_back({"volumes_none", status::corrupt, with_volumes(whole, shape, {})});
  const auto add = [&](const char* name, std::uint32_t count, status expected) {
    bytes section = volumes_of(shape, {places.front()});  // columns of no bits
    set_u32(section, 16, count);
    list.push_back({name, expected, with_section(whole, layout::section_volumes, section), count == 4});
  };
  add("volumes_above_limit", layout::max_volumes + 1, status::limit);
  add("volumes_above_section", 8 * (20 + 24) + 1, status::corrupt);
  add("volumes_all_at_one_place", 4, status::corrupt);
  place_list twice = places;
  twice[2] = twice[0];
  list.push_back({"volume_twice", status::corrupt, with_volumes(whole, shape, twice), true});
}

void damage_sizes(const bytes& whole, damaged_list& list) {
  const bytes section = section_of(whole, layout::section_volumes);
  const auto add = [&](const char* name, const bytes& damaged) {
    list.push_back({name, status::corrupt, with_section(whole, layout::section_volumes, damaged)});
  };
  add("volumes_cut", longer(section, -1));
  add("volumes_longer", longer(section, 1));
  bytes cut = section;
  cut.resize(19);
  add("volumes_cut_in_count", cut);
  cut = section;
  cut.resize(20 + 23);
  add("volumes_cut_in_descriptors", cut);
  cut.clear();
  add("volumes_empty", cut);
  bytes wide = longer(section, 15);  // as long as four values of 33 bits make it
  set_u32(wide, 20 + 2 * 8 + 4, 33);
  add("volume_column_of_33_bits", wide);
}

void damage_records(const bytes& whole, damaged_list& list) {
  constexpr std::uint32_t volumes = layout::section_volumes;
  list.push_back({"volumes_not_required", status::corrupt, with_record(whole, volumes, volumes, 0)});
  list.push_back({"volumes_section_twice", status::corrupt, with_record(whole, layout::section_settings, volumes, 1)});
  list.push_back({"volumes_missing", status::corrupt, with_record(whole, volumes, 18, 0), true});
  bytes sum = whole;
  sum[section_place(sum, volumes) + 24] ^= std::byte{1};
  reseal_front(sum);
  list.push_back({"section_10_checksum", status::checksum, std::move(sum)});
}

void damage_bounds(const bytes& whole, damaged_list& list) {
  const auto add = [&](const char* name, std::uint32_t runs, std::uint32_t ranges, bool later) {
    bytes out = whole;
    set_u32(out, layout::header_run_bound, runs);
    set_u32(out, layout::header_range_bound, ranges);
    reseal(out);
    list.push_back({name, status::corrupt, std::move(out), later});
  };
  add("run_bound_above_volumes", 11, 11, false);
  add("range_bound_above_volumes", 2, 5, false);
  add("range_bound_above_ranges_with_volumes", 2, 4, true);
  add("range_bound_without_volumes", 2, 2, true);
}

}  // namespace

damaged_list damaged_volumes() {
  const sample_contents contents = contents_with_volumes();
  const bytes whole = contents.encode();
  damaged_list list;
  list.push_back({"undamaged_volumes", status::ok, whole});
  damage_shapes(whole, contents.volumes, list);
  damage_places(whole, contents.volumes, list);
  damage_counts(whole, contents.volumes, list);
  damage_sizes(whole, list);
  damage_records(whole, list);
  damage_bounds(whole, list);
  place_list fewer = contents.volumes;
  fewer.pop_back();
  list.push_back({"row_leaves_volumes", status::corrupt, with_volumes(whole, shape, fewer), true});
  return list;
}

}  // namespace sightcell::test
