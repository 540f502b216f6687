// Every status, flag and kind of the headers, by a call of the C API that returns it; and for each function exactly the
// statuses that its comment documents. The list of functions and values is read from the headers, so that an addition
// needs a row here. The calls are in outcomes_of_*.cpp.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "outcome_calls.h"
#include "sightcell/identity.h"

namespace {

using namespace sightcell::test;

const statuses with_arguments{SIGHTCELL_OK, SIGHTCELL_ERR_ARGUMENT};
const statuses of_lists{SIGHTCELL_OK, SIGHTCELL_ERR_ARGUMENT, SIGHTCELL_ERR_CAPACITY};
const statuses of_open{SIGHTCELL_OK,           SIGHTCELL_ERR_ARGUMENT, SIGHTCELL_ERR_MEMORY,
                       SIGHTCELL_ERR_NOT_OURS, SIGHTCELL_ERR_VERSION,  SIGHTCELL_ERR_TRUNCATED,
                       SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CORRUPT,  SIGHTCELL_ERR_LIMIT};

statuses operator+(statuses all, const statuses& more) {
  all.insert(more.begin(), more.end());
  return all;
}

// The statuses that the comments of sightcell.h document.
const statuses of_identity{SIGHTCELL_ERR_ABSENT, SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CORRUPT, SIGHTCELL_PENDING};
const std::map<std::string, statuses> promised{
    {"sightcell_db_open", of_open + statuses{SIGHTCELL_ERR_ABSENT}},
    {"sightcell_db_open_file", of_open + statuses{SIGHTCELL_ERR_ABSENT, SIGHTCELL_ERR_IO}},
    // STALE is what the host's request returned.
    {"sightcell_db_open_source", of_open + statuses{SIGHTCELL_ERR_IO, SIGHTCELL_ERR_CAPACITY, SIGHTCELL_ERR_STALE}},
    {"sightcell_db_begin_source",
     of_open + statuses{SIGHTCELL_PENDING, SIGHTCELL_ERR_IO, SIGHTCELL_ERR_CAPACITY, SIGHTCELL_ERR_STALE}},
    {"sightcell_db_opened",
     of_open + statuses{SIGHTCELL_PENDING, SIGHTCELL_ERR_IO, SIGHTCELL_ERR_CAPACITY, SIGHTCELL_ERR_STALE}},
    {"sightcell_db_same_scene", with_arguments + statuses{SIGHTCELL_ERR_OTHER_SCENE}},
    {"sightcell_db_deliver",
     with_arguments + statuses{SIGHTCELL_ERR_STALE, SIGHTCELL_ERR_TRUNCATED, SIGHTCELL_ERR_CORRUPT,
                               SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CAPACITY}},
    {"sightcell_db_prefetch", with_arguments},
    {"sightcell_db_cell_box", with_arguments},
    {"sightcell_db_cell_viewpoints", with_arguments},
    {"sightcell_db_volume_box", with_arguments},
    {"sightcell_db_named_group_name", of_lists},
    {"sightcell_db_find_named_group", with_arguments},
    {"sightcell_db_named_groups_of_draws", of_lists},
    {"sightcell_view_show_named_group", with_arguments},
    {"sightcell_db_info", with_arguments},
    // open finds the other faults of a file.
    {"sightcell_db_check",
     with_arguments + statuses{SIGHTCELL_ERR_MEMORY, SIGHTCELL_ERR_IO, SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CORRUPT}},
    {"sightcell_db_draws", of_lists},
    {"sightcell_db_order", of_lists},
    {"sightcell_view_create", with_arguments + statuses{SIGHTCELL_ERR_MEMORY, SIGHTCELL_PENDING}},
    {"sightcell_view_move", with_arguments},
    {"sightcell_view_move_box", with_arguments},
    {"sightcell_view_policy", with_arguments},
    {"sightcell_view_origin", with_arguments},
    {"sightcell_view_polygons", of_lists},
    {"sightcell_view_ranges", of_lists},
    {"sightcell_view_indices", of_lists},
    {"sightcell_view_commands", of_lists + statuses{SIGHTCELL_ERR_LIMIT}},
    {"sightcell_view_objects", of_lists},
    {"sightcell_view_importance",
     of_lists + statuses{SIGHTCELL_ERR_ABSENT, SIGHTCELL_ERR_STALE, SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CORRUPT}},
    {"sightcell_view_box_visible", with_arguments},
    {"sightcell_view_changes", of_lists + statuses{SIGHTCELL_ERR_STALE}},
    {"sightcell_view_statistics", with_arguments},
    {"sightcell_db_statistics", with_arguments},
    {"sightcell_view_debug_lines", of_lists + statuses{SIGHTCELL_ERR_CORRUPT}},
    {"sightcell_db_misses_text", of_lists},
    {"sightcell_db_cell_eye",
     with_arguments + statuses{SIGHTCELL_ERR_ABSENT, SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CORRUPT, SIGHTCELL_PENDING}},
    {"sightcell_db_error_bounds", of_lists + statuses{SIGHTCELL_ERR_ABSENT, SIGHTCELL_PENDING}},
    {"sightcell_geometry_hash", with_arguments},
    {"sightcell_db_match", with_arguments + of_identity + statuses{SIGHTCELL_ERR_OTHER_SCENE, SIGHTCELL_ERR_MEMORY}},
    {"sightcell_db_draw_hash", with_arguments + of_identity},
    {"sightcell_db_draw_name", of_lists + of_identity},
    {"sightcell_cluster_map_create", with_arguments + statuses{SIGHTCELL_ERR_MEMORY, SIGHTCELL_PENDING}},
    {"sightcell_db_clusters", of_lists + statuses{SIGHTCELL_PENDING}},
    {"sightcell_cluster_map_of_file",
     with_arguments + statuses{SIGHTCELL_ERR_MEMORY, SIGHTCELL_ERR_ABSENT, SIGHTCELL_PENDING}},
    {"sightcell_view_clusters", of_lists},
    {"sightcell_casters_create",
     with_arguments + statuses{SIGHTCELL_ERR_ABSENT, SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CORRUPT,
                               SIGHTCELL_ERR_MEMORY, SIGHTCELL_PENDING}},
    {"sightcell_casters_suns", of_lists},
    {"sightcell_view_casters", of_lists},
    {"sightcell_view_caster_indices", of_lists},
    {"sightcell_lights_create",
     with_arguments + statuses{SIGHTCELL_ERR_ABSENT, SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CORRUPT,
                               SIGHTCELL_ERR_MEMORY, SIGHTCELL_PENDING}},
    {"sightcell_lights_list", of_lists},
    {"sightcell_view_lights", of_lists},
    {"sightcell_view_light_ranges", of_lists},
    {"sightcell_view_light_indices", of_lists},
    {"sightcell_residency_create",
     with_arguments + statuses{SIGHTCELL_ERR_ABSENT, SIGHTCELL_ERR_CHECKSUM, SIGHTCELL_ERR_CORRUPT,
                               SIGHTCELL_ERR_MEMORY, SIGHTCELL_PENDING}},
    {"sightcell_residency_textures", of_lists},
    {"sightcell_view_texture_levels", of_lists},
    {"sightcell_residency_cell_levels", of_lists},
    {"sightcell_cluster_list", of_lists},
    {"sightcell_cluster_changes", of_lists},
};

TEST(every_outcome, is_reached) {
  outcomes out;
  open_from_memory(out);
  open_from_disk(out);
  open_from_a_source(out);
  open_without_waiting(out);
  deliver_and_prefetch(out);
  facts(out);
  eyes(out);
  identities(out);
  names(out);
  places(out);
  sets_while_pending(out);
  lists(out);
  clusters(out);
  clusters_of_files(out);
  shadow_casters(out);
  lamps(out);
  residencies(out);
  boxes(out);
  importance(out);

  const header there = read_headers();
  ASSERT_GT(there.functions.size(), 20u);
  ASSERT_GT(there.enumerators.size(), 20u);
  for (const std::string& name : there.functions) {
    EXPECT_TRUE(promised.contains(name)) << name << " has no row";
  }
  EXPECT_EQ(there.functions.size(), promised.size());
  statuses all;
  for (const auto& [name, expected] : promised) {
    EXPECT_EQ(out.of_function[name], expected) << name;
    all = all + out.of_function[name];
  }
  std::map<std::string, int> families;
  for (const auto& [name, value] : there.enumerators) {
    const auto is = [&, &of = name](const char* family) { return of.starts_with(family) && ++families[family] > 0; };
    if (is("FRAME_")) {
      EXPECT_NE(out.frame_flags & value, 0u) << name;
    } else if (is("DEBUG_")) {
      EXPECT_NE(out.debug_kinds & value, 0u) << name;
    } else if (is("OUTSIDE_")) {
      EXPECT_TRUE(out.polygons_outside.contains(value)) << name;
    } else if (is("PENDING_")) {
      EXPECT_TRUE(out.kept_while_pending.contains(value)) << name;
    } else {
      const auto status = static_cast<sightcell_status>(value);
      EXPECT_TRUE(all.contains(status)) << name;
    }
  }
  EXPECT_EQ(families.size(), 4u) << "the header is read as it is written";
  const std::map<std::uint32_t, std::uint32_t> outside{
      {SIGHTCELL_OUTSIDE_ALL, 6}, {SIGHTCELL_OUTSIDE_NEAREST, 1}, {SIGHTCELL_OUTSIDE_LAST, 4}};
  EXPECT_EQ(out.polygons_outside, outside);
  EXPECT_EQ(out.kept_while_pending.count(0), 0u) << "kept without being asked to";
}

}  // namespace
