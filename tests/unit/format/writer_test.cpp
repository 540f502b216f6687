#include "sightcell/format/writer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <thread>

#include "sample_contents.h"
#include "sightcell/format/layout.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/set_reader.h"
#include "unit/case_step.h"

namespace {

using namespace sightcell::format;
using namespace sightcell::test;

status outcome(const sample_contents& contents) {
  std::vector<std::byte> bytes{std::byte{42}};
  const status s = encode(contents.view(), bytes);
  if (s != status::ok) {
    EXPECT_EQ(bytes.size(), 1u) << "out is unchanged on failure";
  }
  return s;
}

bool is_long(const std::vector<std::uint32_t>& order) {
  return order.size() > 100;
}

void expect_round_trip(const sample_contents& contents) {
  const auto bytes = contents.encode();
  EXPECT_EQ(bytes, contents.encode()) << "same contents, same bytes";
  reader file;
  ASSERT_EQ(reader::open(bytes, file), status::ok);
  ASSERT_EQ(check_all(file), status::ok);
  ASSERT_EQ(file.cell_count(), contents.sets.size());
  for (std::uint32_t cell = 0; cell < file.cell_count(); ++cell) {
    status s = status::ok;
    ASSERT_EQ(decode_set(file, cell, s), contents.sets[cell]) << cell;
  }
}

TEST(writer, random_sets_come_back) {
  std::uint32_t seed = 1;
  for (const std::uint32_t polygons : {1u, 7u, 300u, 5000u}) {
    for (const std::uint32_t cells : {1u, 63u, 64u, 65u, 200u}) {
      for (const double changed : {0.02, 0.6}) {
        if (seed++ % std::min<std::size_t>(case_step(), 3) != 0) continue;
        sample_contents contents = random_contents(seed, {.polygons = polygons, .cells = cells, .changed = changed});
        expect_round_trip(contents);
        put_in_order(contents, seed);
        put_on_lattice(contents);
        expect_round_trip(contents);
        put_in_groups(contents, seed);
        expect_round_trip(contents);
      }
    }
  }
}

// A source that returns the sets of contents one at a time, like a bake.
struct asked_sets {
  explicit asked_sets(const sample_contents& from) : contents(from), changed(from.view()) {
    changed.cell_sets.get = [this](std::uint32_t cell, std::vector<std::uint32_t>& set) {
      EXPECT_TRUE(set.empty()) << cell;
      EXPECT_EQ(cell, asked++ % contents.sets.size());
      if (cell == failing) return status::io;
      set = contents.sets[cell];
      return status::ok;
    };
  }
  const sample_contents& contents;
  file_contents changed;
  std::uint32_t asked = 0;
  std::uint32_t failing = 0xFFFFFFFFu;
};

// The last piece of work begins first, and two run at the same time.
void run_backward(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::mutex taking;
  const auto take = [&] {
    while (true) {
      std::size_t item = 0;
      {
        const std::scoped_lock lock(taking);
        if (count == 0) return;
        item = --count;
      }
      work(item);
    }
  };
  std::thread other(take);
  take();
  other.join();
}

TEST(writer, threads_do_not_change_the_bytes) {
  sample_contents contents = random_contents(5, {.polygons = 500, .cells = 400, .changed = 0.1});
  add_volumes(contents, 20, 5);
  for (const double slack : {0.0, 0.05}) {
    file_contents view = contents.view();
    view.slack = slack;
    view.chunk_bytes = 500;  // several chunks in a group of cells
    std::vector<std::byte> alone;
    ASSERT_EQ(encode(view, alone), status::ok);
    std::size_t most = 0;
    view.run_at_once = [&](std::size_t count, const std::function<void(std::size_t)>& work) {
      most = std::max(most, count);
      run_backward(count, work);
    };
    const auto most_with = [&](std::size_t groups, bool any_thread) {
      most = 0;
      view.groups_at_once = groups;
      view.cell_sets.any_thread = any_thread;
      std::vector<std::byte> together;
      EXPECT_EQ(encode(view, together), status::ok);
      EXPECT_EQ(together, alone) << groups << ' ' << any_thread;
      return most;
    };
    EXPECT_EQ(most_with(4, false), 4u);
    EXPECT_EQ(most_with(3, false), 16u) << "the last group is alone, and its 16 cells are planned at once";
    EXPECT_EQ(most_with(100, false), 7u) << "400 cells are 7 groups";
    EXPECT_EQ(most_with(3, true), 24u) << "sets are read eight at a time";
    EXPECT_EQ(most_with(100, true), 50u);
  }
}

TEST(writer, a_status_ends_work_on_several_groups) {
  sample_contents contents = random_contents(6, {.polygons = 300, .cells = 300});
  file_contents view = contents.view();
  view.run_at_once = run_backward;
  view.groups_at_once = 3;
  view.cell_sets.get = [&](std::uint32_t cell, std::vector<std::uint32_t>& set) {
    set = contents.sets[cell];
    return cell == 250 ? status::io : status::ok;
  };
  std::vector<std::byte> bytes;
  EXPECT_EQ(encode(view, bytes), status::io);
  EXPECT_TRUE(bytes.empty());
}

void run_elsewhere(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::thread other([&] {
    for (std::size_t item = 0; item < count; ++item) work(item);
  });
  other.join();
}

// Even if rows are encoded on the calling thread.
TEST(writer, sets_that_any_thread_may_read_are_read_by_the_runner) {
  const sample_contents contents = random_contents(6, {.polygons = 300, .cells = 300});
  std::uint32_t failing = 0xFFFFFFFFu;
  const std::thread::id caller = std::this_thread::get_id();
  file_contents view = contents.view();
  view.cell_sets = {contents.sets.size(),
                    [&](std::uint32_t cell, std::vector<std::uint32_t>& set) {
                      EXPECT_TRUE(set.empty()) << cell;
                      EXPECT_NE(std::this_thread::get_id(), caller);
                      set = contents.sets[cell];
                      return cell >= failing ? status::io : status::ok;
                    },
                    true};
  view.run_at_once = run_elsewhere;
  std::vector<std::byte> bytes;
  ASSERT_EQ(encode(view, bytes), status::ok);
  EXPECT_EQ(bytes, contents.encode());
  failing = 270;
  bytes.clear();
  EXPECT_EQ(encode(view, bytes), status::io);
  EXPECT_TRUE(bytes.empty());
}

TEST(writer, reads_every_set_in_order_each_time) {
  const auto contents = random_contents(9, {.polygons = 300, .cells = 150});
  asked_sets sets(contents);
  std::vector<std::byte> bytes;
  ASSERT_EQ(encode(sets.changed, bytes), status::ok);
  EXPECT_EQ(sets.asked, 4 * 150u);
  EXPECT_EQ(bytes, contents.encode());
}

TEST(writer, ends_with_the_status_of_a_set) {
  const auto contents = random_contents(9, {.polygons = 300, .cells = 150});
  asked_sets sets(contents);
  sets.failing = 70;
  std::vector<std::byte> bytes{std::byte{42}};
  EXPECT_EQ(encode(sets.changed, bytes), status::io);
  EXPECT_EQ(bytes.size(), 1u) << "out is unchanged on failure";
  EXPECT_EQ(sets.asked, 71u);
  sets.changed.cell_sets.get = nullptr;
  EXPECT_EQ(encode(sets.changed, bytes), status::argument);
}

TEST(writer, empty_things) {
  expect_round_trip({});
  sample_contents no_cells;
  add_draws(no_cells, 10, 3);
  expect_round_trip(no_cells);
  sample_contents no_polygons;
  no_polygons.cells.push_back({{0, 0, 0}, {1, 1, 1}});
  no_polygons.sets.emplace_back();
  expect_round_trip(no_polygons);
}

TEST(writer, difference_rows_pay_where_neighbors_are_alike) {
  const auto alike = random_contents(6, {.polygons = 20000, .cells = 64, .changed = 0.03}).encode();
  reader file;
  ASSERT_EQ(reader::open(alike, file), status::ok);
  set_reader sets;
  row_statistics sums;
  ASSERT_EQ(sets.open(file), status::ok);
  ASSERT_EQ(sets.statistics(sums), status::ok);
  EXPECT_GT(sums.delta_row_percent(), 40.0);
  const auto unlike = random_contents(6, {.polygons = 20000, .cells = 64, .changed = 1.0}).encode();
  EXPECT_LT(alike.size(), unlike.size() / 2);
}

TEST(writer, contents_that_contradict_themselves) {
  const auto refused = [](auto change, status expected = status::argument) {
    sample_contents contents = small_contents();
    change(contents);
    EXPECT_EQ(outcome(contents), expected);
  };
  refused([](sample_contents& c) { c.sets[3] = {5, 4}; });
  refused([](sample_contents& c) { c.sets[3] = {5, 5}; });
  refused([](sample_contents& c) { c.sets[3] = {300}; });
  refused([](sample_contents& c) { c.sets.pop_back(); });
  refused([](sample_contents& c) { c.cells.pop_back(); });
  refused([](sample_contents& c) { c.certificate.pop_back(); });
  refused([](sample_contents& c) { c.certificate[1].cell = 0; });
  refused([](sample_contents& c) { c.certificate[1].misses = c.certificate[1].rays + 1; });
  refused([](sample_contents& c) { c.certificate[1].upper_bound = 1.5; });
  refused([](sample_contents& c) { c.certificate[1].confidence = std::nan(""); });
  refused([](sample_contents& c) { c.draws[2].polygon_count = 179; });
  refused([](sample_contents& c) { c.draws[2].first_source = 121; });
  refused([](sample_contents& c) { c.draws[2].first_stored = 121; });
  refused([](sample_contents& c) { c.draws[0].polygon_count = 0xFFFFFFFFu; });
  refused([](sample_contents& c) { c.draws[0].group = 1; });
  refused([](sample_contents& c) { c.facts.slack = 1.5f; });
  refused([](sample_contents& c) { c.chunk_bytes = 0; });
  refused([](sample_contents& c) { c.facts.slack = std::nanf(""); });
  refused([](sample_contents& c) { c.cells[0].max[1] = c.cells[0].min[1]; });
  refused([](sample_contents& c) { c.cells[0].max[1] = std::numeric_limits<float>::infinity(); });
  refused([](sample_contents& c) { c.cells[0].min[0] = std::nanf(""); });
  refused([](sample_contents& c) { c.facts.margin = -0.1f; });
  refused([](sample_contents& c) { c.facts.max_pixel_error = 1.1f; });
  refused([](sample_contents& c) { c.facts.confidence = std::nanf(""); });
  refused([](sample_contents& c) { c.draws[0].flags = 2; });
  refused([](sample_contents& c) { c.facts.layout = static_cast<host_layout>(2); });
  refused([](sample_contents& c) { c.draws[0].named_group = 0; });
  refused([](sample_contents& c) { c.named_groups = {"door", ""}; });
  refused([](sample_contents& c) { c.named_groups = {"door", "lamp", "door"}; });
  refused([](sample_contents& c) {
    c.named_groups = {"door", "lamp"};
    c.draws[0].named_group = 2;
  });
  refused([](sample_contents& c) { c.named_groups = {"a", std::string(layout::max_names_size, 'b')}; }, status::limit);
  refused([](sample_contents& c) { c.named_groups = {"a", std::string(layout::max_names_size - 1, 'b')}; }, status::ok);
  refused([](sample_contents& c) { c.facts.margin = 2.0e6f; }, status::limit);
  refused([](sample_contents& c) { c.facts.polygon_count = 0xFFFFFFFFu; }, status::limit);
  refused([](sample_contents& c) { c.settings.assign(layout::max_settings_size + 1, ' '); }, status::limit);
  refused([](sample_contents& c) { c.settings.assign(layout::max_settings_size, ' '); }, status::ok);
}

TEST(writer, orders_that_are_none) {
  const auto refused = [](auto change) {
    sample_contents contents = small_contents();
    put_in_order(contents, 2);
    change(contents);
    EXPECT_EQ(outcome(contents), status::argument);
  };
  refused([](sample_contents& c) { std::find_if(c.orders.begin(), c.orders.end(), is_long)->front() = 1000; });
  refused([](sample_contents& c) {
    auto& order = *std::find_if(c.orders.begin(), c.orders.end(), is_long);
    order[0] = order[1];
  });
  refused([](sample_contents& c) { std::find_if(c.orders.begin(), c.orders.end(), is_long)->pop_back(); });
  refused([](sample_contents& c) { c.order_of_draw.pop_back(); });
  refused([](sample_contents& c) { c.order_of_draw[0] = 99; });
  refused([](sample_contents& c) { c.orders.clear(); });
  refused([](sample_contents& c) { c.orders.emplace_back(7); });  // that no draw has
  refused([](sample_contents& c) {                                // not numbered in the order in which draws name them
    std::swap(c.orders[0], c.orders[1]);
    for (std::uint32_t& number : c.order_of_draw) number = number < 2 ? 1 - number : number;
  });
}

TEST(writer, draw_groups_that_are_none) {
  const auto refused = [](auto change) {
    sample_contents contents = small_contents();
    add_draws(contents, 300, 12);
    put_in_groups(contents, 2);
    change(contents);
    EXPECT_EQ(outcome(contents), status::argument);
  };
  // Of the draws of a group, one and the next.
  const auto joined = [](const sample_contents& c) {
    std::size_t d = 0;
    while (c.draws[d].group != c.draws[d + 1].group || c.draws[d].polygon_count * c.draws[d + 1].polygon_count == 0)
      ++d;
    return d;
  };
  refused([](sample_contents& c) { c.facts.layout = host_layout::instanced; });
  refused([](sample_contents& c) { ++c.draws.back().group; });
  refused([](sample_contents& c) { c.order_of_draw[0] = 1; });
  refused([](sample_contents& c) { c.orders.emplace_back(); });
  refused([](sample_contents& c) { c.orders[0].push_back(static_cast<std::uint32_t>(c.orders[0].size())); });
  refused([&](sample_contents& c) { ++c.draws[joined(c)].material; });
  refused([&](sample_contents& c) { c.draws[joined(c)].flags = draw_moves; });
  refused([&](sample_contents& c) { c.draws[joined(c) + 1].flags = draw_moves; });
  refused([&](sample_contents& c) {
    c.named_groups = {"door"};
    c.draws[joined(c) + 1].named_group = 0;
  });
  refused([&](sample_contents& c) {
    draw_record& first = c.draws[joined(c)];
    draw_record& second = c.draws[joined(c) + 1];
    const std::uint32_t begin = first.first_stored;
    std::swap(first, second);
    first.first_stored = begin;
    second.first_stored = begin + first.polygon_count;
  });
}

// Without orders, the polygons of a group are in source order.
TEST(writer, draw_groups_without_orders) {
  sample_contents contents = small_contents();
  add_draws(contents, 300, 12);
  put_in_groups(contents, 2);
  sample_contents in_source_order = contents;
  in_source_order.orders.clear();
  in_source_order.order_of_draw.clear();
  for (auto& order : contents.orders) std::sort(order.begin(), order.end());
  EXPECT_EQ(in_source_order.encode(), contents.encode());
}

TEST(writer, lattices_that_are_none) {
  const auto refused = [](auto change) {
    sample_contents contents = small_contents();
    put_on_lattice(contents);
    change(contents);
    EXPECT_EQ(outcome(contents), status::argument);
  };
  refused([](sample_contents& c) { std::swap(c.places[3], c.places[4]); });
  refused([](sample_contents& c) { c.places[4] = c.places[3]; });
  refused([](sample_contents& c) { c.places.pop_back(); });
  refused([](sample_contents& c) { c.lattice->width = std::nan(""); });
  refused([](sample_contents& c) { c.lattice->height = 0.0; });
}

TEST(writer, grids_that_are_none) {
  const auto refused = [](auto change) {
    sample_contents contents = small_contents();
    put_on_grid(contents);
    change(contents);
    EXPECT_EQ(outcome(contents), status::argument);
  };
  refused([](sample_contents& c) { c.grid_places[4].steps_y = 0; });
  refused([](sample_contents& c) { c.grid_places[4].x = 1 << 30; });  // too far for a float
  refused([](sample_contents& c) { c.grid_places.pop_back(); });
  refused([](sample_contents& c) { c.grid->width = std::nan(""); });
  refused([](sample_contents& c) { c.grid->height = 0.0; });
  sample_contents contents = small_contents();
  put_on_grid(contents);
  const lattice_cells lattice{*contents.grid, {}};
  const std::vector<box> boxes = contents.cells;
  for (const bool with_boxes : {false, true}) {
    file_contents both = contents.view();
    if (with_boxes)
      both.cells = boxes;
    else
      both.lattice = lattice;
    std::vector<std::byte> bytes;
    EXPECT_EQ(encode(both, bytes), status::argument);
  }
}

// Draws of one mesh share one order, and it is there once.
TEST(writer, a_shared_order_is_stored_once) {
  sample_contents contents;
  add_draws(contents, 6000, 1);
  const draw_record one = contents.draws[0];
  put_in_order(contents, 3);
  const std::size_t alone = contents.encode().size();
  for (std::uint32_t i = 1; i < 10; ++i) {
    contents.draws.push_back(one);
    contents.draws.back().first_source = contents.draws.back().first_stored = 6000 * i;
    contents.order_of_draw.push_back(0);
  }
  contents.facts.polygon_count = 60000;
  expect_round_trip(contents);
  EXPECT_LT(contents.encode().size(), alone + 500);
}

}  // namespace
