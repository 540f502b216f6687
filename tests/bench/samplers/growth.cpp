#include "bench/samplers/growth.h"

#include <fmt/format.h>

#include <array>

#include "bench/hemicube/cache.h"
#include "bench/samplers/commands.h"
#include "hemicube/choice/choose_source.h"
#include "sampler/cell_sampler.h"
#include "trace/viewpoints.h"

namespace sightcell::bench {
namespace {

constexpr std::array face_names{"-x", "+x", "-y", "+y", "-z", "+z"};  // as faces_of has them
constexpr std::size_t facing_down = 2;

// A source that looks from one face alone, so often, and counts what it has seen; from elsewhere it sees nothing.
class one_face_source final : public bake::hemicube_source {
 public:
  one_face_source(bake::hemicube_source& behind, const bake::boundary_face& face, std::size_t polygons,
                  std::size_t most)
      : behind_(behind), face_(face), seen_(polygons), most_(most) {}

  using hemicube_source::render;
  void render(std::span<const bake::pose> poses, std::span<bake::hemicube_view> views) override {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      views[i].seen.clear();
      views[i].importance.fill(0.0);
      // Jittered hemicubes are turned by less than a pixel.
      if (glm::dot(poses[i].forward, face_.outward) < 0.9f || sizes_.size() == most_) continue;
      behind_.render(poses[i], views[i]);
      for (const bake::seen_polygon& s : views[i].seen) {
        size_ += seen_[s.id] ? 0 : 1;
        seen_[s.id] = true;
      }
      sizes_.push_back(size_);
    }
  }
  void render_image(const bake::pose& where, bake::hemicube_image& image) override {
    behind_.render_image(where, image);
  }
  std::uint32_t resolution() const override { return behind_.resolution(); }
  std::string device() const override { return behind_.device(); }

  const std::vector<std::uint32_t>& sizes() const { return sizes_; }

 private:
  bake::hemicube_source& behind_;
  const bake::boundary_face& face_;
  std::vector<bool> seen_;
  const std::size_t most_;
  std::uint32_t size_ = 0;
  std::vector<std::uint32_t> sizes_;
};

}  // namespace

std::vector<std::uint32_t> growth_of_face(const ground& g, std::size_t cell, const job& what,
                                          const bake::boundary_face& face, bake::hemicube_source& source) {
  bake::settings how = what.how;
  how.samples *= 6;
  how.smallest_gap = 0.0f;  // what is behind a crack would be taken out after it was counted
  one_face_source one(source, face, g.polygons(), what.how.samples);
  const auto sampler = bake::make_cell_sampler(how, {g.rays, one, &g.colors, g.cells});
  sampler->prepare([](double) { return true; });
  std::uint64_t tries = 0;
  const std::uint64_t place = g.cells[cell].place;
  bake::random_stream random(how.seed, place, bake::purpose::viewpoints);
  const auto free = bake::draw_viewpoints(g.rays, g.grown(cell), how.player_radius, 1, 1u << 20, random, tries);
  bake::cell_set set(g.polygons());
  sampler->sample({.grown = g.grown(cell), .place = place, .geometry_inside = false, .free = free}, set);
  return one.sizes();
}

void run_growth(const bench_options& how) {
  const job_list list = read_jobs(how.jobs);
  const auto g = load_ground(how.scene, how.cells, how.cell_limit, list.jobs.front().rules(), how.scene_hash);
  const std::size_t cell = g->cell_named(how.cell);
  const bake::box grown = g->grown(cell);
  const auto faces = bake::faces_of(grown.min, grown.max);
  json of_faces = json::array();
  for (std::size_t face = 0; face < faces.size(); ++face)
    if (face != facing_down) of_faces.push_back({{"face", face_names[face]}, {"jobs", json::array()}});
  for (const job& one : list.jobs) {
    const bake::chosen_source eyes = bake::choose_source(one.how, g->geometry, g->rays);
    std::size_t at = 0;
    for (std::size_t face = 0; face < faces.size(); ++face) {
      if (face == facing_down) continue;
      const auto sizes = growth_of_face(*g, cell, one, faces[face], *eyes.source);
      say(fmt::format("{}, face {}: {} polygons after {} hemicubes", one.label, face_names[face],
                      sizes.empty() ? 0 : sizes.back(), sizes.size()));
      of_faces[at++]["jobs"].push_back({{"label", one.label}, {"settings", one.settings}, {"sizes", sizes}});
    }
  }
  write_json(how.out, {{"scene", g->s.name},
                       {"hash", g->hash},
                       {"cell", how.cell},
                       {"polygons", g->polygons()},
                       {"faces", std::move(of_faces)}});
}

}  // namespace sightcell::bench
