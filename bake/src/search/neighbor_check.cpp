#include "search/neighbor_check.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "cell_set/point_order.h"
#include "search/aim.h"
#include "trace/line_box.h"
#include "trace/triangle_math.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

// Number of eyes that a polygon is tested from: those closest to a neighbor's sight line, and random ones. Polygons
// in the neighbors' sets are most of what a cell lacks: in a street 4.6e-6 of a miss probability of 5.2e-6, after
// four rays for each polygon, and 3.1e-6 after these numbers of rays. Random eyes pay for large polygons only.
constexpr std::size_t most_nearest = 4;
constexpr int random_eyes = 28;

// The witnesses of all neighbors, in one list.
class neighbor_witnesses {
 public:
  explicit neighbor_witnesses(std::span<const cell_record> neighbors) {
    for (const cell_record& neighbor : neighbors) {
      begins_.push_back(static_cast<std::uint32_t>(places_.size()));
      places_.insert(places_.end(), neighbor.witnesses.begin(), neighbor.witnesses.end());
    }
  }

  std::size_t size() const { return places_.size(); }
  const glm::vec3& operator[](std::uint32_t witness) const { return places_[witness]; }
  // Returns the index of a witness of one of the neighbors.
  std::uint32_t index_of(std::uint32_t neighbor, std::uint32_t eye) const { return begins_[neighbor] + eye; }

 private:
  std::vector<glm::vec3> places_;
  std::vector<std::uint32_t> begins_;  // by neighbor
};

// A polygon that neighbors have and this cell lacks, with its witnesses in the nearest two of them.
struct candidate {
  std::uint32_t polygon = 0;
  std::array<std::uint32_t, 2> witnesses;
};

std::vector<candidate> candidates_of(std::span<const cell_record> neighbors, const neighbor_witnesses& witnesses,
                                     const cell_set& set) {
  struct sighting {
    std::uint32_t polygon, neighbor, eye;
  };
  std::vector<sighting> all;
  for (std::uint32_t n = 0; n < neighbors.size(); ++n)
    for (std::size_t i = 0; i < neighbors[n].set.size(); ++i)
      if (!set.contains(neighbors[n].set[i])) all.push_back({neighbors[n].set[i], n, neighbors[n].witness_of[i]});
  std::sort(all.begin(), all.end(), [](const sighting& a, const sighting& b) {
    return a.polygon != b.polygon ? a.polygon < b.polygon : a.neighbor < b.neighbor;
  });
  std::vector<candidate> found;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::uint32_t eye = witnesses.index_of(all[i].neighbor, all[i].eye);
    if (i == 0 || all[i].polygon != all[i - 1].polygon)
      found.push_back({all[i].polygon, {eye, eye}});
    else if (witnesses[found.back().witnesses[0]] == witnesses[found.back().witnesses[1]])
      found.back().witnesses[1] = eye;
  }
  return found;
}

// Which points of the cell closest to the witnesses of neighbors are valid. Sight lines of neighbors that pass the cell
// start there, many lines at one point, and most of these points are in a wall or in the floor: in a town 670,000 lines
// started at 21,000 points. Any thread.
class closest_points {
 public:
  explicit closest_points(std::size_t witnesses) : known_(witnesses) {}

  // test: asked where nothing is known yet. Two threads may ask it at a time.
  template <typename Test>
  bool is_valid(std::uint32_t witness, Test test) {
    std::uint8_t known = known_[witness].load(std::memory_order_relaxed);
    if (known == unknown) known_[witness].store(known = test() ? valid : invalid, std::memory_order_relaxed);
    return known == valid;
  }

 private:
  static constexpr std::uint8_t unknown = 0, valid = 1, invalid = 2;
  std::vector<std::atomic<std::uint8_t>> known_;
};

// Returns a selection of eyes from all over the cell, since all of them are examined for each candidate, and each ray
// that found something has left one.
std::vector<glm::vec3> selection_of(std::vector<glm::vec3> eyes) {
  constexpr std::size_t most = 64;
  sort_unique(eyes);
  std::vector<glm::vec3> some;
  for (std::size_t i = 0; i < most && i < eyes.size(); ++i)
    some.push_back(eyes[eyes.size() <= most ? i : i * eyes.size() / most]);
  return some;
}

// Where a sight line of a neighbor starts in the cell.
struct line_start {
  glm::vec3 eye;
  bool enters = false;  // the line enters the box there; else this is the point of the box closest to the witness
};

line_start start_of(const box& into, const glm::vec3& witness, const glm::vec3& point) {
  const glm::vec3 way = point - witness;
  float enter = 0.0f, leave = 1.0f;
  const bool enters = clip_line(into.min, into.max, witness, way, enter, leave);
  return {glm::clamp(enters ? witness + way * enter : witness, into.min, into.max), enters};
}

// The result for a group of candidates.
struct outcome_of_rays {
  std::vector<found_polygon> found;
  std::uint64_t rays = 0;
};

class tester {
 public:
  tester(const ray_scene& rays, const box& grown, const neighbor_check_settings& how,
         const std::vector<glm::vec3>& eyes, const neighbor_witnesses& witnesses, closest_points& closest,
         const cell_set& set)
      : rays_(rays),
        grown_(grown),
        how_(how),
        eyes_(eyes),
        witnesses_(witnesses),
        closest_(closest),
        aimed_(rays, how.rules.smallest_gap, set) {}

  void test(const candidate& one, outcome_of_rays& out) {
    const triangle corners = corners_of(rays_.geometry(), one.polygon);
    random_stream random(how_.seed, how_.place, how_.use, 0, name_of(corners));
    const auto aim = [&](const glm::vec3& eye, const glm::vec3& point) {
      if (!faces(rays_, one.polygon, eye)) return false;
      ++out.rays;
      return aimed_.aim(eye, point, one.polygon, out.found);
    };
    // Eyes of the set come first, because they are known to be valid. Testing another viewpoint takes 64 rays.
    const std::size_t nearest = find_nearest(witnesses_[one.witnesses[0]], random_point(corners, random));
    for (std::size_t i = 0; i < nearest; ++i)
      if (aim(eyes_[order_[i].second], random_point(corners, random))) return;
    for (const std::uint32_t witness : one.witnesses) {
      const glm::vec3 point = random_point(corners, random);
      const line_start from = start_of(grown_, witnesses_[witness], point);
      const auto is_valid = [&] { return rays_.is_valid(from.eye, how_.rules.player_radius); };
      const std::size_t before = out.found.size();
      if (aim(from.eye, point) && (from.enters ? is_valid() : closest_.is_valid(witness, is_valid))) return;
      out.found.resize(before);
    }
    if (nearest == 0) return;
    const double size = solid_angle(corners, eyes_[order_[0].second]);
    for (int i = 1; i <= random_eyes && size >= i * how_.least_solid_angle; ++i) {
      const glm::vec3 point = random_point(corners, random);  // before the eye: compilers order arguments differently
      if (aim(eyes_[random.bits() % eyes_.size()], point)) return;
    }
  }

 private:
  // Moves the eyes closest to the sight line from the witness to the front of order_; returns their number.
  std::size_t find_nearest(const glm::vec3& witness, const glm::vec3& point) {
    const glm::vec3 way = point - witness;
    const float length = glm::dot(way, way);
    const auto square_to_line = [&](const glm::vec3& eye) {
      const float along = length > 0.0f ? glm::clamp(glm::dot(eye - witness, way) / length, 0.0f, 1.0f) : 0.0f;
      const glm::vec3 off = eye - (witness + way * along);
      return glm::dot(off, off);
    };
    order_.resize(eyes_.size());
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = {square_to_line(eyes_[i]), i};
    const std::size_t count = std::min(order_.size(), most_nearest);
    std::partial_sort(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(count), order_.end());
    return count;
  }

  const ray_scene& rays_;
  const box& grown_;
  const neighbor_check_settings& how_;
  const std::vector<glm::vec3>& eyes_;
  const neighbor_witnesses& witnesses_;
  closest_points& closest_;
  aimed_rays aimed_;
  std::vector<std::pair<float, std::uint32_t>> order_;  // square of the distance to the line, index of the eye
};

// Keeps the polygons of a record for which keeps returns true; it is asked for them in ascending order.
template <typename Keeps>
void keep_if(cell_record& record, Keeps keeps) {
  std::vector<std::uint32_t> set, witness_of;
  for (std::size_t i = 0; i < record.set.size(); ++i) {
    if (!keeps(record.set[i])) continue;
    set.push_back(record.set[i]);
    witness_of.push_back(record.witness_of[i]);
  }
  set.shrink_to_fit();
  witness_of.shrink_to_fit();
  record.set = std::move(set);
  record.witness_of = std::move(witness_of);
}

}  // namespace

void drop_known(std::span<const std::uint32_t> own, cell_record& neighbor) {
  keep_if(neighbor, [&, known = own.begin()](std::uint32_t polygon) mutable {
    while (known != own.end() && *known < polygon) ++known;
    return known == own.end() || *known != polygon;
  });
}

void keep_late(cell_record& neighbor) {
  keep_if(neighbor, [late = neighbor.late.begin(), end = neighbor.late.end()](std::uint32_t polygon) mutable {
    while (late != end && *late < polygon) ++late;
    return late != end && *late == polygon;
  });
}

std::uint64_t neighbor_check(const ray_scene& rays, const box& grown, const neighbor_check_settings& how,
                             std::span<const cell_record> neighbors, cell_set& set) {
  constexpr std::size_t stretch = 64;
  const neighbor_witnesses witnesses(neighbors);
  const std::vector<candidate> wanted = candidates_of(neighbors, witnesses, set);
  closest_points closest(witnesses.size());
  const std::vector<glm::vec3> eyes = selection_of(set.eyes());
  constexpr std::size_t wave = 64;  // stretches between two looks at the limit
  std::vector<outcome_of_rays> outcomes((wanted.size() + stretch - 1) / stretch);
  for (std::size_t first = 0; first < outcomes.size() && !(how.limit && how.limit->reached()); first += wave)
    tbb::parallel_for(first, std::min(outcomes.size(), first + wave), [&](std::size_t i) {
      tester one(rays, grown, how, eyes, witnesses, closest, set);
      const std::size_t end = std::min(wanted.size(), (i + 1) * stretch);
      for (std::size_t k = i * stretch; k < end; ++k) one.test(wanted[k], outcomes[i]);
    });
  std::uint64_t spent = 0;
  std::vector<found_polygon> found;
  for (const outcome_of_rays& o : outcomes) {
    spent += o.rays;
    found.insert(found.end(), o.found.begin(), o.found.end());
  }
  // Of several eyes that found a polygon the lowest becomes its witness, so that the choice does not depend on ids.
  std::sort(found.begin(), found.end());
  const finding from_neighbors(set, found_by::adjacent_cell);
  for (const found_polygon& f : found) set.add(f.polygon, f.eye);
  return spent;
}

}  // namespace sightcell::bake
