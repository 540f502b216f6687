// Faults of draw groups, which the merged layout has.
#include <functional>

#include "damaged_file.h"
#include "golden_contents.h"
#include "polygon_orders_writer.h"
#include "sightcell/format/layout.h"
#include "table_encoder.h"

namespace sightcell::test {
namespace layout = format::layout;
namespace {

using bytes = std::vector<std::byte>;
using format::draw_record;
using format::status;

// Two draws of one group, and one that lies between them in the source. Cell 0 sees the first group whole.
sample_contents grouped_contents() {
  sample_contents contents = tiny_contents();
  contents.facts.layout = format::host_layout::merged;
  contents.draws = {{.node = 2, .material = 1, .polygon_count = 2},
                    {.node = 4, .material = 1, .first_source = 4, .polygon_count = 2, .first_stored = 2},
                    {.node = 3, .material = 2, .group = 1, .first_source = 2, .polygon_count = 2, .first_stored = 4}};
  contents.orders = {{3, 0, 2, 1}, {1, 0}};
  contents.order_of_draw = {0, 0, 1};
  contents.sets = {{0, 1, 4, 5}, {1}};
  return contents;
}

bytes with_draws(const bytes& file, const sample_contents& contents) {
  bytes orders;
  format::put_orders(contents.orders, orders);
  const bytes draws = format::encode_draws(contents.draws, contents.order_of_draw);
  return with_section(with_section(file, layout::section_draws, draws), layout::section_orders, orders);
}

// Each draw where the one before it ends.
void lay_out(std::vector<draw_record>& draws) {
  std::uint32_t next = 0;
  for (draw_record& d : draws) {
    d.first_stored = next;
    next += d.polygon_count;
  }
}

}  // namespace

damaged_list damaged_groups() {
  const sample_contents contents = grouped_contents();
  const bytes whole = contents.encode();
  damaged_list list{{"undamaged_groups", status::ok, whole}};
  const auto add = [&](const char* name, const std::function<void(sample_contents&)>& damage) {
    sample_contents damaged = contents;
    damage(damaged);
    list.push_back({name, status::corrupt, with_draws(whole, damaged)});
  };
  add("group_number_skipped", [](auto& c) {
    c.orders.insert(c.orders.begin() + 1, 1, {});
    c.draws[2].group = c.order_of_draw[2] = 2;
  });
  add("group_begins_at_1", [](auto& c) {
    c.orders.insert(c.orders.begin(), 1, {});
    for (std::size_t i = 0; i < 3; ++i) c.draws[i].group = ++c.order_of_draw[i];
  });
  add("group_comes_again", [](auto& c) {
    std::swap(c.draws[1], c.draws[2]);
    std::swap(c.order_of_draw[1], c.order_of_draw[2]);
    lay_out(c.draws);
  });
  add("group_has_order_of_another", [](auto& c) { c.order_of_draw[2] = 0; });
  add("group_order_too_long", [](auto& c) { c.orders[0] = {4, 3, 0, 2, 1}; });
  add("group_order_too_short", [](auto& c) { c.orders[0] = {2, 0, 1}; });
  add("group_order_of_no_group", [](auto& c) { c.orders.emplace_back(); });
  add("group_of_two_materials", [](auto& c) { c.draws[1].material = 2; });
  add("group_not_in_order_of_source", [](auto& c) {
    std::swap(c.draws[0], c.draws[1]);
    lay_out(c.draws);
  });
  add("group_first_draw_moves", [](auto& c) { c.draws[0].flags = format::draw_moves; });
  add("group_last_draw_moves", [](auto& c) { c.draws[1].flags = format::draw_moves; });
  add("group_order_has_polygon_twice", [](auto& c) { c.orders[0] = {3, 0, 3, 1}; });
  list.back().later = true;
  add("draw_flags_2", [](auto& c) { c.draws[2].flags = 2; });
  add("draws_descend", [](auto& c) { std::swap(c.draws[1].first_stored, c.draws[2].first_stored); });
  add("draws_begin_above_0", [](auto& c) {
    c.draws[0].first_stored = 1;
    c.orders[0] = {2, 0, 1};
  });
  // As many ranges as draws would make.
  list.push_back({"range_bound_of_draws", status::corrupt, changed(whole, layout::header_range_bound, 2), true});
  return list;
}

}  // namespace sightcell::test
