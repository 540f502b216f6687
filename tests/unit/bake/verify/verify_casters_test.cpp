// Files with shadow casters: what a bake finds, and a caster that is taken out.
#include "sightcell/bake/verify_casters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

#include "errors/error_id.h"
#include "file/caster_sets.h"
#include "sightcell/bake/bake.h"
#include "sightcell/bake/patch.h"
#include "sightcell/bake/recode.h"
#include "sightcell/base/error.h"
#include "sightcell/format/caster_writer.h"
#include "sightcell/format/set_reader.h"
#include "unit/bake/court.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/fresh_folder.h"

namespace sightcell::bake {
namespace {

using ids = std::vector<std::uint32_t>;
using pvs_bytes = std::vector<std::byte>;

const sun_setting sun_at_noon{{0.0, 90.0}, {0.0, 90.0}}, sun_from_north{{0.0, 10.0}, {0.0, 10.0}};

class shadow_casters : public testing::Test {
 protected:
  settings how() const {
    settings s;
    s.cells = {{"eye", {-0.5f, 1.0f, 1.5f}, {0.5f, 1.8f, 2.5f}}, {"aside", {3.0f, 1.0f, 1.5f}, {4.0f, 1.8f, 2.5f}}};
    s.max_pixel_error = 1e-3;
    s.source = "cpu";
    s.file.profile = slack_profile::exact;
    return s;
  }

  pvs_bytes baked(const std::vector<sun_setting>& suns, summary* sum = nullptr) {
    settings s = how();
    s.suns = suns;
    const summary result = bake(scene_, s, path(), true, {});
    EXPECT_EQ(result.result, outcome::done);
    if (sum != nullptr) *sum = result;
    return test::file_bytes(path());
  }

  // What the host draws into the shadow map.
  ids drawn(const pvs_bytes& file, std::uint32_t cell, std::uint32_t sun) {
    format::reader opened;
    format::set_reader sets;
    caster_set_reader casters;
    EXPECT_EQ(format::reader::open(file, opened), format::status::ok);
    EXPECT_EQ(sets.open(opened), format::status::ok);
    EXPECT_EQ(casters.open(opened), format::status::ok);
    ids seen, extra, all;
    EXPECT_EQ(sets.source_ids(cell, seen), format::status::ok);
    EXPECT_EQ(casters.source_ids(cell, sun, extra), format::status::ok);
    std::merge(seen.begin(), seen.end(), extra.begin(), extra.end(), std::back_inserter(all));
    EXPECT_TRUE(std::adjacent_find(all.begin(), all.end()) == all.end()) << "a caster is no member of the set";
    return all;
  }

  std::filesystem::path path(const char* name = "court.pvs") const { return folder_.path() / name; }

  test::fresh_folder folder_;
  test::court court_;
  scene::scene scene_ = court_.tiny.finished();
};

bool has(const ids& set, std::uint32_t polygon) {
  return std::binary_search(set.begin(), set.end(), polygon);
}

TEST_F(shadow_casters, of_a_bake_pass_their_verification) {
  summary sum;
  const pvs_bytes file = baked({sun_at_noon, sun_from_north}, &sum);
  ASSERT_EQ(sum.suns.size(), 2u);
  for (const sun_summary& sun : sum.suns) {
    EXPECT_LE(sun.max_upper_bound, 1e-3);
    EXPECT_EQ(sun.cells_over_bound, 0u);
    EXPECT_GT(sun.casters_per_cell, 0.0);
  }
  for (std::uint32_t cell = 0; cell < 2; ++cell) {
    EXPECT_TRUE(has(drawn(file, cell, 0), court_.near_roof));
    EXPECT_TRUE(has(drawn(file, cell, 0), court_.far_roof));
    EXPECT_FALSE(has(drawn(file, cell, 0), court_.unseen_roof));
    EXPECT_TRUE(has(drawn(file, cell, 1), court_.unseen_roof));
  }
  const caster_verification v = verify_casters(scene_, file, "court.pvs", {.rays = 20'000}, {});
  ASSERT_EQ(v.suns.size(), 2u);
  for (const sun_verification& sun : v.suns) {
    EXPECT_EQ(sun.rays, 20'000u);
    EXPECT_LE(sun.upper_bound, 1e-3);
    EXPECT_EQ(sun.cells.size(), 2u);
  }
}

// The rays of the long cell hardly ever meet the shadow of a card beside the short one.
TEST_F(shadow_casters, of_adjacent_cells_are_tried) {
  const std::uint32_t card =
      court_.tiny.quad({-2.0f, 3.0f, 2.1f}, {-1.85f, 3.0f, 2.1f}, {-1.85f, 3.0f, 1.95f}, {-2.0f, 3.0f, 1.95f});
  scene_ = court_.tiny.finished();
  settings s = how();
  s.max_pixel_error = 1e-2;
  s.suns = {sun_at_noon};
  const cell_box along = {"along", {0.5f, 1.0f, 1.5f}, {19.0f, 1.8f, 2.5f}};
  const auto casters_of = [&](std::uint32_t cell) {
    EXPECT_EQ(bake(scene_, s, path(), true, {}).result, outcome::done);
    return drawn(test::file_bytes(path()), cell, 0);
  };
  s.cells = {along};
  EXPECT_FALSE(has(casters_of(0), card)) << "alone, it does not find the card";
  s.cells = {along, {"short", {-0.5f, 1.0f, 1.5f}, {0.5f, 1.8f, 2.5f}}};
  EXPECT_TRUE(has(casters_of(0), card));
  EXPECT_TRUE(has(casters_of(1), card));
}

TEST_F(shadow_casters, change_nothing_else_in_the_file) {
  const pvs_bytes with = baked({sun_at_noon});
  pvs_bytes without;
  ASSERT_EQ(format::remove_casters(with, without), format::status::ok);
  const pvs_bytes plain = baked({});
  format::reader a, b;
  ASSERT_EQ(format::reader::open(without, a), format::status::ok);
  ASSERT_EQ(format::reader::open(plain, b), format::status::ok);
  EXPECT_EQ(a.section_count(), b.section_count());
  EXPECT_EQ(without.size(), plain.size() + std::string(R"(,"suns":[[0,90,0,90]])").size())
      << "the settings name the sun";
  EXPECT_TRUE(baked({sun_at_noon}) == with) << "and the casters are the same again";
}

TEST_F(shadow_casters, that_are_taken_out_are_found_and_named) {
  const pvs_bytes file = baked({sun_at_noon});
  format::reader opened;
  caster_set_reader casters;
  ASSERT_EQ(format::reader::open(file, opened), format::status::ok);
  ASSERT_EQ(casters.open(opened), format::status::ok);
  format::caster_source source;
  std::vector<format::certificate_record> proofs(2);
  ASSERT_EQ(casters.table().sun(0, source.suns.emplace_back()), format::status::ok);
  for (std::uint32_t cell = 0; cell < 2; ++cell)
    ASSERT_EQ(casters.table().certificate(cell, 0, proofs[cell]), format::status::ok);
  source.certificate = proofs;
  source.get = [&](std::uint32_t cell, std::uint32_t sun, ids& out) {
    const format::status s = casters.source_ids(cell, sun, out);
    if (cell == 1) std::erase(out, court_.near_roof);
    return s;
  };
  pvs_bytes faulty;
  ASSERT_EQ(format::put_casters(file, source, faulty), format::status::ok);
  const caster_verification v = verify_casters(scene_, faulty, "court.pvs", {.rays = 20'000}, {});
  EXPECT_GT(v.suns[0].upper_bound, 1e-3);
  ASSERT_EQ(v.missing.size(), 1u);
  EXPECT_EQ(v.missing[0].polygon, court_.near_roof);
  EXPECT_EQ(v.missing[0].cell, 1u);
  EXPECT_EQ(v.missing[0].rays, v.suns[0].misses);
  EXPECT_NEAR(v.missing[0].target[1], 0.0f, 1e-3f) << "a point of the floor";
}

TEST_F(shadow_casters, stay_with_a_file_that_is_recoded_or_patched) {
  const pvs_bytes file = baked({sun_at_noon, sun_from_north});
  recode(file, "court.pvs", {.profile = slack_profile::small, .order = polygon_order_kind::per_instance},
         path("recoded.pvs"));
  patch(file, "court.pvs", std::vector<added_polygons>{{.cell = 0, .first = court_.near_roof, .count = 1}},
        path("patched.pvs"));
  for (const char* name : {"recoded.pvs", "patched.pvs"}) {
    const pvs_bytes made = test::file_bytes(path(name));
    for (std::uint32_t cell = 0; cell < 2; ++cell)
      for (std::uint32_t sun = 0; sun < 2; ++sun) {
        const ids before = drawn(file, cell, sun), after = drawn(made, cell, sun);
        EXPECT_TRUE(std::includes(after.begin(), after.end(), before.begin(), before.end())) << name;
      }
    const caster_verification v = verify_casters(scene_, made, name, {.rays = 4'000}, {});
    EXPECT_EQ(v.suns[0].misses + v.suns[1].misses, 0u) << name;
  }
}

TEST_F(shadow_casters, of_a_file_without_any_are_an_error) {
  const pvs_bytes file = baked({});
  EXPECT_EQ(test::error_id([&] { verify_casters(scene_, file, "court.pvs", {}, {}); }), "pvs.no-casters");
}

TEST_F(shadow_casters, settings_are_checked) {
  const auto id = [&](const sun_setting& sun, double bound = 1e-3, double budget = 0.0) {
    settings s = how();
    s.suns = {sun};
    s.max_pixel_error = bound;
    s.time_budget = budget;
    return test::error_id([&] { validate(s); });
  };
  EXPECT_EQ(id(sun_at_noon), "");
  EXPECT_EQ(id({{400.0, 10.0}, {0.0, 10.0}}), "settings.out-of-range");
  EXPECT_EQ(id({{0.0, 91.0}, {0.0, 90.0}}), "settings.out-of-range");
  EXPECT_EQ(id({{0.0, 0.0}, {100.0, 0.0}}), "settings.out-of-range");
  EXPECT_EQ(id({{0.0, 0.0}, {80.0, 0.0}}), "");
  EXPECT_EQ(id(sun_at_noon, 0.0), "settings.suns");
  EXPECT_EQ(id(sun_at_noon, 1e-3, 60.0), "settings.suns");
}

}  // namespace
}  // namespace sightcell::bake
