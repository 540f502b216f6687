#include "bench/samplers/truth.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "bench/hemicube/cache.h"
#include "bench/samplers/bytes.h"
#include "sightcell/base/process_time.h"
#include "trace/viewpoints.h"

namespace sightcell::bench {
namespace {

constexpr int truth_version = 3;  // raised when the same cell may give other numbers
constexpr std::uint64_t truth_seed = 0x7472757468u;
constexpr auto truth_purpose = static_cast<bake::purpose>(truth_seed);  // beyond those of a bake

constexpr std::size_t places_of_chunk = 64;
constexpr std::uint64_t chunk_rays = places_of_chunk * rays_of_place;
constexpr std::uint64_t tries_of_place = 256;  // then a chunk has fewer
constexpr std::uint64_t chunks_at_once = 256;

struct seen_from_place {
  std::uint32_t polygon;
  truth_place where;
};

struct chunk_result {
  std::vector<seen_from_place> seen;
  std::uint64_t places = 0, tries = 0;
};

// What the rays of one place saw is put together: from is where it begins in seen.
void join_place(std::vector<seen_from_place>& seen, std::size_t from) {
  const auto first = seen.begin() + static_cast<std::ptrdiff_t>(from);
  std::stable_sort(first, seen.end(), [](const auto& a, const auto& b) { return a.polygon < b.polygon; });
  auto last = first;
  for (auto one = first; one != seen.end(); ++one) {
    if (one == first) continue;
    if (one->polygon == last->polygon)
      ++last->where.rays;
    else
      *++last = *one;
  }
  if (first != seen.end()) seen.erase(last + 1, seen.end());
}

chunk_result cast_chunk(const ground& g, std::size_t cell, std::uint64_t chunk) {
  chunk_result result;
  bake::random_stream random(truth_seed, g.cells[cell].place, truth_purpose, 0, chunk);
  const auto eyes = bake::draw_viewpoints(g.rays, g.grown(cell), g.rules.player_radius, places_of_chunk,
                                          places_of_chunk * tries_of_place, random, result.tries);
  result.places = eyes.size();
  bake::sight seen;
  auto number = static_cast<std::uint32_t>(chunk * places_of_chunk);
  for (const glm::vec3& eye : eyes) {
    const std::size_t from = result.seen.size();
    for (std::uint32_t i = 0; i < rays_of_place; ++i) {
      const glm::vec3 direction = random.on_sphere();
      g.rays.trace(eye, direction, seen);
      if (seen.front != bake::no_polygon)
        result.seen.push_back({seen.front, {eye, direction, seen.distance, number, 1}});
      for (const bake::passed_polygon& p : seen.before)
        result.seen.push_back({p.polygon, {eye, direction, p.distance, number, 1}});
    }
    join_place(result.seen, from);
    ++number;
  }
  return result;
}

void note(truth_polygon& in, const truth_place& where) {
  const std::uint32_t kept = in.kept();
  in.rays += where.rays;
  in.squares += std::uint64_t{where.rays} * where.rays;
  ++in.places;
  if (kept < truth_polygon::kept_most) {
    in.kept_places[kept] = where;
    return;
  }
  const auto last = std::max_element(in.kept_places.begin(), in.kept_places.end(),
                                     [](const auto& a, const auto& b) { return a.order() < b.order(); });
  if (where.order() < last->order()) *last = where;
}

}  // namespace

void cell_truth::extend(std::uint64_t rays) {
  const std::uint64_t wanted = (rays + chunk_rays - 1) / chunk_rays;
  if (wanted <= chunks_) return;
  const double began = bake::process_cpu_seconds();
  std::vector<std::uint32_t> index(ground_->polygons(), scene::no_index);  // into polygons_
  for (std::uint32_t i = 0; i < polygons_.size(); ++i) index[polygons_[i].polygon] = i;
  std::vector<chunk_result> results;
  while (chunks_ < wanted) {
    results.assign(std::min(chunks_at_once, wanted - chunks_), {});
    tbb::parallel_for(std::size_t{0}, results.size(),
                      [&](std::size_t i) { results[i] = cast_chunk(*ground_, cell_, chunks_ + i); });
    for (const chunk_result& one : results) {
      for (const seen_from_place& seen : one.seen) {
        std::uint32_t& at = index[seen.polygon];
        if (at == scene::no_index) {
          at = static_cast<std::uint32_t>(polygons_.size());
          polygons_.push_back({.polygon = seen.polygon});
        }
        note(polygons_[at], seen.where);
      }
      places_ += one.places;
      rays_ += one.places * rays_of_place;
      tries_ += one.tries;
    }
    chunks_ += results.size();
  }
  std::sort(polygons_.begin(), polygons_.end(), [](const auto& a, const auto& b) { return a.polygon < b.polygon; });
  for (truth_polygon& p : polygons_)
    std::sort(p.kept_places.begin(), p.kept_places.begin() + p.kept(),
              [](const auto& a, const auto& b) { return a.order() < b.order(); });
  cpu_seconds_ += bake::process_cpu_seconds() - began;
}

std::string cell_truth::key() const {
  return hash_of_text("truth " + std::to_string(truth_version) + " " + ground_->text_of(cell_));
}

bool cell_truth::load(const kept_files& kept) {
  const auto bytes = kept.read(key(), "truth");
  if (!bytes) return false;
  byte_reader in(*bytes);
  cell_truth found(*ground_, cell_);
  found.chunks_ = in.get<std::uint64_t>();
  found.rays_ = in.get<std::uint64_t>();
  found.places_ = in.get<std::uint64_t>();
  found.tries_ = in.get<std::uint64_t>();
  found.cpu_seconds_ = in.get<double>();
  for (auto left = in.get<std::uint64_t>(); left > 0 && !in.failed(); --left) {
    truth_polygon p{.polygon = in.get<std::uint32_t>(), .rays = in.get<std::uint32_t>()};
    p.places = in.get<std::uint32_t>();
    p.squares = in.get<std::uint64_t>();
    for (std::uint32_t i = 0; i < p.kept(); ++i) p.kept_places[i] = in.get<truth_place>();
    found.polygons_.push_back(p);
  }
  if (!in.ended() || (!found.polygons_.empty() && found.polygons_.back().polygon >= ground_->polygons())) return false;
  *this = std::move(found);
  return true;
}

void cell_truth::save(const kept_files& kept) const {
  byte_writer out;
  out.put(chunks_);
  out.put(rays_);
  out.put(places_);
  out.put(tries_);
  out.put(cpu_seconds_);
  out.put(std::uint64_t{polygons_.size()});
  for (const truth_polygon& p : polygons_) {
    out.put(p.polygon);
    out.put(p.rays);
    out.put(p.places);
    out.put(p.squares);
    for (std::uint32_t i = 0; i < p.kept(); ++i) out.put(p.kept_places[i]);
  }
  kept.write(key(), "truth", out.bytes());
}

}  // namespace sightcell::bench
