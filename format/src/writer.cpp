#include "sightcell/format/writer.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "byte_sink.h"
#include "checksum.h"
#include "cluster_table_writer.h"
#include "draw_table_rules.h"
#include "eye_table_writer.h"
#include "identity_table_writer.h"
#include "named_group_table_writer.h"
#include "polygon_orders_writer.h"
#include "range_borders.h"
#include "record_rules.h"
#include "rows_encoder.h"
#include "sightcell/format/layout.h"
#include "stored_sets.h"
#include "table_encoder.h"
#include "viewpoint_table_writer.h"
#include "volume_table_writer.h"

namespace sightcell::format {
namespace {

struct section_bytes {
  std::uint32_t id = 0;
  bool required = false;
  std::vector<std::byte> bytes;
};

// Tests that the draws have each source id once. The rest is tested when their orders are known.
status check_sources(const file_contents& contents) {
  struct stretch {
    std::uint64_t begin = 0;
    std::uint64_t count = 0;
  };
  std::vector<stretch> sources;
  for (const draw_record& d : contents.draws) {
    if (d.polygon_count > 0) sources.push_back({d.first_source, d.polygon_count});
  }
  std::sort(sources.begin(), sources.end(), [](const stretch& a, const stretch& b) { return a.begin < b.begin; });
  std::uint64_t next = 0;
  for (const stretch& s : sources) {
    if (s.begin != next) return status::argument;
    next += s.count;
  }
  return next == contents.facts.polygon_count ? status::ok : status::argument;
}

bool is_permutation_of_places(std::span<const std::uint32_t> order) {
  std::vector<bool> seen(order.size(), false);
  for (const std::uint32_t place : order) {
    if (place >= order.size() || seen[place]) return false;
    seen[place] = true;
  }
  return true;
}

// Checks the draw table and its orders.
status check_draws(const file_contents& contents, const stored_order& order) {
  if (order.order_of_draw.size() != contents.draws.size()) return status::argument;
  draw_table_rules rules(contents.facts.layout, contents.facts.polygon_count);
  for (std::size_t d = 0; d < contents.draws.size(); ++d) {
    const std::uint32_t number = order.order_of_draw[d];
    if (number >= order.orders.size() || order.orders[number].size() > contents.facts.polygon_count ||
        !rules.take(contents.draws[d], number, static_cast<std::uint32_t>(order.orders[number].size()))) {
      return status::argument;
    }
  }
  if (!rules.complete(static_cast<std::uint32_t>(order.orders.size()))) return status::argument;
  const bool good = std::all_of(order.orders.begin(), order.orders.end(),
                                [](const auto& one) { return is_permutation_of_places(one); });
  return good ? check_clusters(order) : status::argument;
}

// The order of each range unit.
std::vector<std::uint32_t> unit_orders(const file_contents& contents, const stored_order& order) {
  std::vector<std::uint32_t> orders;
  for (std::size_t d = 0; d < contents.draws.size(); ++d) {
    if (begins_range_unit(contents.draws, d, contents.facts.layout)) orders.push_back(order.order_of_draw[d]);
  }
  return orders;
}

// Where range units begin in the numbers of sets, then the end of the last one.
std::vector<std::uint32_t> unit_borders(const file_contents& contents, const stored_order& order) {
  if (order.clusters.empty()) return range_borders(contents.draws, contents.facts.layout);
  std::vector<std::uint32_t> borders{0};
  for (const std::uint32_t number : unit_orders(contents, order)) {
    borders.push_back(borders.back() + static_cast<std::uint32_t>(order.clusters[number].size()));
  }
  return borders;
}

// Cells on a lattice or grid are checked when they are encoded.
status check_cells(const file_contents& contents) {
  const std::size_t cells = cell_count(contents);
  const bool sets_missing = cells > 0 && !contents.cell_sets.get;
  if (sets_missing || cells != contents.cell_sets.count) return status::argument;
  if ((contents.lattice || contents.grid) && !contents.cells.empty()) return status::argument;
  if (contents.lattice && contents.grid) return status::argument;
  for (const box& b : contents.cells) {
    if (!box_is_valid(b)) return status::argument;
  }
  return status::ok;
}

// Their positions are checked when they are encoded.
bool has_too_many_volumes(const file_contents& contents) {
  const std::size_t volumes = contents.volumes.places.size();
  return volumes > layout::max_volumes || volumes > layout::max_polygons - contents.facts.polygon_count;
}

status check_contents(const file_contents& contents) {
  if (contents.facts.polygon_count > layout::max_polygons || cell_count(contents) > layout::max_cells ||
      contents.draws.size() > layout::max_draws || contents.settings.size() > layout::max_settings_size) {
    return status::limit;
  }
  if (has_too_many_volumes(contents)) return status::limit;
  if (!facts_are_valid(contents.facts)) return status::argument;
  if (!is_share(contents.slack) || contents.chunk_bytes == 0) return status::argument;
  if (contents.facts.margin > layout::max_margin) return status::limit;
  if (const status s = check_sources(contents); s != status::ok) return s;
  if (const status s = check_cells(contents); s != status::ok) return s;
  if (!contents.certificate.empty() && contents.certificate.size() != cell_count(contents)) return status::argument;
  for (std::size_t i = 0; i < contents.certificate.size(); ++i) {
    const certificate_record& c = contents.certificate[i];
    if (c.cell != i || !certificate_is_valid(c)) return status::argument;
  }
  return status::ok;
}

// The orders, those of the source if none are given. The polygon counts of the draws have been checked.
class complete_order {
 public:
  explicit complete_order(const file_contents& contents) : given_(contents.order) {
    if (!given_.orders.empty() || !given_.order_of_draw.empty()) return;
    for (std::size_t d = 0; d < contents.draws.size(); ++d) {
      if (begins_range_unit(contents.draws, d, contents.facts.layout)) orders_.emplace_back();
      of_draw_.push_back(static_cast<std::uint32_t>(orders_.size() - 1));
      std::vector<std::uint32_t>& order = orders_.back();
      const std::size_t size = order.size();
      order.resize(size + contents.draws[d].polygon_count);
      std::iota(order.begin() + static_cast<std::ptrdiff_t>(size), order.end(), static_cast<std::uint32_t>(size));
    }
    given_ = {of_draw_, orders_, given_.clusters};
  }
  complete_order(const complete_order&) = delete;
  complete_order& operator=(const complete_order&) = delete;

  [[nodiscard]] const stored_order& get() const { return given_; }

 private:
  stored_order given_;
  std::vector<std::uint32_t> of_draw_;
  std::vector<std::vector<std::uint32_t>> orders_;
};

// Encodes all but the rows, which come last, so that everything that a reader checks at open is at the front. The
// directory has its final size. argument: invalid cells, volumes, named groups or viewpoints.
status front_sections(const file_contents& contents, const stored_order& order, const rows_encoder& rows,
                      std::vector<section_bytes>& sections) {
  std::vector<std::byte> cells;
  std::vector<std::byte> orders;
  std::vector<std::byte> clusters;
  std::vector<std::byte> volumes;
  std::vector<std::byte> named_groups;
  std::vector<std::byte> viewpoints;
  std::vector<std::byte> eyes;
  std::vector<std::byte> identity;
  if (!encode_cells(contents, cells)) return status::argument;
  if (!contents.volumes.places.empty()) {
    if (const status s = put_volumes(contents.volumes, volumes); s != status::ok) return s;
  }
  // Also without groups, since a draw may name one that does not exist.
  if (const status s = put_named_groups(contents.named_groups, contents.draws, named_groups); s != status::ok) return s;
  if (!contents.viewpoints.empty()) {
    if (const status s = put_viewpoints(contents, viewpoints); s != status::ok) return s;
    if (const status s = put_eyes(contents, eyes); s != status::ok) return s;
  }
  if (const status s = put_identity(contents, identity); s != status::ok) return s;
  put_orders(order.orders, orders, !order.clusters.empty());
  if (!order.clusters.empty()) put_clusters(order, clusters);
  sections.push_back({layout::section_draws, true, encode_draws(contents.draws, order.order_of_draw)});
  sections.push_back({layout::section_orders, true, std::move(orders)});
  if (!clusters.empty()) sections.push_back({layout::section_clusters, true, std::move(clusters)});
  sections.push_back({layout::section_cells, true, std::move(cells)});
  if (!volumes.empty()) sections.push_back({layout::section_volumes, true, std::move(volumes)});
  sections.push_back({layout::section_codes, true, rows.codes()});
  if (std::vector<std::byte> borders = rows.borders(); !borders.empty())
    sections.push_back({layout::section_borders, true, std::move(borders)});
  sections.push_back({layout::section_row_directory, true, std::vector<std::byte>(rows.directory_size())});
  if (!contents.named_groups.empty())
    sections.push_back({layout::section_named_groups, false, std::move(named_groups)});
  if (!contents.certificate.empty()) {
    sections.push_back({layout::section_certificate, false, encode_certificate(contents.certificate)});
  }
  if (!viewpoints.empty()) sections.push_back({layout::section_viewpoints, false, std::move(viewpoints)});
  if (!eyes.empty()) sections.push_back({layout::section_eyes, false, std::move(eyes)});
  if (!identity.empty()) sections.push_back({layout::section_identity, false, std::move(identity)});
  if (!contents.settings.empty()) {
    const auto text = std::as_bytes(std::span(contents.settings));
    sections.push_back({layout::section_settings, false, {text.begin(), text.end()}});
  }
  return status::ok;
}

std::vector<std::byte> encode_table(std::span<const section_bytes> front, std::span<const std::byte> rows) {
  std::vector<std::byte> bytes;
  byte_sink out(bytes);
  std::uint64_t offset = layout::header_size + (front.size() + 1) * layout::section_record_size;
  const auto put = [&](std::uint32_t id, bool required, std::span<const std::byte> section) {
    out.put_u32(id);
    out.put_u32(required ? layout::section_required : 0);
    out.put_u64(offset);
    out.put_u64(section.size());
    out.put_u32(crc32c(section));
    out.put_u32(0);
    offset += section.size();
  };
  for (const section_bytes& s : front) put(s.id, s.required, s.bytes);
  put(layout::section_rows, true, rows);
  return bytes;
}

// The slack of the sets before and the polygons, or clusters, that were added now, as a share of the visible ones;
// never rounded down.
float slack_of(const file_contents& contents, const slack_sums& sums) {
  if (sums.added == 0) return contents.facts.slack;
  const double before = 1.0 + static_cast<double>(contents.facts.slack);
  const double slack = before * (static_cast<double>(sums.added) / static_cast<double>(sums.seen)) + (before - 1.0);
  const auto nearest = static_cast<float>(slack);
  return static_cast<double>(nearest) < slack ? std::nextafter(nearest, 2.0f) : nearest;
}

void put_header(const file_contents& contents, float slack, const rows_encoder& rows, std::size_t section_count,
                std::uint64_t total_size, std::uint32_t table_checksum, std::vector<std::byte>& file) {
  byte_sink out(file);
  for (const std::uint8_t byte : layout::magic) out.put_u8(byte);
  out.put_u32(layout::version);
  out.put_u32(static_cast<std::uint32_t>(section_count));
  out.put_u64(total_size);
  for (const std::uint8_t byte : contents.facts.scene_fingerprint) out.put_u8(byte);
  out.put_u32(contents.facts.polygon_count);
  out.put_u32(static_cast<std::uint32_t>(contents.facts.layout));
  out.put_f32(contents.facts.margin);
  out.put_f32(contents.facts.max_pixel_error);
  out.put_f32(contents.facts.confidence);
  out.put_u32(contents.facts.repeatable ? 0 : layout::flag_not_repeatable);
  out.put_u32(static_cast<std::uint32_t>(cell_count(contents)));
  out.put_u32(static_cast<std::uint32_t>(contents.draws.size()));
  out.put_u32(rows.run_bound());
  out.put_u32(rows.range_bound());
  out.put_u32(rows.list_bound());
  out.put_f32(slack);
  out.put_u32(table_checksum);
  out.put_u32(crc32c(file));
}

// The rows are most of a file: they are encoded in place, and what precedes them is filled in afterwards.
status encode_file(const file_contents& contents, std::vector<std::byte>& out) {
  if (const status s = check_contents(contents); s != status::ok) return s;
  const complete_order order(contents);
  if (const status s = check_draws(contents, order.get()); s != status::ok) return s;
  stored_sets stored(contents.draws, order.get().order_of_draw, order.get().orders, contents.facts.layout,
                     static_cast<std::uint32_t>(contents.volumes.places.size()),
                     cluster_begins(order.get(), unit_orders(contents, order.get())));
  rows_encoder rows(contents, stored, unit_borders(contents, order.get()));
  if (const status s = rows.plan(); s != status::ok) return s;
  const float slack = slack_of(contents, rows.sums());
  if (slack > 1.0f) return status::limit;
  std::vector<section_bytes> sections;
  if (const status s = front_sections(contents, order.get(), rows, sections); s != status::ok) return s;
  // Readers need a bit for each draw, which a table of draws that are equal in all columns may not have.
  if (contents.draws.size() > 8 * sections.front().bytes.size()) return status::limit;
  std::size_t rows_begin = layout::header_size + (sections.size() + 1) * layout::section_record_size;
  for (const section_bytes& s : sections) rows_begin += s.bytes.size();
  std::vector<std::byte> file(rows_begin);
  std::vector<std::byte> directory;
  if (const status s = rows.write(file, directory); s != status::ok) return s;
  for (section_bytes& s : sections) {
    if (s.id == layout::section_row_directory) s.bytes = std::move(directory);
  }
  const std::vector<std::byte> table = encode_table(sections, std::span(file).subspan(rows_begin));
  std::vector<std::byte> front;
  put_header(contents, slack, rows, sections.size() + 1, file.size(), crc32c(table), front);
  byte_sink sink(front);
  sink.put_bytes(table);
  for (const section_bytes& s : sections) sink.put_bytes(s.bytes);
  std::copy(front.begin(), front.end(), file.begin());
  out = std::move(file);
  return status::ok;
}

}  // namespace

cell_set_source sets_of(std::span<const std::vector<std::uint32_t>> sets) {
  return {sets.size(),
          [sets](std::uint32_t cell, std::vector<std::uint32_t>& set) {
            set = sets[cell];
            return status::ok;
          },
          true};
}

status encode(const file_contents& contents, std::vector<std::byte>& out) {
#if defined(__cpp_exceptions)
  try {
    return encode_file(contents, out);
  } catch (const std::bad_alloc&) {
    return status::memory;
  } catch (const std::length_error&) {  // thrown by a vector above its largest size
    return status::memory;
  }
#else
  return encode_file(contents, out);
#endif
}

}  // namespace sightcell::format
