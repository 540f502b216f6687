#include "report/views.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "report/data_uri.h"
#include "sightcell/base/error.h"
#include "sightcell/picture/gl_context.h"
#include "sightcell/picture/picture.h"
#include "worst_view.h"

namespace sightcell::cli {
namespace {

using nlohmann::ordered_json;

constexpr std::uint32_t picture_width = 480, picture_height = 270;
constexpr std::size_t most_tried = 16, most_of_misses = 12;

// A view, and the camera of its pictures.
struct candidate {
  report_view view;
  picture::camera camera;
};

// A view with its pictures.
struct drawn_view {
  report_view view;
  picture::image_rgba full, culled, marked;
};

report_view view_of(std::uint32_t cell, const std::array<float, 3>& eye, const std::array<float, 3>& target) {
  report_view view;
  view.cell = cell;
  view.eye = eye;
  view.target = target;
  return view;
}

picture::camera camera_at(const bake::cell_view& from) {
  const glm::vec3 eye(from.eye[0], from.eye[1], from.eye[2]), target(from.target[0], from.target[1], from.target[2]);
  return {.eye = eye, .forward = target - eye};
}

// Views of missing polygons, those with the most rays first, each viewpoint once.
void add_misses(const scene::world_geometry& world, const report_data& data, std::vector<candidate>& out) {
  const auto missing = data.verify.is_object() ? data.verify.find("missing") : data.verify.end();
  if (!data.verify.is_object() || missing == data.verify.end()) return;
  std::set<std::array<float, 3>> eyes;
  for (const ordered_json& one : *missing) {
    const auto eye = one.at("eye").get<std::array<float, 3>>();
    if (out.size() >= most_of_misses || !eyes.insert(eye).second) continue;
    const bake::missing_polygon miss{.cell = one.at("cell").get<std::uint32_t>(),
                                     .polygon = one.at("polygon").get<std::uint32_t>(),
                                     .rays = one.at("rays").get<std::uint64_t>(),
                                     .eye = eye,
                                     .target = one.at("target").get<std::array<float, 3>>()};
    report_view view = view_of(miss.cell, miss.eye, miss.target);
    view.missing = miss.polygon;
    view.node_name = one.at("node_name").get<std::string>();
    out.push_back({std::move(view), camera_of(world, miss)});
  }
}

// Views from the cells with the largest bounds.
void add_cells(const report_data& data, std::span<const bake::cell_view> from_cells, std::vector<candidate>& out) {
  std::vector<bake::cell_view> views(from_cells.begin(), from_cells.end());
  std::stable_sort(views.begin(), views.end(),
                   [&](const auto& a, const auto& b) { return data.cells[a.cell].bound > data.cells[b.cell].bound; });
  for (const bake::cell_view& view : views) {
    if (out.size() >= most_tried) return;
    out.push_back({view_of(view.cell, view.eye, view.target), camera_at(view)});
  }
}

std::vector<drawn_view> draw(const scene::scene& s, const scene::world_geometry& world, const pvs_file& file,
                             const std::vector<candidate>& candidates) {
  const picture::gl_context context;
  picture::renderer renderer(context, s, world);
  std::vector<drawn_view> drawn;
  for (const candidate& one : candidates) {
    const std::vector<std::uint32_t> set = file.cell_set(one.view.cell);
    drawn_view d{.view = one.view, .full = {}, .culled = {}, .marked = {}};
    d.full = renderer.draw(one.camera, picture_width, picture_height);
    d.culled = renderer.draw(one.camera, picture_width, picture_height, std::span<const std::uint32_t>(set));
    picture::difference difference = picture::compare(d.full, d.culled);
    d.marked = std::move(difference.marked);
    d.view.differing_pixels = difference.differing_pixels;
    d.view.pixels = std::uint64_t{picture_width} * picture_height;
    d.view.drawn = set.size();
    drawn.push_back(std::move(d));
  }
  return drawn;
}

}  // namespace

void draw_views(const scene::scene& s, const scene::world_geometry& world, const pvs_file& file,
                std::span<const bake::cell_view> from_cells, report_data& data) {
  std::vector<candidate> candidates;
  add_misses(world, data, candidates);
  add_cells(data, from_cells, candidates);
  data.views_tried = static_cast<std::uint32_t>(candidates.size());
  if (candidates.empty()) {
    data.views_note = "No cell has a viewpoint for a picture.";
    return;
  }
  try {
    std::vector<drawn_view> drawn = draw(s, world, file, candidates);
    std::stable_sort(drawn.begin(), drawn.end(), [](const drawn_view& a, const drawn_view& b) {
      return a.view.differing_pixels > b.view.differing_pixels;
    });
    if (drawn.size() > most_views) drawn.resize(most_views);
    for (drawn_view& d : drawn) {
      d.view.full = data_uri_of(d.full);
      d.view.culled = data_uri_of(d.culled);
      d.view.difference = data_uri_of(d.marked);
      data.views.push_back(std::move(d.view));
    }
  } catch (const error& e) {
    if (!e.id().starts_with("gl.")) throw;
    data.views_note = std::string("There are no pictures: ") + e.what();
  }
}

}  // namespace sightcell::cli
