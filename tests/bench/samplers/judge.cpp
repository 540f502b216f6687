#include "bench/samplers/judge.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "bench/hemicube/cache.h"
#include "bench/samplers/bytes.h"

namespace sightcell::bench {
namespace {

constexpr int judge_version = 2;  // raised when the same set and truth may be judged otherwise

// Set as a question that is quick to ask.
std::vector<bool> marks_of(const std::vector<std::uint32_t>& set, std::uint32_t polygons) {
  std::vector<bool> marks(polygons);
  for (const std::uint32_t polygon : set) marks[polygon] = true;
  return marks;
}

// A polygon's wrong rays at a place, as far as the sample of its places goes.
struct wrong_place {
  std::uint32_t place;
  double order, reach, rays;  // reach: with order below it, a place of the polygon is in the sample
};

// Of polygons with more places the last one that is kept only says how far the sample reaches.
double reach_of(const truth_polygon& p) {
  return p.places > p.kept() ? p.kept_places[p.kept() - 1].order() : 2.0;
}

// Sum over places and pairs of polygons of the product of how many rays are wrong about each. A place is in the samples
// of both polygons when its order is below both reaches, so each such place stands for as many as that is rare.
double products(std::vector<wrong_place>& wrong) {
  std::stable_sort(wrong.begin(), wrong.end(), [](const auto& a, const auto& b) { return a.place < b.place; });
  double sum = 0.0;
  for (std::size_t first = 0, last; first < wrong.size(); first = last) {
    for (last = first; last < wrong.size() && wrong[last].place == wrong[first].place; ++last) {
      for (std::size_t other = first; other < last; ++other) {
        const double reach = std::min(wrong[other].reach, wrong[last].reach);
        if (wrong[last].order < reach) sum += 2.0 * wrong[other].rays * wrong[last].rays / std::min(1.0, reach);
      }
    }
  }
  return sum;
}

}  // namespace

pooled_judgement pooled(const std::vector<judgement>& cells) {
  pooled_judgement all;
  double variance = 0.0, rays = 0.0;
  const auto count = static_cast<double>(cells.size());
  for (const judgement& one : cells) {
    if (one.rays == 0) continue;
    const auto of_cell = static_cast<double>(one.rays);
    all.pixel_error += one.pixel_error() / count;
    all.color_error += one.color_error() / count;
    variance += one.spread / (of_cell * of_cell * count * count);
    rays += of_cell;
  }
  all.misses_effective = variance > 0.0 ? all.pixel_error * all.pixel_error / variance : 0.0;
  all.bounds = error_interval(all.pixel_error, all.misses_effective, rays);
  return all;
}

cell_judge::cell_judge(const cell_truth& truth)
    : truth_(truth), ground_(truth.on()), excuses_(truth.polygons().size()) {}

bool cell_judge::occludes(std::uint32_t polygon) const {
  const scene::polygon_kind kind = ground_.geometry.kinds[polygon];
  return !kind.non_occluder && kind.alpha != scene::alpha_mode::blend;
}

bool cell_judge::is_wrong(std::size_t polygon, std::uint32_t kept, const in_set& contains) {
  const truth_place& ray = truth_.polygons()[polygon].kept_places[kept];
  excuse& known = excuses_[polygon][kept];
  if (known == excuse::unknown) {
    if (ground_.rays.through_gap(ray.eye, ray.direction, ray.distance, ground_.rules.smallest_gap)) {
      known = excuse::gap;
    } else {
      std::vector<std::uint32_t> together;
      ground_.rays.coincident(ray.eye, ray.direction, ray.distance, together);
      known = together.size() > 1 ? excuse::company : excuse::none;
      if (together.size() > 1) company_[{polygon, kept}] = std::move(together);
    }
  }
  if (known == excuse::gap) return false;
  if (known == excuse::none) return true;
  const auto& together = company_.at({polygon, kept});
  return std::none_of(together.begin(), together.end(), contains);
}

bool cell_judge::really_missing(const truth_place& ray, std::uint32_t polygon, float distance,
                                const in_set& contains) const {
  if (contains(polygon) || ground_.rays.through_gap(ray.eye, ray.direction, distance, ground_.rules.smallest_gap))
    return false;
  std::vector<std::uint32_t> together;
  ground_.rays.coincident(ray.eye, ray.direction, distance, together);
  return std::none_of(together.begin(), together.end(), contains);
}

// A ray that is wrong about its front, or about a polygon with a lower number that it passes, is counted there.
bool cell_judge::missed_before(const truth_place& ray, std::uint32_t polygon, const in_set& contains) const {
  bake::sight seen;
  ground_.rays.trace(ray.eye, ray.direction, seen);
  if (seen.front != bake::no_polygon && really_missing(ray, seen.front, seen.distance, contains)) return true;
  for (const bake::passed_polygon& p : seen.before) {
    if (p.polygon >= polygon) break;
    if (really_missing(ray, p.polygon, p.distance, contains)) return true;
  }
  return false;
}

std::vector<cell_judge::verdict> cell_judge::verdicts(const in_set& contains) {
  std::vector<verdict> found;
  for (std::size_t i = 0; i < truth_.polygons().size(); ++i) {
    const truth_polygon& p = truth_.polygons()[i];
    if (contains(p.polygon)) continue;
    verdict one{&p};
    double wrong = 0.0, all = 0.0;
    for (std::uint32_t k = 0; k < p.kept(); ++k) {
      const truth_place& ray = p.kept_places[k];
      one.wrong[k] = is_wrong(i, k, contains) && (occludes(p.polygon) || !missed_before(ray, p.polygon, contains));
      wrong += one.wrong[k] ? ray.rays : 0;
      all += ray.rays;
    }
    one.share = wrong / all;
    if (one.share > 0.0) found.push_back(one);
  }
  return found;
}

double cell_judge::color_difference(const truth_place& ray, std::uint32_t polygon, const in_set& contains) const {
  const std::uint32_t shown = ground_.rays.front_of_set(ray.eye, ray.direction, contains);
  const glm::u8vec3 right = ground_.colors.color_of(polygon, ray.eye, ray.direction);
  const glm::u8vec3 wrong =
      shown == bake::no_polygon ? bake::surface_colors::sky() : ground_.colors.color_of(shown, ray.eye, ray.direction);
  double alpha = 1.0;
  if (!occludes(polygon)) {
    const std::uint32_t material = ground_.s.draws[scene::draw_of(ground_.s, polygon)].material;
    if (material < ground_.s.materials.size() && ground_.s.materials[material].alpha == scene::alpha_mode::blend)
      alpha = static_cast<double>(ground_.s.materials[material].base_color.a);
  }
  return alpha * bake::mean_color_difference({&right, 1}, {&wrong, 1});
}

judgement cell_judge::judge(const std::vector<std::uint32_t>& set, bool with_color) {
  const std::vector<bool> marks = marks_of(set, ground_.polygons());
  const in_set contains = [&](std::uint32_t polygon) { return marks[polygon]; };
  judgement result{.rays = truth_.rays()};
  std::vector<wrong_place> wrong;
  for (const verdict& v : verdicts(contains)) {
    const double rays = v.of->rays, kept = v.of->kept();
    result.misses += rays * v.share;
    result.spread += static_cast<double>(v.of->squares) * v.share;
    if (v.share < 1.0)  // as if the next four places could be others
      result.spread += rays * rays * v.share * (1.0 - v.share) / (kept - 1.0) * (1.0 - kept / v.of->places);
    for (std::uint32_t k = 0; k < v.of->kept(); ++k) {
      if (!v.wrong[k]) continue;
      const truth_place& ray = v.of->kept_places[k];
      wrong.push_back({ray.number, ray.order(), reach_of(*v.of), static_cast<double>(ray.rays)});
      if (with_color) result.color += v.weight(k) * color_difference(ray, v.of->polygon, contains);
    }
  }
  result.spread += products(wrong);
  return result;
}

double cell_judge::verdict::weight(std::uint32_t kept) const {
  double all = 0.0;
  for (std::uint32_t k = 0; k < of->kept(); ++k) all += of->kept_places[k].rays;
  return static_cast<double>(of->rays) * of->kept_places[kept].rays / all;
}

std::vector<wrong_ray> cell_judge::wrong_rays(const std::vector<std::uint32_t>& set) {
  const std::vector<bool> marks = marks_of(set, ground_.polygons());
  std::vector<wrong_ray> wrong;
  for (const verdict& v : verdicts([&](std::uint32_t polygon) { return marks[polygon]; }))
    for (std::uint32_t k = 0; k < v.of->kept(); ++k)
      if (v.wrong[k]) wrong.push_back({v.of->kept_places[k], v.of->polygon, v.weight(k)});
  return wrong;
}

judgement kept_judgement(const kept_files& kept, const cell_truth& truth, std::optional<cell_judge>& judge,
                         const std::string& set_key, const std::function<std::vector<std::uint32_t>()>& load_set,
                         bool with_color) {
  const std::string key = hash_of_text("judgement " + std::to_string(judge_version) + (with_color ? " color " : " ") +
                                       set_key + " " + truth.key() + " " + std::to_string(truth.rays()));
  if (const auto bytes = kept.read(key, "judgement")) {
    byte_reader in(*bytes);
    const auto found = in.get<judgement>();
    if (in.ended()) return found;
  }
  if (!judge) judge.emplace(truth);
  const judgement found = judge->judge(load_set(), with_color);
  byte_writer out;
  out.put(found);
  kept.write(key, "judgement", out.bytes());
  return found;
}

}  // namespace sightcell::bench
