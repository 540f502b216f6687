#include "seeing_test.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numeric>

#include "sightcell/bake/bake.h"
#include "sightcell/bake/verify.h"
#include "sightcell/base/error.h"
#include "sightcell/format/file_parts.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/writer.h"
#include "sightcell/picture/gl_context.h"
#include "unit/bake/file_bytes.h"
#include "unit/bake/stored_file.h"

namespace sightcell::test {
namespace {

using polygon_set = std::vector<std::uint32_t>;

polygon_set set_of(const std::vector<std::byte>& bytes) {
  test::stored_file file(bytes);
  EXPECT_EQ(file.reader().cell_count(), 1u);
  return file.reader().cell_count() == 1 ? file.set(0) : polygon_set{};
}

// The same file with this set in its only cell.
std::vector<std::byte> with_set(const std::vector<std::byte>& bytes, const polygon_set& set) {
  format::reader file;
  EXPECT_EQ(format::reader::open(bytes, file), format::status::ok);
  format::file_parts parts;
  EXPECT_EQ(format::take_apart(file, parts), format::status::ok);
  std::vector<std::byte> out;
  EXPECT_EQ(format::encode(parts.contents(format::sets_of({&set, 1})), out), format::status::ok);
  return out;
}

place_box grown(const trial& t) {
  const auto margin = static_cast<double>(t.how.margin);
  const auto corner = [](const std::array<float, 3>& p) { return glm::dvec3(p[0], p[1], p[2]); };
  return {corner(t.cell.min) - margin, corner(t.cell.max) + margin};
}

seeing_rules rules_of(const bake::settings& how) {
  seeing_rules rules;
  rules.player_radius = static_cast<double>(how.player_radius);
  rules.all_double_sided = how.all_double_sided;
  rules.animated = how.animated;
  rules.smallest_gap = static_cast<double>(how.smallest_gap);
  return rules;
}

bool contains(const polygon_set& set, std::uint32_t polygon) {
  return std::binary_search(set.begin(), set.end(), polygon);
}

}  // namespace

bake::settings trial::usual() {
  bake::settings how;
  how.resolution = 64;
  how.max_pixel_error = 1e-4;
  how.file.profile = bake::slack_profile::exact;
  return how;
}

void seeing_test::SetUp() {
  try {
    const picture::gl_context probe;
    sources_.push_back("gpu");
  } catch (const error& e) {
    std::fprintf(stderr, "without gpu: %s\n", e.what());
  }
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  folder_ = std::filesystem::path(testing::TempDir()) / (std::string("sightcell_seeing_") + test->name());
  std::filesystem::remove_all(folder_);
  std::filesystem::create_directories(folder_);
}

void seeing_test::TearDown() {
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

std::string seeing_test::name_of(std::uint32_t polygon) const {
  return names_[polygon] + " (polygon " + std::to_string(polygon) + ", seen by " +
         std::to_string(truth_.hits[polygon]) + " of " + std::to_string(truth_.rays) + " rays and " +
         std::to_string(truth_.aimed[polygon]) + " aimed ones)";
}

polygon_set seeing_test::bake_set(const scene::scene& s, const trial& t, const bake::settings& how) {
  bake::settings one_cell = how;
  one_cell.cells = {t.cell};
  const bake::summary sum = bake::bake(s, one_cell, file(), true, {});
  EXPECT_EQ(sum.result, bake::outcome::done);
  return set_of(file_bytes(file()));
}

void seeing_test::check(const scene::scene& s, const expectation& expected, const trial& t) {
  ASSERT_LT(s.polygon_count, 50u);
  check_reference(s, expected, t);
  if (HasFatalFailure()) return;
  check_with_rays(s, t);
  check_verify(s, expected, t);
  if (t.hemicubes) check_hemicubes(s, t);
}

// What the scene says by name is what the reference finds, and nothing lies between seen and not seen.
void seeing_test::check_reference(const scene::scene& s, const expectation& expected, const trial& t) {
  names_.assign(s.polygon_count, "");
  seen_.assign(s.polygon_count, false);
  for (const bool seen : {true, false}) {
    for (const named_polygons& group : seen ? expected.sees : expected.does_not_see) {
      for (std::uint32_t i = group.first; i < group.first + group.count; ++i) {
        ASSERT_LT(i, s.polygon_count);
        ASSERT_EQ(names_[i], "") << "named twice: " << group.name;
        names_[i] = group.name;
        seen_[i] = seen;
      }
    }
  }
  truth_ = brute_force(s, rules_of(t.how)).see(grown(t), t.effort);
  ASSERT_GT(truth_.eyes, 0u);
  for (std::uint32_t i = 0; i < s.polygon_count; ++i) {
    ASSERT_NE(names_[i], "") << "polygon " << i << " has no name";
    ASSERT_EQ(truth_.belongs(i), seen_[i]) << name_of(i);
    if (!truth_.never_seen(i)) {
      ASSERT_GE(truth_.share(i), t.least_share) << "too hard to see: " << name_of(i);
    }
  }
}

void seeing_test::check_with_rays(const scene::scene& s, const trial& t) {
  bake::settings how = t.how;
  for (const std::string& source : sources_) {
    how.source = source;
    const polygon_set set = bake_set(s, t, how);
    for (std::uint32_t i = 0; i < s.polygon_count; ++i)
      EXPECT_EQ(contains(set, i), seen_[i]) << "baked with " << source << " and rays: " << name_of(i);
  }
}

void seeing_test::check_hemicubes(const scene::scene& s, const trial& t) {
  bake::settings how = t.how;
  how.max_pixel_error = 0.0;
  for (const std::string& source : sources_) {
    how.source = source;
    const polygon_set set = bake_set(s, t, how);
    for (std::uint32_t i = 0; i < s.polygon_count; ++i) {
      const bool must = truth_.share(i) >= t.hemicube_share || truth_.inside[i] || truth_.told[i];
      if (must || !seen_[i]) {
        EXPECT_EQ(contains(set, i), seen_[i]) << "baked with hemicubes of " << source << " alone: " << name_of(i);
      }
    }
  }
}

// On the file of the bake with rays.
void seeing_test::check_verify(const scene::scene& s, const expectation& expected, const trial& t) {
  const std::vector<std::byte> bytes = file_bytes(file());
  const polygon_set whole = set_of(bytes);
  bake::verify_settings how;
  how.rays = t.verify_rays;
  const auto judge = [&](const polygon_set& set) { return bake::verify(s, with_set(bytes, set), "cell.pvs", how, {}); };
  const auto missing = [](const bake::verification& v, std::uint32_t polygon) {
    return std::any_of(v.missing.begin(), v.missing.end(),
                       [&](const bake::missing_polygon& m) { return m.polygon == polygon; });
  };
  EXPECT_EQ(judge(whole).misses, 0u) << "verify is content with the whole set";

  polygon_set excused;
  for (const named_polygons& group : expected.excused)
    for (std::uint32_t i = group.first; i < group.first + group.count; ++i) excused.push_back(i);
  polygon_set damaged = whole, dropped;
  for (const named_polygons& group : expected.sees) {
    for (std::uint32_t i = group.first; i < group.first + group.count; ++i) {
      if (contains(excused, i) || truth_.share(i) < t.least_share) continue;
      dropped.push_back(i);
      std::erase(damaged, i);
      break;
    }
  }
  ASSERT_FALSE(dropped.empty());
  const bake::verification found = judge(damaged);
  for (const std::uint32_t polygon : dropped) EXPECT_TRUE(missing(found, polygon)) << "dropped " << name_of(polygon);
  seeing_effort once = t.effort;
  once.passes = 1;
  const double error = brute_force(s, rules_of(t.how)).error_of(damaged, grown(t), once);
  EXPECT_NEAR(found.pixel_error, error, 0.2 * error + 5.0 * std::sqrt(error / static_cast<double>(found.rays)))
      << "verify and the reference disagree by how much the set is wrong";

  polygon_set without_all = whole;
  for (const std::uint32_t polygon : excused) {
    polygon_set without = whole;
    std::erase(without, polygon);
    std::erase(without_all, polygon);
    EXPECT_EQ(judge(without).misses, 0u) << "not to be counted: " << name_of(polygon);
  }
  if (!excused.empty()) {
    EXPECT_EQ(judge(without_all).misses == 0, expected.excused_together) << "all that is excused left out at once";
  }
}

}  // namespace sightcell::test
