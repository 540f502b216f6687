#include "bench/samplers/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <iostream>
#include <map>
#include <optional>

#include "bench/hemicube/cache.h"
#include "bench/samplers/commands.h"
#include "bench/samplers/judge.h"
#include "bench/samplers/sampling.h"
#include "sightcell/picture/gl_context.h"

namespace sightcell::bench {
namespace {

constexpr std::uint32_t width = 960, height = 640;
constexpr float field_of_view = 1.0f;  // of a picture's height, radians
constexpr std::size_t places_tried = 32;
constexpr std::size_t rays_of_try = 8192;
constexpr std::uint32_t grown_by = 2;
constexpr auto view_purpose = static_cast<bake::purpose>(0x76696577u);  // of no sampler

// Directions in which the set misses something, of so many tried.
std::vector<glm::vec3> missed_from(const ground& g, const glm::vec3& eye, std::size_t number,
                                   const std::vector<bool>& has) {
  bake::random_stream random(1, number, view_purpose);
  std::vector<glm::vec3> missed;
  std::vector<std::uint32_t> together;
  bake::sight seen;
  for (std::size_t i = 0; i < rays_of_try; ++i) {
    const glm::vec3 direction = random.on_sphere();
    g.rays.trace(eye, direction, seen);
    if (seen.front == bake::no_polygon || has[seen.front]) continue;
    if (g.rays.through_gap(eye, direction, seen.distance, g.rules.smallest_gap)) continue;
    g.rays.coincident(eye, direction, seen.distance, together);
    if (std::none_of(together.begin(), together.end(), [&](std::uint32_t id) { return has[id]; }))
      missed.push_back(direction);
  }
  return missed;
}

// The one of them around which a picture has most of the others.
glm::vec3 toward_most(const std::vector<glm::vec3>& directions) {
  glm::vec3 best = directions.front();
  std::ptrdiff_t most = 0;
  const std::size_t step = std::max<std::size_t>(1, directions.size() / 200);
  for (std::size_t i = 0; i < directions.size(); i += step) {
    const auto count = std::count_if(directions.begin(), directions.end(),
                                     [&](const glm::vec3& d) { return glm::dot(d, directions[i]) > 0.88f; });
    if (count <= most) continue;
    most = count;
    best = directions[i];
  }
  return best;
}

glm::vec3 up_for(const glm::vec3& forward) {
  return std::abs(forward.y) < 0.99f ? glm::vec3{0, 1, 0} : glm::vec3{0, 0, -1};
}

// Above and beside the cell, so far away that three quarters of what the first set has are in view.
picture::camera outside_of(const ground& g, std::size_t cell, const std::vector<std::uint32_t>& set) {
  const glm::vec3 middle = 0.5f * (g.cells[cell].min + g.cells[cell].max);
  std::vector<float> distances{1.0f};
  for (const std::uint32_t id : set)
    distances.push_back(glm::distance(g.geometry.positions[g.geometry.indices[3 * std::size_t{id}]], middle));
  const auto far = distances.begin() + static_cast<std::ptrdiff_t>(3 * distances.size() / 4);
  std::nth_element(distances.begin(), far, distances.end());
  const glm::vec3 beside = glm::normalize(glm::vec3{0.55f, 0.75f, 0.65f});
  return {middle + beside * (2.5f * *far), -beside, {0, 1, 0}, field_of_view};
}

struct job_set {
  const job* of;
  std::vector<std::uint32_t> set;
};

class gallery {
 public:
  gallery(const ground& g, std::size_t cell, const std::filesystem::path& folder)
      : ground_(g), cell_(cell), folder_(folder) {
    std::filesystem::create_directories(folder);
  }

  json inside(const worst_view& view, const std::vector<job_set>& sets) {
    const picture::camera from{view.eye, view.forward, up_for(view.forward), field_of_view};
    picture::renderer renderer(context_, ground_.s, ground_.geometry);
    const picture::image_rgba whole = renderer.draw(from, width, height);
    save("inside", whole);
    json jobs = json::array();
    for (std::size_t i = 0; i < sets.size(); ++i) {
      const picture::image_rgba shown = renderer.draw(from, width, height, sets[i].set);
      const picture::difference found = picture::compare(whole, shown);
      const std::string stem = fmt::format("inside-{}", i + 1);
      save(stem, shown);
      save(stem + "-red", found.marked);
      save(stem + "-red-grown", grow_red(found.marked, grown_by));
      jobs.push_back({{"label", sets[i].of->label},
                      {"set", sets[i].set.size()},
                      {"polygons_drawn", renderer.polygons_of_last_draw()},
                      {"differing_pixels", found.differing_pixels},
                      {"color_error", found.color_error},
                      {"picture", stem + ".png"},
                      {"red", stem + "-red.png"},
                      {"red_grown", stem + "-red-grown.png"},
                      {"outside", fmt::format("outside-{}.png", i + 1)}});
    }
    return jobs;
  }

  // Seen from there, much of a set shows its back.
  void outside(const std::vector<job_set>& sets) {
    scene::world_geometry both_sides = ground_.geometry;
    for (scene::polygon_kind& kind : both_sides.kinds) kind.double_sided = true;
    picture::renderer renderer(context_, ground_.s, both_sides);
    const picture::camera from = outside_of(ground_, cell_, sets.front().set);
    save("outside", renderer.draw(from, width, height));
    for (std::size_t i = 0; i < sets.size(); ++i)
      save(fmt::format("outside-{}", i + 1), renderer.draw(from, width, height, sets[i].set));
  }

 private:
  void save(const std::string& stem, const picture::image_rgba& image) const {
    picture::write_png(folder_ / (stem + ".png"), image);
  }

  const ground& ground_;
  const std::size_t cell_;
  const std::filesystem::path folder_;
  const picture::gl_context context_;
};

}  // namespace

worst_view find_worst_view(const cell_truth& truth, const std::vector<std::uint32_t>& set) {
  const ground& g = truth.on();
  worst_view worst;
  if (!truth.polygons().empty()) {
    const truth_place& any = truth.polygons().front().kept_places.front();
    worst.eye = any.eye, worst.forward = any.direction;
  }
  std::map<std::uint32_t, std::pair<double, glm::vec3>> places;  // how much each is known to miss, and where it is
  for (const wrong_ray& wrong : cell_judge(truth).wrong_rays(set)) {
    auto& [weight, eye] = places[wrong.ray.number];
    weight += wrong.weight;
    eye = wrong.ray.eye;
  }
  std::vector<std::pair<double, std::uint32_t>> order;
  for (const auto& [place, known] : places) order.push_back({-known.first, place});
  std::sort(order.begin(), order.end());
  order.resize(std::min(order.size(), places_tried));

  std::vector<bool> has(g.polygons());
  for (const std::uint32_t id : set) has[id] = true;
  for (const auto& [weight, place] : order) {
    const glm::vec3 eye = places.at(place).second;
    const auto missed = missed_from(g, eye, place, has);
    const double share = static_cast<double>(missed.size()) / rays_of_try;
    if (share > worst.missed_share) worst = {eye, toward_most(missed), share};
  }
  // So few that none of the rays was one: what truth knows stands.
  if (worst.missed_share == 0.0 && !order.empty()) {
    for (const wrong_ray& wrong : cell_judge(truth).wrong_rays(set))
      if (wrong.ray.number == order.front().second) worst = {wrong.ray.eye, wrong.ray.direction, 0.0};
  }
  return worst;
}

picture::image_rgba grow_red(const picture::image_rgba& marked, std::uint32_t by) {
  picture::image_rgba grown = marked;
  const auto reach = static_cast<std::int64_t>(by), wide = static_cast<std::int64_t>(marked.width),
             high = static_cast<std::int64_t>(marked.height);
  const auto at = [&](std::int64_t x, std::int64_t y) { return 4 * static_cast<std::size_t>(y * wide + x); };
  for (std::int64_t y = 0; y < high; ++y) {
    for (std::int64_t x = 0; x < wide; ++x) {
      const std::uint8_t* pixel = &marked.pixels[at(x, y)];
      if (pixel[0] != 255 || pixel[1] != 0) continue;  // grays are darker
      for (std::int64_t v = std::max<std::int64_t>(0, y - reach); v <= std::min(high - 1, y + reach); ++v)
        for (std::int64_t u = std::max<std::int64_t>(0, x - reach); u <= std::min(wide - 1, x + reach); ++u)
          std::copy_n(pixel, 4, &grown.pixels[at(u, v)]);
    }
  }
  return grown;
}

void run_pictures(const bench_options& how) {
  const job_list list = read_jobs(how.jobs);
  const auto g = load_ground(how.scene, how.cells, how.cell_limit, list.jobs.front().rules(), how.scene_hash);
  const std::size_t cell = g->cell_named(how.cell);
  const kept_files kept(how.cache);
  sampling_bench bench(*g, kept, how.threads);
  std::vector<job_set> sets;
  for (const job& one : list.jobs) sets.push_back({&one, bench.set_of(bench.run_cell(one, cell))});
  cell_truth truth(*g, cell);
  truth.load(kept);
  if (truth.rays() < list.truth.first_rays) {
    truth.extend(list.truth.first_rays);
    truth.save(kept);
  }
  const worst_view view = find_worst_view(truth, sets.front().set);
  gallery pictures(*g, cell, how.out);
  json jobs = pictures.inside(view, sets);
  pictures.outside(sets);
  const json told{{"scene", g->s.name},
                  {"hash", g->hash},
                  {"cell", how.cell},
                  {"polygons", g->polygons()},
                  {"eye", {view.eye.x, view.eye.y, view.eye.z}},
                  {"forward", {view.forward.x, view.forward.y, view.forward.z}},
                  {"missed_share", view.missed_share},
                  {"pixels", width * height},
                  {"picture", "inside.png"},
                  {"outside", "outside.png"},
                  {"jobs", std::move(jobs)}};
  write_json(how.out / "pictures.json", told);
  std::cout << told.dump(1) << '\n';
}

}  // namespace sightcell::bench
