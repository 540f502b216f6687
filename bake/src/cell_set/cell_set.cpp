#include "cell_set/cell_set.h"

#include <algorithm>
#include <bit>

#include "cell_set/point_order.h"

namespace sightcell::bake {
namespace {

// number: of a hemicube, from 1 on.
std::size_t growth_step(std::uint32_t number) {
  return std::min<std::size_t>(static_cast<std::size_t>(std::bit_width(number - 1)), growth_steps - 1);
}

}  // namespace

void cell_set::clear() {
  for (const std::uint32_t polygon : members_) entries_[polygon] = {};
  members_.clear();
  eyes_.clear();
  volumes_.clear();
  found_ = {};
  growth_ = {};
  hemicubes_ = 0;
}

void cell_set::add_view(const glm::vec3& eye, const std::vector<seen_polygon>& seen) {
  const auto eye_index = static_cast<std::uint32_t>(eyes_.size());
  eyes_.push_back(eye);
  std::uint32_t& joined = growth_[growth_step(++hemicubes_)];
  for (const seen_polygon& s : seen) {
    entry& e = entries_[s.id];
    if (s.pixels <= e.pixels) continue;
    if (e.pixels == 0) joined += join(s.id, {s.pixels, eye_index});
    e = {s.pixels, eye_index};
  }
}

bool cell_set::add(std::uint32_t polygon, const glm::vec3& eye) {
  if (contains(polygon)) return false;
  const auto eye_index = static_cast<std::uint32_t>(eyes_.size());
  eyes_.push_back(eye);
  join(polygon, {1, eye_index});
  return true;
}

void cell_set::add_members(const cell_record& record, const std::vector<std::uint8_t>& keep) {
  std::vector<std::uint32_t> eye_of(record.witnesses.size());
  std::vector<bool> used(record.witnesses.size());
  for (std::size_t i = 0; i < record.set.size(); ++i)
    if (keep[i] != 0 && !contains(record.set[i])) used[record.witness_of[i]] = true;
  for (std::size_t w = 0; w < used.size(); ++w) {
    if (!used[w]) continue;
    eye_of[w] = static_cast<std::uint32_t>(eyes_.size());
    eyes_.push_back(record.witnesses[w]);
  }
  for (std::size_t i = 0; i < record.set.size(); ++i)
    if (keep[i] != 0 && !contains(record.set[i])) join(record.set[i], {1, eye_of[record.witness_of[i]]});
}

std::uint32_t cell_set::join(std::uint32_t polygon, const entry& as) {
  entries_[polygon] = as;
  members_.push_back(polygon);
  std::uint32_t count = 1;
  if (duplicates_) {
    for (const std::uint32_t same : duplicates_->class_of(polygon)) {
      if (contains(same)) continue;
      entries_[same] = {1, as.eye};
      members_.push_back(same);
      ++count;
    }
  }
  found_[static_cast<std::size_t>(how_)] += count;
  return count;
}

std::vector<std::uint32_t> cell_set::sorted() const {
  std::vector<std::uint32_t> ids = members_;
  const auto sorted = std::is_sorted_until(ids.begin(), ids.end());  // those that load() brought
  std::sort(sorted, ids.end());
  std::inplace_merge(ids.begin(), sorted, ids.end());
  return ids;
}

void cell_set::save(cell_record& record) const {
  record.set = sorted();
  record.volumes = volumes_.members();
  record.found = found_;
  record.growth = growth_;
  // Each witness once, in an order that does not depend on the order of joining.
  std::vector<glm::vec3>& witnesses = record.witnesses;
  witnesses.clear();
  std::vector<bool> used(eyes_.size());
  for (const std::uint32_t polygon : members_) used[entries_[polygon].eye] = true;
  for (std::size_t eye = 0; eye < eyes_.size(); ++eye)
    if (used[eye]) witnesses.push_back(eyes_[eye]);
  sort_unique(witnesses);
  std::vector<std::uint32_t> witness_index(eyes_.size());
  for (std::size_t eye = 0; eye < eyes_.size(); ++eye)
    if (used[eye])
      witness_index[eye] = static_cast<std::uint32_t>(
          std::lower_bound(witnesses.begin(), witnesses.end(), eyes_[eye], is_lower) - witnesses.begin());
  record.witness_of.clear();
  record.witness_of.reserve(record.set.size());
  for (const std::uint32_t polygon : record.set) record.witness_of.push_back(witness_index[entries_[polygon].eye]);
}

void cell_set::load(const cell_record& record) {
  clear();
  eyes_ = record.witnesses;
  members_ = record.set;
  found_ = record.found;
  growth_ = record.growth;
  hemicubes_ = record.samples;
  for (std::size_t i = 0; i < members_.size(); ++i) entries_[members_[i]] = {1, record.witness_of[i]};
  for (const std::uint32_t volume : record.volumes) volumes_.add(volume);
}

}  // namespace sightcell::bake
