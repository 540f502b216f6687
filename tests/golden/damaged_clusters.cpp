// Faults of the clusters, and of orders in runs, which files with clusters have.
#include "bit_sink.h"
#include "byte_sink.h"
#include "code_table_writer.h"
#include "damaged_file.h"
#include "packed_columns_writer.h"
#include "polygon_orders_writer.h"
#include "sightcell/format/layout.h"
#include "unit/format/cluster_samples.h"

namespace sightcell::test {
namespace layout = format::layout;
namespace {

using bytes = std::vector<std::byte>;
using numbers = std::vector<std::uint32_t>;
using format::status;

// firsts: clusters before each order, then all.
bytes cluster_section(const numbers& firsts, const numbers& sizes) {
  bytes out;
  format::put_columns(std::vector<numbers>{firsts}, out);
  format::put_columns(std::vector<numbers>{sizes}, out);
  return out;
}

// Two draws with an order each, of clusters with 2 and 1 polygons and with 1 and 2.
sample_contents clustered_contents() {
  sample_contents contents = whole_contents();
  contents.orders = {{2, 0, 1}, {0, 2, 1}};
  contents.order_of_draw = {0, 1};
  put_in_clusters(contents, 1, 2);
  contents.clusters = {{2, 1}, {1, 2}};
  contents.sets = {{0, 2, 3}, {1, 4, 5}};
  return contents;
}

void damage_cluster_sizes(const bytes& whole, damaged_list& list) {
  const auto add = [&](const char* name, const bytes& section, status expected = status::corrupt) {
    list.push_back({name, expected, with_section(whole, layout::section_clusters, section)});
  };
  add("undamaged_clusters_again", cluster_section({0, 2, 4}, {2, 1, 1, 2}), status::ok);
  add("clusters_begin_above_0", cluster_section({1, 3, 5}, {2, 1, 1, 2, 1}));
  add("clusters_descend", cluster_section({0, 5, 4}, {2, 1, 1, 2}));
  add("cluster_empty", cluster_section({0, 3, 5}, {2, 0, 1, 1, 2}));
  add("cluster_too_long", cluster_section({0, 2, 4}, {2, 2, 1, 2}));
  add("cluster_too_short", cluster_section({0, 2, 4}, {2, 1, 1, 1}));
  add("cluster_above_256", cluster_section({0, 2, 4}, {2, 257, 1, 2}));
  add("clusters_of_no_order", cluster_section({0, 2, 4, 4, 4, 4}, {2, 1, 1, 2}));
  add("order_without_clusters", cluster_section({0, 2, 2}, {2, 1}));
  add("clusters_more_than_polygons", cluster_section({0, 2, 1u << 30}, {}));
  const bytes section = section_of(whole, layout::section_clusters);
  add("clusters_cut", longer(section, -1));
  add("clusters_longer", longer(section, 1));
  add("clusters_empty", {});
  add("clusters_cut_in_descriptor", bytes(section.begin(), section.begin() + 15));
  add("cluster_column_of_33_bits", changed(longer(section, 4), 4, 33));
}

// Orders of the two draws with runs as (step, length - 1) by codes of two bits for 0 to 3, or by one for 64.
bytes orders_in_runs(const std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>>& orders,
                     const format::symbol_lengths& lengths = {2, 2, 2, 2}) {
  const auto code = [](std::uint32_t number) { return (number & 1) << 1 | number >> 1; };  // the highest bit first
  bytes out;
  format::byte_sink sink(out);
  sink.put_u32(static_cast<std::uint32_t>(orders.size()));
  numbers polygons{0}, firsts{0};
  bytes runs;
  for (const auto& order : orders) {
    format::bit_sink bits(runs);
    for (const auto& [step, more] : order) {
      bits.put(code(step), 2);
      bits.put(code(more), 2);
    }
    bits.align();
    polygons.push_back(polygons.back() + 3);
    firsts.push_back(static_cast<std::uint32_t>(runs.size()));
  }
  format::put_columns(std::vector<numbers>{polygons, firsts}, out);
  format::put_code_lengths({2, 2, 2, 2}, out);
  format::put_code_lengths(lengths, out);
  sink.put_bytes(runs);
  return longer(std::move(out), 8);
}

void damage_order_runs(const bytes& whole, damaged_list& list) {
  const auto add = [&](const char* name, const bytes& section, status expected = status::corrupt, bool later = true) {
    list.push_back({name, expected, with_section(whole, layout::section_orders, section), later});
  };
  // 0, 1, 2 as one run; the steps 3 and 1 go two forward, or one back.
  add("undamaged_order_runs", orders_in_runs({{{0, 2}}, {{0, 2}}}), status::ok, false);
  add("order_run_leaves_draw", orders_in_runs({{{2, 2}}, {{0, 2}}}));
  add("order_run_leaves_order", orders_in_runs({{{0, 3}}, {{0, 2}}}));
  add("order_run_again", orders_in_runs({{{0, 1}, {3, 0}}, {{0, 2}}}));
  add("order_run_left", orders_in_runs({{{0, 2}, {0, 0}, {0, 0}}, {{0, 2}}}));
  add("order_run_is_no_code", orders_in_runs({{{0, 2}}, {{0, 2}}}, {2, 2}), status::corrupt, false);
  bytes plain;
  format::put_orders(std::vector<numbers>{{2, 0, 1}, {0, 2, 1}}, plain);
  add("order_without_runs", plain, status::corrupt, false);
}

}  // namespace

damaged_list damaged_clusters() {
  const bytes whole = clustered_contents().encode();
  constexpr std::uint32_t own = layout::section_clusters;
  damaged_list list;
  list.push_back({"undamaged_clusters", status::ok, whole});
  damage_cluster_sizes(whole, list);
  damage_order_runs(whole, list);
  list.push_back({"clusters_not_required", status::corrupt, with_record(whole, own, own, 0)});
  list.push_back({"clusters_twice", status::corrupt, with_record(whole, layout::section_settings, own, 1)});
  list.push_back({"clusters_missing", status::corrupt, with_record(whole, own, 18, 0)});
  // Readers from before clusters.
  list.push_back({"clusters_unknown", status::version, with_record(whole, own, 18, 1)});
  bytes sum = whole;
  sum[section_place(sum, own) + 24] ^= std::byte{1};
  reseal_front(sum);
  list.push_back({"section_16_checksum", status::checksum, std::move(sum)});
  return list;
}

}  // namespace sightcell::test
