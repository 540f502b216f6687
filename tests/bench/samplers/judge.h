#pragma once
// How wrong a cell's set is, by the truth of the cell.
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/samplers/interval.h"
#include "bench/samplers/truth.h"

namespace sightcell::bench {

struct judgement {
  std::uint64_t rays = 0;  // of the truth
  double misses = 0.0;     // of them that are wrong: polygons that are not seen, by the share of their kept rays
  double spread = 0.0;  // variance of misses; rays of one place, and shares of few kept rays, make it more than misses
  double color = 0.0;   // sum over wrong rays of the color difference, each 0..1

  double pixel_error() const { return rays > 0 ? misses / static_cast<double>(rays) : 0.0; }
  double color_error() const { return rays > 0 ? color / static_cast<double>(rays) : 0.0; }
  // As many independent misses would make one as sure.
  double misses_effective() const { return spread > 0.0 ? misses * misses / spread : 0.0; }
  interval bounds() const { return error_interval(pixel_error(), misses_effective(), static_cast<double>(rays)); }
};

// Of several cells, each as heavy as the other.
struct pooled_judgement {
  double pixel_error = 0.0, color_error = 0.0, misses_effective = 0.0;
  interval bounds;
};
pooled_judgement pooled(const std::vector<judgement>& cells);

// A kept ray that is wrong, for so many of the truth.
struct wrong_ray {
  truth_place ray;
  std::uint32_t polygon = 0;
  double weight = 0.0;
};

// One thread at a time.
class cell_judge {
 public:
  // The truth must outlive the judge and not be extended meanwhile.
  explicit cell_judge(const cell_truth& truth);

  // set: ascending. A ray is wrong when its front polygon, or one that it passes, is missing in the set, was not seen
  // through a gap (rule 3) and nothing of the set is in the same place (rule 2), as in bound/verification_rays.h. A ray
  // that misses several counts once. Color: what is seen against what is seen of the set alone, unlit; a polygon that
  // hides nothing counts by its alpha.
  judgement judge(const std::vector<std::uint32_t>& set, bool with_color);
  // Kept rays that are wrong, in the order of polygons.
  std::vector<wrong_ray> wrong_rays(const std::vector<std::uint32_t>& set);

 private:
  enum class excuse : std::uint8_t { unknown, gap, none, company };  // company: others are in the same place
  using in_set = std::function<bool(std::uint32_t)>;

  struct verdict {
    const truth_polygon* of;
    std::array<bool, truth_polygon::kept_most> wrong{};
    double share = 0.0;  // of its rays
    // Of the truth's rays, that a kept one stands for.
    double weight(std::uint32_t kept) const;
  };
  std::vector<verdict> verdicts(const in_set& contains);
  bool is_wrong(std::size_t polygon, std::uint32_t kept, const in_set& contains);
  bool missed_before(const truth_place& ray, std::uint32_t polygon, const in_set& contains) const;
  bool really_missing(const truth_place& ray, std::uint32_t polygon, float distance, const in_set& contains) const;
  double color_difference(const truth_place& ray, std::uint32_t polygon, const in_set& contains) const;
  bool occludes(std::uint32_t polygon) const;

  const cell_truth& truth_;
  const ground& ground_;
  std::vector<std::array<excuse, truth_polygon::kept_most>> excuses_;  // of the truth's polygons
  std::map<std::pair<std::size_t, std::uint32_t>, std::vector<std::uint32_t>> company_;
};

// judge() by content: of a set that is known by a key. load_set is asked where nothing is kept.
judgement kept_judgement(const kept_files& kept, const cell_truth& truth, std::optional<cell_judge>& judge,
                         const std::string& set_key, const std::function<std::vector<std::uint32_t>()>& load_set,
                         bool with_color);

}  // namespace sightcell::bench
