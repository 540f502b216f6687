#include "stream/group_similar.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <utility>

namespace sightcell::bake {
namespace {

constexpr std::size_t sample_size = 256;
constexpr std::size_t smallest_share = 3;  // a division leaves at least 1/3 of the sample on each side

std::uint64_t size_of(std::span<const grouped_item> items) {
  std::uint64_t size = 0;
  for (const grouped_item& item : items) size += item.size;
  return size;
}

// Estimates the number of elements of a union from the smallest hashes, whose mean is 1 / (n + 1) of their range.
// without: a component that is left out; sketch_size: none.
double elements_of(const sketch& seen, std::size_t without) {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < sketch_size; ++i) {
    if (i == without) continue;
    sum += static_cast<double>(seen[i]) / 2147483648.0;
    count += 1.0;
  }
  return count / std::max(sum, 1e-6) - 1.0;
}

// One side of a division: what its items cost together. Each cell loads all of a group for any part of it, so the cost
// is the size for each element of the union.
class side {
 public:
  void add(const grouped_item& item) {
    join(seen_, *item.seen);
    size_ += item.size;
    ++count_;
  }
  // The component that divides is left out: one side would have none of its smallest values and seem to have few
  // elements.
  double cost(std::size_t without) const { return static_cast<double>(size_) * elements_of(seen_, without); }
  std::size_t count() const { return count_; }

 private:
  sketch seen_ = sketch_table::nothing();
  std::uint64_t size_ = 0;
  std::size_t count_ = 0;
};

// Items whose place, or a component of whose sketch, is in a range.
struct division {
  int axis = -1;  // of the place; -1: of the sketch
  float place = 0.0f;
  std::size_t component = sketch_size;
  std::uint32_t first = 0, last = 0;  // values

  bool has_first(const grouped_item& item) const {
    if (axis >= 0) return item.place[axis] < place;
    const std::uint32_t value = (*item.seen)[component];
    return first <= value && value <= last;
  }
};

// Tries divisions on a sample.
class division_search {
 public:
  explicit division_search(std::span<const grouped_item> items) {
    const std::size_t count = std::min(items.size(), sample_size);
    for (std::size_t i = 0; i < count; ++i) sample_.push_back(&items[i * items.size() / count]);
  }

  // Returns a division of low cost; nothing if all items are in one place.
  std::optional<division> best() {
    for (const int axis : axes_by_length()) try_axis(axis);
    bool divided = false;
    for (std::size_t component = 0; component < sketch_size; ++component) divided |= try_frequent(component);
    // Of many small sets of cells none is frequent enough. Estimates are noisy, so where one is, these do more harm.
    for (std::size_t component = 0; component < sketch_size && !divided && !best_; ++component) try_middle(component);
    return best_;
  }

 private:
  // The longest first, which so wins where all divisions cost the same.
  std::array<int, 3> axes_by_length() const {
    glm::vec3 min = sample_.front()->place, max = min;
    for (const grouped_item* item : sample_)
      for (int k = 0; k < 3; ++k) min[k] = std::min(min[k], item->place[k]), max[k] = std::max(max[k], item->place[k]);
    const glm::vec3 length = max - min;
    std::array<int, 3> axes = {0, 1, 2};
    std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return length[a] > length[b]; });
    return axes;
  }

  void try_axis(int axis) {
    std::vector<float> values;
    for (const grouped_item* item : sample_) values.push_back(item->place[axis]);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    try_one({.axis = axis, .place = *middle});
  }

  std::vector<std::uint32_t> sorted_values(std::size_t component) const {
    std::vector<std::uint32_t> values;
    for (const grouped_item* item : sample_) values.push_back((*item->seen)[component]);
    std::sort(values.begin(), values.end());
    return values;
  }

  // Tries those with one of the two most frequent values of a component. Returns whether one is frequent enough.
  bool try_frequent(std::size_t component) {
    const std::vector<std::uint32_t> values = sorted_values(component);
    std::array<std::pair<std::size_t, std::uint32_t>, 2> most{};
    for (std::size_t begin = 0, end = 0; begin < values.size(); begin = end) {
      while (end < values.size() && values[end] == values[begin]) ++end;
      most[1] = std::max(most[1], {end - begin, values[begin]});
      if (most[0] < most[1]) std::swap(most[0], most[1]);
    }
    bool found = false;
    for (const auto& [count, value] : most)
      if (count > 0) found |= try_one({.component = component, .first = value, .last = value});
    return found;
  }

  // Tries those up to a value in the middle: items that are visible from the same cells have one value and stay
  // together.
  void try_middle(std::size_t component) {
    const std::vector<std::uint32_t> values = sorted_values(component);
    const auto half = static_cast<std::ptrdiff_t>(values.size() / 2);
    const auto after = std::upper_bound(values.begin(), values.end(), values[static_cast<std::size_t>(half)]);
    const auto before = std::lower_bound(values.begin(), values.end(), values[static_cast<std::size_t>(half)]);
    const bool upper = before == values.begin() || after - (values.begin() + half) < half - (before - values.begin());
    try_one({.component = component, .first = 0, .last = upper ? *(after - 1) : *(before - 1)});
  }

  // Returns whether the division leaves enough on each side.
  bool try_one(const division& one) {
    side first, second;
    for (const grouped_item* item : sample_) (one.has_first(*item) ? first : second).add(*item);
    if (std::min(first.count(), second.count()) * smallest_share < sample_.size()) return false;
    const double cost = first.cost(one.component) + second.cost(one.component);
    if (cost < least_) {
      least_ = cost;
      best_ = one;
    }
    return true;
  }

  std::vector<const grouped_item*> sample_;
  std::optional<division> best_;
  double least_ = std::numeric_limits<double>::infinity();
};

// Returns the number of items of the first half.
std::size_t divide(std::span<grouped_item> items) {
  const std::optional<division> best = division_search(items).best();
  if (best) {
    const auto middle = std::stable_partition(items.begin(), items.end(),
                                              [&](const grouped_item& item) { return best->has_first(item); });
    return static_cast<std::size_t>(middle - items.begin());
  }
  return items.size() / 2;
}

}  // namespace

std::vector<std::span<grouped_item>> group_similar(std::span<grouped_item> items, std::uint64_t limit) {
  std::vector<std::span<grouped_item>> groups, open;
  if (!items.empty()) open.push_back(items);
  while (!open.empty()) {
    const std::span<grouped_item> part = open.back();
    open.pop_back();
    if (part.size() > 1 && size_of(part) > limit) {
      const std::size_t first = divide(part);
      open.push_back(part.subspan(first));
      open.push_back(part.first(first));
      continue;
    }
    // Groups that follow each other are similar: two that fit together are one.
    if (!groups.empty() && size_of(groups.back()) + size_of(part) <= limit)
      groups.back() = std::span(groups.back().data(), groups.back().size() + part.size());
    else
      groups.push_back(part);
  }
  return groups;
}

}  // namespace sightcell::bake
