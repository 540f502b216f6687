#include "cell_set.h"

#include <algorithm>

namespace sightcell::bake {

void cell_set::clear() {
  for (const std::uint32_t polygon : members_) entries_[polygon] = {};
  members_.clear();
  eyes_.clear();
}

void cell_set::add_view(const glm::vec3& eye, const std::vector<seen_polygon>& seen) {
  const auto eye_index = static_cast<std::uint32_t>(eyes_.size());
  eyes_.push_back(eye);
  for (const seen_polygon& s : seen) {
    entry& e = entries_[s.id];
    if (s.pixels <= e.pixels) continue;
    if (e.pixels == 0) join(s.id, {s.pixels, eye_index});
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

void cell_set::join(std::uint32_t polygon, const entry& as) {
  entries_[polygon] = as;
  members_.push_back(polygon);
  if (!duplicates_) return;
  for (const std::uint32_t same : duplicates_->class_of(polygon)) {
    if (contains(same)) continue;
    entries_[same] = {1, as.eye};
    members_.push_back(same);
  }
}

std::vector<std::uint32_t> cell_set::sorted() const {
  std::vector<std::uint32_t> ids = members_;
  std::sort(ids.begin(), ids.end());
  return ids;
}

}  // namespace sightcell::bake
