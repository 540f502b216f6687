#include "casters/shadow_batch.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <iterator>
#include <numeric>
#include <span>
#include <utility>

#include "bound/bound_rays.h"
#include "bound/valid_count.h"
#include "trace/direction_code.h"
#include "trace/triangle_math.h"
#include "trace/viewpoints.h"

namespace sightcell::bake {
namespace {

// Small enough that the parts of a batch keep all threads busy, and large enough for packets of similar rays.
constexpr std::uint64_t rays_of_part = 16384;
constexpr std::uint64_t fewest_tests_of_batch = 256, rays_per_tested_eye = 256;
constexpr std::uint64_t most_tests_per_valid_eye = 256;

// A shadow map cannot tell a caster from a receiver that is nearer than this.
constexpr float least_bias = 2e-3f;  // meters

struct sun_line {
  sight_line line;
  glm::vec3 to_light{0.0f};
};

// Writes the numbers of the codes to `order`, ascending by the upper 22 bits of the codes; a radix sort.
void sort_by_code(std::span<const std::uint32_t> codes, std::vector<std::uint32_t>& order) {
  constexpr std::uint32_t digit_bits = 11, digits = 1u << digit_bits;
  thread_local std::vector<std::uint32_t> by_low;
  by_low.resize(codes.size());
  order.resize(codes.size());
  std::array<std::uint32_t, digits> low{}, high{};  // how many codes have a digit, then where the next one goes
  for (const std::uint32_t code : codes)
    ++low[code >> (32 - 2 * digit_bits) & (digits - 1)], ++high[code >> (32 - digit_bits)];
  std::exclusive_scan(low.begin(), low.end(), low.begin(), 0u);
  std::exclusive_scan(high.begin(), high.end(), high.begin(), 0u);
  for (std::uint32_t i = 0; i < codes.size(); ++i) by_low[low[codes[i] >> (32 - 2 * digit_bits) & (digits - 1)]++] = i;
  for (const std::uint32_t i : by_low) order[high[codes[i] >> (32 - digit_bits)]++] = i;
}

// Sorted so that lines with similar directions share packets.
void sort_for_packets(std::vector<sun_line>& lines, const box& around) {
  thread_local std::vector<std::uint32_t> codes, order;
  thread_local std::vector<sun_line> unsorted;
  codes.clear();
  for (const sun_line& one : lines)
    codes.push_back(direction_code(one.line.direction) << 17 |
                    place_code(one.line.eye, around.min, around.max - around.min) << 2);
  sort_by_code(codes, order);
  unsorted.assign(lines.begin(), lines.end());
  for (std::size_t i = 0; i < order.size(); ++i) lines[i] = unsorted[order[i]];
}

// Returns the lower 16 bits with a zero bit above each.
std::uint32_t spread_bits(std::uint32_t x) {
  x = (x | x << 8) & 0x00FF00FFu;
  x = (x | x << 4) & 0x0F0F0F0Fu;
  x = (x | x << 2) & 0x33333333u;
  return (x | x << 1) & 0x55555555u;
}

// Writes the numbers of the lines to `order`, so that lines that are near each other across the light share packets.
void sort_across_light(std::span<const shadow_line> lines, std::vector<std::uint32_t>& order) {
  thread_local std::vector<std::uint32_t> codes;
  thread_local std::vector<glm::vec2> places;
  codes.clear(), places.clear(), order.clear();
  if (lines.empty()) return;
  const glm::vec3 light = lines.front().to_light;
  const glm::vec3 up = std::abs(light.y) < 0.99f ? glm::vec3{0.0f, 1.0f, 0.0f} : glm::vec3{1.0f, 0.0f, 0.0f};
  const glm::vec3 across = glm::normalize(glm::cross(light, up)), along = glm::cross(light, across);
  for (const shadow_line& line : lines) places.emplace_back(glm::dot(line.point, across), glm::dot(line.point, along));
  glm::vec2 min = places[0], max = places[0];
  for (const glm::vec2& place : places) min = glm::min(min, place), max = glm::max(max, place);
  const glm::vec2 scale = 65535.0f / glm::max(max - min, glm::vec2{1e-6f});
  for (const glm::vec2& place : places) {
    const glm::vec2 at = glm::min((place - min) * scale, glm::vec2{65535.0f});
    codes.push_back(spread_bits(static_cast<std::uint32_t>(at.x)) | spread_bits(static_cast<std::uint32_t>(at.y)) << 1);
  }
  sort_by_code(codes, order);
}

// Calls visit with each polygon that counts and is shown by a line, and its distance; see lacks_shadow().
template <typename visitor>
void for_each_receiver(const ray_scene& rays, const sight_line& line, const sight& seen, const glm::vec3& to_light,
                       const caster_sets& sets, const visitor& visit) {
  const auto test = [&](std::uint32_t polygon, float distance) {
    if (sets.camera(polygon) && faces_light(rays.geometry(), polygon, line.direction, to_light))
      visit(polygon, distance);
  };
  if (seen.front != no_polygon) test(seen.front, seen.distance);
  for (const passed_polygon& p : seen.before) test(p.polygon, p.distance);
}

// The lines of a part that are misses, but for the validity of their viewpoints.
struct suspect_lines {
  std::vector<std::size_t> lines;     // ascending
  std::vector<std::size_t> ends;      // in `missed`, of each of these
  std::vector<missed_shadow> missed;  // of one after the other
};

// Storage of trace_shadows(), kept between parts.
struct shadow_buffers {
  std::vector<sight_line> lines;
  std::vector<sight> seen;                // of each line
  std::vector<shadow_line> rays, sorted;  // toward the light
  std::vector<std::uint32_t> owners;      // the line of each shadow ray
  std::vector<std::uint32_t> order;       // the shadow ray of each sorted one
  std::vector<std::uint8_t> suspect;      // of each sorted shadow ray
  std::vector<std::uint8_t> suspect_line;
};

// Traces the lines, which it sorts, and the shadow rays of what they show.
suspect_lines trace_shadows(const ray_scene& rays, std::vector<sun_line>& lines, const box& around,
                            const caster_sets& sets) {
  thread_local shadow_buffers b;
  sort_for_packets(lines, around);
  b.lines.clear(), b.rays.clear(), b.owners.clear(), b.sorted.clear();
  for (const sun_line& one : lines) b.lines.push_back(one.line);
  b.seen.resize(lines.size());
  rays.trace(b.lines, b.seen);
  for (std::uint32_t i = 0; i < lines.size(); ++i)
    for_each_receiver(rays, b.lines[i], b.seen[i], lines[i].to_light, sets, [&](std::uint32_t polygon, float distance) {
      const glm::vec3 point = b.lines[i].eye + b.lines[i].direction * distance;
      b.rays.push_back(shadow_line_of(point, distance, lines[i].to_light, polygon));
      b.owners.push_back(i);
    });
  sort_across_light(b.rays, b.order);
  for (const std::uint32_t one : b.order) b.sorted.push_back(b.rays[one]);
  b.suspect.resize(b.sorted.size());
  find_suspects(rays, b.sorted, sets.drawn, b.suspect);
  b.suspect_line.assign(lines.size(), 0);
  for (std::size_t i = 0; i < b.order.size(); ++i)
    if (b.suspect[i]) b.suspect_line[b.owners[b.order[i]]] = 1;
  suspect_lines found;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!b.suspect_line[i]) continue;
    if (!lacks_shadow(rays, b.lines[i], b.seen[i], lines[i].to_light, sets, found.missed)) continue;
    found.lines.push_back(i);
    found.ends.push_back(found.missed.size());
  }
  return found;
}

}  // namespace

struct shadow_batch::part {
  std::uint64_t cast = 0, tested = 0, valid = 0, misses = 0, viewpoints_tested = 0;
  std::vector<missed_shadow> missed;
};

shadow_line shadow_line_of(const glm::vec3& point, float distance, const glm::vec3& to_light, std::uint32_t receiver) {
  return {point, to_light, std::max(least_bias, 2.0f * coincidence_reach(distance)), receiver};
}

bool faces_light(const scene::world_geometry& geometry, std::uint32_t polygon, const glm::vec3& seen_along,
                 const glm::vec3& to_light) {
  const triangle t = corners_of(geometry, polygon);
  const glm::vec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const float toward_light = glm::dot(normal, to_light);
  return glm::dot(normal, seen_along) < 0.0f ? toward_light > 0.0f : toward_light < 0.0f;
}

bool lacks_shadow(const ray_scene& rays, const sight_line& line, const sight& seen, const glm::vec3& to_light,
                  const caster_sets& sets, std::vector<missed_shadow>& missed) {
  thread_local lacking_casters lacking;
  bool any = false;
  for_each_receiver(rays, line, seen, to_light, sets, [&](std::uint32_t polygon, float distance) {
    const glm::vec3 point = line.eye + line.direction * distance;
    if (!find_lacking(rays, shadow_line_of(point, distance, to_light, polygon), sets.drawn, lacking)) return;
    missed.push_back({line.eye, point, to_light, polygon, lacking});
    any = true;
  });
  return any;
}

shadow_batch::part shadow_batch::cast_part(std::uint64_t count, std::uint64_t tests, random_stream random) const {
  part result;
  std::vector<sun_line> lines(count);
  for (sun_line& one : lines) {
    one.line.eye = where_.draw(random);
    one.line.direction = random.on_sphere();
    one.to_light = sun_.draw(random);
  }
  // The first ones are tested, before the lines are sorted by what decides a miss.
  std::vector<glm::vec3> eyes;
  for (std::size_t i = 0; i < std::min<std::size_t>(tests, lines.size()); ++i) eyes.push_back(lines[i].line.eye);
  const std::size_t tested = eyes.size();
  suspect_lines found = trace_shadows(rays_, lines, where_.whole(), sets_);
  for (const std::size_t line : found.lines) eyes.push_back(lines[line].line.eye);
  std::vector<std::uint8_t> valid(eyes.size());
  rays_.find_valid(eyes, player_radius_, valid);
  result.cast = count;
  result.tested = tested;
  result.viewpoints_tested = eyes.size();
  result.valid = static_cast<std::uint64_t>(
      std::count(valid.begin(), valid.begin() + static_cast<std::ptrdiff_t>(tested), std::uint8_t{1}));
  for (std::size_t k = 0, from = 0; k < found.ends.size(); from = found.ends[k++]) {
    if (!valid[tested + k]) continue;  // an invalid viewpoint is no trial
    ++result.misses;
    std::move(found.missed.begin() + static_cast<std::ptrdiff_t>(from),
              found.missed.begin() + static_cast<std::ptrdiff_t>(found.ends[k]), std::back_inserter(result.missed));
  }
  return result;
}

shadow_batch::part shadow_batch::cast_part_from(std::span<const glm::vec3> eyes, std::uint64_t count,
                                                random_stream random) const {
  part result;
  std::vector<sun_line> lines(count);
  for (sun_line& one : lines) {
    one.line.eye = eyes[random.bits() % eyes.size()];
    one.line.direction = random.on_sphere();
    one.to_light = sun_.draw(random);
  }
  suspect_lines found = trace_shadows(rays_, lines, where_.whole(), sets_);
  result.cast = count;
  result.misses = found.lines.size();
  result.missed = std::move(found.missed);
  return result;
}

// For regions with hardly any valid viewpoint: every viewpoint is tested, so every ray is a trial.
shadow_batch::part shadow_batch::cast_tested_part(std::uint64_t count, random_stream random) const {
  part result;
  const auto eyes = draw_viewpoints(rays_, where_, player_radius_, count, count * most_tests_per_valid_eye, random,
                                    result.viewpoints_tested);
  sight seen;
  for (const glm::vec3& eye : eyes) {
    const sight_line line{eye, random.on_sphere()};
    const glm::vec3 to_light = sun_.draw(random);
    rays_.trace(line.eye, line.direction, seen);
    if (lacks_shadow(rays_, line, seen, to_light, sets_, result.missed)) ++result.misses;
  }
  result.cast = result.tested = result.valid = eyes.size();
  return result;
}

void shadow_batch::cast(std::uint64_t trials) {
  const bool all_tested = valid_share_ < fewest_valid;
  const auto count =
      static_cast<std::uint64_t>(std::ceil(static_cast<double>(trials) / (all_tested ? 1.0 : valid_share_)));
  const std::uint64_t parts = std::max<std::uint64_t>((count + rays_of_part - 1) / rays_of_part, 1);
  const std::uint64_t tests = std::max(fewest_tests_of_batch, count / rays_per_tested_eye);
  const std::uint64_t tests_of_part = (tests + parts - 1) / parts;
  cast_parts(count, [&](std::uint64_t size, random_stream random) {
    return all_tested ? cast_tested_part(size, random) : cast_part(size, tests_of_part, random);
  });
}

void shadow_batch::cast_from(std::span<const glm::vec3> eyes, std::uint64_t count) {
  cast_parts(count, [&](std::uint64_t size, random_stream random) { return cast_part_from(eyes, size, random); });
}

void shadow_batch::cast_parts(std::uint64_t count,
                              const std::function<part(std::uint64_t size, random_stream random)>& cast_one) {
  std::vector<part> parts((count + rays_of_part - 1) / rays_of_part);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t i) {
    parts[i] = cast_one(std::min(rays_of_part, count - i * rays_of_part),
                        random_stream(source_.seed, source_.place, source_.use, source_.round, parts_ + i));
  });
  parts_ += parts.size();
  for (part& one : parts) {
    cast_ += one.cast, tested_ += one.tested, valid_ += one.valid;
    misses_ += one.misses, viewpoints_tested_ += one.viewpoints_tested;
    std::move(one.missed.begin(), one.missed.end(), std::back_inserter(missed_));
  }
}

// Every miss is a trial, too.
std::uint64_t shadow_batch::trials(double risk) const {
  return std::max(valid_at_least(cast_, tested_, valid_, risk), misses_);
}

}  // namespace sightcell::bake
