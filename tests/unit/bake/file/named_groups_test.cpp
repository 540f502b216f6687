// Named groups of a scene in the files that are baked from it.
#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "file/pvs_output.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/patch.h"
#include "sightcell/bake/recode.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "sightcell/format/writer.h"
#include "sightcell/scene/scene.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"
#include "unit/scene/gltf_sketch.h"

namespace sightcell::bake {
namespace {

using nlohmann::json;

constexpr auto instanced = host_layout::instanced;
constexpr auto merged = host_layout::merged;

json in_group(const char* name) {
  return {{"sightcell", {{"group", name}}}};
}

// Six nodes of one mesh, three of them doors, in two groups; a third group has no mesh.
scene::scene scene_with_doors(const std::filesystem::path& folder) {
  gltf_sketch g;
  g.add_mesh(g.add_row_of_triangles(20, 0.0f));
  const std::vector<json> extras = {json::object(), in_group("west door"), in_group("east door"),
                                    json::object(), in_group("west door"), json::object()};
  for (std::size_t i = 0; i < extras.size(); ++i) {
    g.add_node({{"mesh", 0}, {"translation", {0, static_cast<double>(i), 0}}, {"extras", extras[i]}});
  }
  g.add_node({{"extras", in_group("nothing")}});
  const std::filesystem::path path = folder / "doors.glb";
  const std::string bytes = g.glb();
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return scene::load_gltf(path);
}

class named_groups_test : public testing::Test {
 protected:
  // Three cells.
  std::vector<std::byte> file_of(host_layout layout, bool names = false) {
    std::vector<cell_record> records(3);
    std::vector<view_cell> cells;
    for (std::uint32_t cell = 0; cell < 3; ++cell) {
      for (std::uint32_t id = 0; id < scene_.polygon_count; ++id)
        if (id % (cell + 2) == 0) records[cell].set.push_back(id);
      view_cell& box = cells.emplace_back();
      box.min = {static_cast<float>(cell), 0, 0};
      box.max = {static_cast<float>(cell) + 1, 1, 1};
      records[cell].bound_met = true;
    }
    settings how;
    how.file.layout = layout;
    how.file.names = names;
    how.file.profile = slack_profile::exact;
    summary sum;
    write_pvs(
        frame_of(scene_, how, describe(how), cells), [&](std::uint32_t cell) { return records[cell]; }, path_, {}, sum);
    return test::file_bytes(path_);
  }

  std::vector<std::byte> recoded(const std::vector<std::byte>& file, const recode_settings& how) {
    (void)recode(file, "doors.pvs", how, path_);
    return test::file_bytes(path_);
  }

  test::fresh_folder folder_;
  scene::scene scene_ = scene_with_doors(folder_.path());
  std::filesystem::path path_ = folder_ / "doors.pvs";
};

// The group's name of each node that is drawn.
std::map<std::uint32_t, std::string> groups_in(const std::vector<std::byte>& file) {
  format::reader opened;
  format::file_parts parts;
  EXPECT_EQ(format::reader::open(file, opened), format::status::ok);
  EXPECT_EQ(format::take_apart(opened, parts), format::status::ok);
  EXPECT_EQ(parts.named_groups.size(), 2u) << "nothing is in the third";
  std::map<std::uint32_t, std::string> groups;
  for (const format::draw_record& d : parts.draws)
    groups[d.node] = d.named_group == format::no_named_group ? "" : parts.named_groups.at(d.named_group);
  return groups;
}

const std::map<std::uint32_t, std::string> expected = {{0, ""}, {1, "west door"}, {2, "east door"},
                                                       {3, ""}, {4, "west door"}, {5, ""}};

TEST_F(named_groups_test, are_in_the_file_of_both_layouts) {
  EXPECT_EQ(groups_in(file_of(instanced)), expected);
  EXPECT_EQ(groups_in(file_of(merged)), expected);
}

// Six instances of one geometry; the sketch gives neither nodes nor meshes names.
TEST_F(named_groups_test, hashes_and_names_are_baked_added_and_kept) {
  scene_.node_names[2] = std::string("gate\0x", 6);
  scene_.mesh_names[0] = "row";
  const std::vector<std::byte> plain = file_of(instanced);
  const std::vector<std::byte> named = file_of(instanced, true);
  EXPECT_GT(named.size(), plain.size());
  recode_settings how;
  how.names_from = &scene_;
  EXPECT_EQ(recoded(plain, how), named);
  how.names_from = nullptr;
  EXPECT_EQ(recoded(named, how), named);
  const std::vector<added_polygons> additions = {{.cell = 0, .first = 1, .count = 2}};
  (void)patch(named, "doors.pvs", additions, path_);
  for (const std::vector<std::byte>& file : {named, test::file_bytes(path_), file_of(merged, true)}) {
    format::reader opened;
    format::file_parts parts;
    ASSERT_EQ(format::reader::open(file, opened), format::status::ok);
    ASSERT_EQ(format::take_apart(opened, parts), format::status::ok);
    ASSERT_EQ(parts.geometry_hashes.size(), 6u);
    EXPECT_NE(parts.geometry_hashes[0], 0u);
    for (const std::uint64_t hash : parts.geometry_hashes) EXPECT_EQ(hash, parts.geometry_hashes[0]);
    EXPECT_EQ(parts.node_names, (std::vector<std::string>{"", "", "gate"}));
    EXPECT_EQ(parts.mesh_names, std::vector<std::string>{"row"});
  }
}

TEST_F(named_groups_test, stay_when_a_file_is_written_anew) {
  for (const host_layout layout : {instanced, merged}) {
    const std::vector<std::byte> file = file_of(layout);
    recode_settings how;
    EXPECT_EQ(groups_in(recoded(file, how)), expected);
    how.profile = slack_profile::small;
    EXPECT_EQ(groups_in(recoded(file, how)), expected);
    const std::vector<added_polygons> additions = {{.cell = 0, .first = 1, .count = 2}};
    (void)patch(file, "doors.pvs", additions, path_);
    EXPECT_EQ(groups_in(test::file_bytes(path_)), expected);
  }
}

TEST_F(named_groups_test, stay_in_another_layout) {
  recode_settings to_merged;
  to_merged.layout = merged;
  to_merged.layout_from = &scene_;
  const std::vector<std::byte> file = recoded(file_of(instanced), to_merged);
  EXPECT_EQ(groups_in(file), expected);
  recode_settings back;
  back.layout = instanced;
  EXPECT_EQ(groups_in(recoded(file, back)), expected);
}

// Of a file from before there were any, the scene that its layout is told by tells them.
TEST_F(named_groups_test, come_with_the_scene_of_a_layout) {
  const std::vector<std::byte> file = file_of(instanced);
  format::reader opened;
  format::set_reader sets;
  format::file_parts parts;
  ASSERT_EQ(format::reader::open(file, opened), format::status::ok);
  ASSERT_EQ(sets.open(opened), format::status::ok);
  ASSERT_EQ(format::take_apart(opened, parts), format::status::ok);
  parts.named_groups.clear();
  for (format::draw_record& d : parts.draws) d.named_group = format::no_named_group;
  std::vector<std::byte> before;
  ASSERT_EQ(format::encode(parts.contents({parts.cells.size(),
                                           [&](std::uint32_t cell, std::vector<std::uint32_t>& set) {
                                             return sets.source_ids(cell, set);
                                           }}),
                           before),
            format::status::ok);
  recode_settings to_merged;
  to_merged.layout = merged;
  to_merged.layout_from = &scene_;
  EXPECT_EQ(groups_in(recoded(before, to_merged)), expected);
}

}  // namespace
}  // namespace sightcell::bake
